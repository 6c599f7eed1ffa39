"""The shapes of an SVG document: elements, their transforms and how they are painted."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from xml.etree import ElementTree as ET

import numpy as np

from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from .curves import ellipse, line
from .svg_path import Subpath, read_path
from .transforms import NUMBER, moved, read_transform, scaling, translation

NOT_DRAWN = frozenset(
    (
        *("defs", "symbol", "clipPath", "mask", "marker", "pattern", "linearGradient", "radialGradient", "filter"),
        *("metadata", "title", "desc", "style", "script", "foreignObject", "animate", "animateTransform", "font"),
    )
)
"""Elements that draw nothing where they stand."""

GROUPS = frozenset(("svg", "g", "a", "switch"))
"""Elements that draw what is in them."""

INHERITED = ("fill", "fill-rule", "fill-opacity", "stroke", "visibility")
"""Properties that an element has from those around it."""

NOT_INHERITED = ("display", "opacity")
"""Properties that hide an element with all that is in it."""

UNITS = {"": 1.0, "px": 1.0, "in": 96.0, "cm": 96.0 / 2.54, "mm": 96.0 / 25.4, "pt": 96.0 / 72.0, "pc": 16.0}
"""User units of each unit of length (CSS: 96 px to the inch)."""

ACROSS, DOWN = ("x", "width", "cx", "rx"), ("y", "height", "cy", "ry")
"""Attributes whose per cent are of the width, and of the height."""

LENGTH = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-z%]*)\s*$")
RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)

GREATEST_DEPTH = 64
"""Elements within elements; `use` that refers to itself ends here."""


@dataclass(frozen=True)
class Shape:
    """One drawn element, in the units of the document."""

    subpaths: list[Subpath]
    filled: bool
    evenodd: bool


class SvgReader:
    """Walks through a document."""

    def __init__(self, text: str | bytes) -> None:
        try:
            self.root = ET.fromstring(text)
        except (ET.ParseError, ValueError) as error:
            raise NestedCagesError(f"This is not an SVG document: {error}.") from error
        if _name(self.root) != "svg":
            raise NestedCagesError(f"This is not an SVG document: its root element is '{_name(self.root)}', not 'svg'.")
        self._resolve_percentages()
        self.by_id = {item.get("id", ""): item for item in self.root.iter()}
        self.styles = dict(self._style_sheets())

    def shapes(self, element: str | None = None) -> list[Shape]:
        """What is drawn; of one element alone if its id is given. Raises NestedCagesError."""
        if element is not None and element not in self.by_id:
            known = ", ".join(sorted(filter(None, self.by_id))[:12]) or "none"
            raise NestedCagesError(f"The drawing has no element with the id '{element}'; its ids: {known}.")
        return list(self._drawn(self.root, np.eye(3), {}, element, 0))

    def _resolve_percentages(self) -> None:
        """Lengths in per cent become numbers: shares of the document's view box, or of its size if it has none."""
        box = [float(number) for number in NUMBER.findall(self.root.get("viewBox", ""))]
        found = [LENGTH.match(self.root.get(key, "")) for key in ("width", "height")]
        size = box[2:] if len(box) == 4 else [float(match[1]) * UNITS.get(match[2], 0.0) for match in found if match]
        if len(size) != 2 or not (size[0] > 0.0 and size[1] > 0.0):
            return
        whole = {**dict.fromkeys(ACROSS, size[0]), **dict.fromkeys(DOWN, size[1])}
        whole["r"] = math.hypot(*size) / math.sqrt(2.0)
        for item in self.root.iter():
            for key, reference in whole.items():
                match = LENGTH.match(item.get(key, "")) if item is not self.root else None
                if match and match[2] == "%":
                    item.set(key, repr(float(match[1]) / 100.0 * reference))

    def _drawn(
        self, item: ET.Element, matrix: FloatArray, outer: Mapping[str, str], wanted: str | None, depth: int
    ) -> Iterator[Shape]:
        name = _name(item)
        if depth > GREATEST_DEPTH:
            raise NestedCagesError("The drawing's elements are nested too deeply, or one of them uses itself.")
        style = {**outer, **self._style(item)}
        if name in NOT_DRAWN or style.get("display") == "none" or _is_zero(style.get("opacity")):
            return
        for key in NOT_INHERITED:
            style.pop(key, None)
        if wanted is not None and item.get("id") == wanted:
            wanted = None
        if depth or name != "svg":
            matrix = matrix @ read_transform(item.get("transform", ""))
        if name in GROUPS:
            if name == "svg" and depth:
                matrix = matrix @ _viewport(item, _length(item, "x"), _length(item, "y"))
            for child in item:
                yield from self._drawn(child, matrix, style, wanted, depth + 1)
        elif name == "use":
            yield from self._used(item, matrix, style, wanted, depth)
        elif wanted is None and style.get("visibility", "visible") == "visible":
            subpaths = _outline(item)
            for path in subpaths:
                path.curves = [moved(curve, matrix) for curve in path.curves]
            if subpaths:
                unseen = style.get("fill", "black") in ("none", "transparent")
                filled = not unseen and not _is_zero(style.get("fill-opacity"))
                yield Shape(subpaths, filled, style.get("fill-rule", "nonzero") == "evenodd")

    def _used(
        self, item: ET.Element, matrix: FloatArray, style: Mapping[str, str], wanted: str | None, depth: int
    ) -> Iterator[Shape]:
        """What a `use` element draws."""
        link = item.get("href") or item.get("{http://www.w3.org/1999/xlink}href") or ""
        target = self.by_id.get(link.removeprefix("#")) if link.startswith("#") else None
        if target is None:
            raise NestedCagesError(f"The drawing uses '{link}', which is not an element of it; embed it or remove it.")
        x, y = _length(item, "x"), _length(item, "y")
        if _name(target) != "symbol":
            yield from self._drawn(target, matrix @ translation(x, y), style, wanted, depth + 1)
            return
        size = {key: item.get(key) or target.get(key) for key in ("width", "height")}
        matrix = matrix @ _viewport(target, x, y, size)
        for child in target:
            yield from self._drawn(child, matrix, {**style, **self._style(target)}, wanted, depth + 1)

    def _style(self, item: ET.Element) -> dict[str, str]:
        """Paint properties of an element: attributes, then style sheets, then its style attribute, as CSS has it."""
        found = {key: item.get(key, "").strip() for key in (*INHERITED, *NOT_INHERITED) if item.get(key) is not None}
        selectors = ["*", _name(item), *(f".{name}" for name in item.get("class", "").split()), f"#{item.get('id')}"]
        for selector in selectors:
            found.update(self.styles.get(selector, {}))
        found.update(_declarations(item.get("style", "")))
        return {key: value for key, value in found.items() if value != "inherit"}

    def _style_sheets(self) -> Iterator[tuple[str, dict[str, str]]]:
        """Rules for tags, classes and ids; other selectors are left out."""
        rules: dict[str, dict[str, str]] = {}
        for item in self.root.iter():
            if _name(item) == "style":
                for selectors, body in RULE.findall(COMMENT.sub("", "".join(item.itertext()))):
                    for selector in selectors.split(","):
                        rules.setdefault(selector.strip(), {}).update(_declarations(body))
        yield from rules.items()


def _declarations(text: str) -> dict[str, str]:
    """The paint properties in CSS declarations."""
    pairs = (part.split(":", 1) for part in text.split(";") if ":" in part)
    stated = {key.strip(): value.replace("!important", "").strip() for key, value in pairs}
    return {key: value for key, value in stated.items() if key in (*INHERITED, *NOT_INHERITED)}


def _outline(item: ET.Element) -> list[Subpath]:
    """The outline of a basic shape or path, in its own units; nothing for other elements."""
    name = _name(item)
    if name == "path":
        return read_path(item.get("d", ""))
    if name in ("polygon", "polyline"):
        values = [float(x) for x in NUMBER.findall(item.get("points", ""))]
        points = np.reshape(values[: len(values) // 2 * 2], (-1, 2))
        if len(points) < 2:
            return []
        curves = [line(a, b) for a, b in pairwise(points)]
        return [Subpath([*curves, line(points[-1], points[0])] if name == "polygon" else curves, name == "polygon")]
    if name == "rect":
        return _rectangle(item)
    if name in ("circle", "ellipse"):
        radii = [_length(item, "r")] * 2 if name == "circle" else [_length(item, "rx"), _length(item, "ry")]
        centre = np.array([_length(item, "cx"), _length(item, "cy")])
        return [Subpath(ellipse(centre, np.diag(radii)), True)] if min(radii) > 0.0 else []
    return []


def _rectangle(item: ET.Element) -> list[Subpath]:
    x, y, width, height = (_length(item, key) for key in ("x", "y", "width", "height"))
    if not (width > 0.0 and height > 0.0):
        return []
    rx = _length(item, "rx" if item.get("rx") else "ry")
    ry = _length(item, "ry" if item.get("ry") else "rx")
    rx, ry = min(rx, width / 2.0), min(ry, height / 2.0)
    corners = np.array([[x + width, y + height], [x, y + height], [x, y], [x + width, y]])
    if not (rx > 0.0 and ry > 0.0):
        around = np.concatenate((corners[2:], corners[:3]))
        return [Subpath([line(a, b) for a, b in pairwise(around)], True)]
    centres = corners + np.array([[-rx, -ry], [rx, -ry], [rx, ry], [-rx, ry]])
    curves: list[FloatArray] = []
    for k, centre in enumerate(centres):
        quarter = ellipse(centre, np.diag((rx, ry)), k * math.pi / 2.0, math.pi / 2.0)
        if curves:
            curves.append(line(curves[-1][-1], quarter[0][0]))
        curves += quarter
    return [Subpath([*curves, line(curves[-1][-1], curves[0][0])], True)]


def _viewport(item: ET.Element, x: float, y: float, size: Mapping[str, str | None] | None = None) -> FloatArray:
    """The matrix from inside a nested `svg` or `symbol` to outside: its view box fitted into its size."""
    box = [float(number) for number in NUMBER.findall(item.get("viewBox", ""))]
    given = size if size is not None else {key: item.get(key) for key in ("width", "height")}
    if len(box) != 4 or not (box[2] > 0.0 and box[3] > 0.0):
        return translation(x, y)
    width = _measure(given.get("width") or "", "width", box[2])
    height = _measure(given.get("height") or "", "height", box[3])
    across, down = width / box[2], height / box[3]
    if item.get("preserveAspectRatio", "").strip() == "none":
        return translation(x, y) @ scaling(across, down) @ translation(-box[0], -box[1])
    scale = min(across, down)
    x, y = x + (width - scale * box[2]) / 2.0, y + (height - scale * box[3]) / 2.0
    return translation(x, y) @ scaling(scale, scale) @ translation(-box[0], -box[1])


def _is_zero(opacity: str | None) -> bool:
    """Whether an opacity hides what it belongs to."""
    found = LENGTH.match(opacity) if opacity else None
    return found is not None and float(found[1]) <= 0.0


def _length(item: ET.Element, key: str) -> float:
    """A length in user units, 0 if the attribute is missing. Raises NestedCagesError."""
    return _measure(item.get(key, ""), f"{key} of the {_name(item)}")


def _measure(text: str, what: str, missing: float = 0.0) -> float:
    if not text.strip() or text.strip() == "auto":
        return missing
    found = LENGTH.match(text)
    if not found or found[2] not in UNITS:
        raise NestedCagesError(f"The {what} is '{text}'; use a number, or one with {', '.join(filter(None, UNITS))}.")
    return float(found[1]) * UNITS[found[2]]


def _name(item: ET.Element) -> str:
    """The tag without its namespace; comments have none."""
    return item.tag.rpartition("}")[2] if isinstance(item.tag, str) else ""
