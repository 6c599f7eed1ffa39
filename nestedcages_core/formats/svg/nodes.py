"""The tree of a document: shapes, groups that are clipped together, and what elements pass on to their children."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray
from .curves import Subpath
from .document import Document
from .elements import name_of
from .faults import Faults, quoted
from .lengths import Viewport, parse_length
from .names import layer_names
from .options import SvgOptions
from .outlines import through
from .paints import Paint
from .strokes import Stroke
from .style import Style

PLACES_OF_ORIGIN = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}

PAINT, CLIP, MASK = "paint", "clip", "mask"
"""Purposes of shapes: to be painted, to clip by their outlines, to mask by their luminance."""


@dataclass(frozen=True, eq=False)
class Shape:
    """One element with an outline."""

    name: str
    """Name in messages."""
    subpaths: list[Subpath]
    """In its own units."""
    matrix: FloatArray
    """From its units to those of the document, or of the clip that it is part of."""
    evenodd: bool = False
    fill: Paint | None = None
    stroke: Stroke | None = None
    stroke_paint: Paint | None = None
    scales: bool = True
    """Whether the width of its stroke follows its transforms."""
    id: str = ""
    groups: tuple[str, ...] = ()
    """Names of the groups around it, the outermost first."""
    classes: str = ""
    """Its own ones, as written."""


@dataclass(frozen=True, eq=False)
class Group:
    """Shapes that are clipped together."""

    children: list[Shape | Group] = field(default_factory=list)
    clips: list[Clip] = field(default_factory=list)

    def shapes(self) -> Iterator[Shape]:
        """All shapes, the lowest first."""
        for child in self.children:
            if isinstance(child, Shape):
                yield child
            else:
                yield from child.shapes()


@dataclass(frozen=True, eq=False)
class Clip:
    """The region of a group that is kept."""

    content: Group
    matrix: FloatArray
    """From the units of the group to those of the document."""
    of_box: bool = False
    """Whether the content's units are shares of the group's box."""
    is_mask: bool = False


def attach(group: Group, to: Group) -> None:
    """Add a group to another one; without clips its shapes themselves."""
    if not group.clips:
        to.children.extend(group.children)
    elif group.children:
        to.children.append(group)


def rectangular_clip(x: float, y: float, width: float, height: float, matrix: FloatArray) -> Clip:
    sides = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    return Clip(Group([Shape("rect", through(sides, closed=True), np.eye(3), fill=Paint(1.0))]), matrix)


def mask_region(item: ET.Element, around: Viewport, matrix: FloatArray) -> Clip:
    """The rectangle outside which a mask hides everything; by default a tenth wider than what it belongs to."""
    of_box = item.get("maskUnits", "objectBoundingBox") == "objectBoundingBox"
    viewport = around.sized(1.0, 1.0) if of_box else around
    x, y, width, height = (
        parse_length(item.get(key) or default, key, f"{key} of the mask", viewport)
        for key, default in (("x", "-10%"), ("y", "-10%"), ("width", "120%"), ("height", "120%"))
    )
    return replace(rectangular_clip(x, y, width, height, matrix), of_box=of_box)


@dataclass(frozen=True)
class Context:
    """Inherited state of an element."""

    matrix: FloatArray
    viewport: Viewport
    style: Style = field(default_factory=dict)
    opacity: float = 1.0
    purpose: str = PAINT
    in_element: bool = True
    in_layer: bool = True
    users: tuple[ET.Element, ...] = ()
    """References that are being followed."""
    depth: int = 0
    groups: tuple[str, ...] = ()
    used_as: str = ""
    """Name of the reference to the element, which is that of what it shows."""


def check_names(document: Document, options: SvgOptions) -> None:
    """Raise NestedCagesError if the element or a layer that is asked for is not in the drawing."""
    element = options.element
    if element is not None and element not in document.by_id:
        known = ", ".join(sorted(filter(None, document.by_id))[:12]) or "none"
        raise invalid_file(f"The drawing has no element with the id {quoted(element)}; its ids: {known}.")
    labels = [name for item in document.root if name_of(item) == "g" for name in layer_names(item)]
    for layer in options.layers:
        if layer not in labels:
            known = ", ".join(labels[:12]) or "none"
            raise invalid_file(f"The drawing has no layer {quoted(layer)}; its layers: {known}.")


def origin_of(style: Style, viewport: Viewport, title: str, faults: Faults) -> tuple[float, float]:
    """The point that the transform of an element leaves where it is."""
    words = style.get("transform-origin", "").replace(",", " ").split()
    if not words:
        return 0.0, 0.0
    if style.get("transform-box", "view-box") != "view-box":
        faults.add(f"The transform-box of the {title} is not the view box: the origin is at 0 0")
        return 0.0, 0.0
    if words[0] in ("top", "bottom") or words[1:2] in (["left"], ["right"]):
        words[:2] = [[*words, "center"][1], words[0]]
    x, y = (PLACES_OF_ORIGIN.get(word, word) for word in [*words, "center"][:2])
    what = f"transform-origin of the {title}"
    return parse_length(x, "x", what, viewport), parse_length(y, "y", what, viewport)


def is_meant(item: ET.Element) -> bool:
    """Whether an element needs no extensions and is for readers of English, if it is for some only."""
    languages = item.get("systemLanguage")
    return not item.get("requiredExtensions") and (
        languages is None or any(part.strip().lower().startswith("en") for part in languages.split(","))
    )


def chosen(item: ET.Element) -> list[ET.Element]:
    """The element that a `switch` draws: the first of its children that is meant."""
    return [child for child in item if name_of(child) not in ("", "foreignObject") and is_meant(child)][:1]
