"""A document as a list of painted shapes: styles, references and transforms resolved, nothing flattened yet."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import NestedCagesError, invalid_file
from ...geometry.arrays import FloatArray
from ...geometry.mesh.validation import MAX_COORDINATE
from ..limits import Quota
from .curves import Subpath, length_of
from .document import Document, SvgOptions
from .elements import is_automatic, layer_names, link_of, name_of, quoted, shown_name, title_of
from .lengths import Viewport, attribute, parse_length, share
from .outlines import OUTLINED, outline
from .paints import Paint, Paints, link_in
from .shapes import Clip, Shape, rectangular_clip, unit_box
from .strokes import stroke_of
from .style import MARKERS, Style, Styles
from .transforms import fitted, translation, view_box_of

GROUPS = frozenset(("svg", "g", "a", "switch"))
"""Elements that draw their children."""

MARKED = frozenset(("path", "line", "polyline", "polygon"))
"""Elements that have markers."""

LEFT_OUT = {"text": "text", "image": "image", "foreignObject": "foreign object"}
"""Visible elements that are not read."""

READ = GROUPS | OUTLINED | {"use", *LEFT_OUT}

PLACES_OF_ORIGIN = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}

PAINT, CLIP, MASK = "paint", "clip", "mask"
"""Purposes of shapes: to be painted, to clip by their outlines, to mask by their luminance."""

BOX = "objectBoundingBox"
"""Units of clip paths and masks: shares of the box around what they belong to."""

MAX_DEPTH = 64
"""Maximum nesting depth of elements."""


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


class Scene:
    """Walks through a document; `shapes` are those that it draws, the lowest first.

    Raises NestedCagesError for an element or a layer that is not in it, and beyond the limits.
    """

    def __init__(self, document: Document, options: SvgOptions) -> None:
        self.document = document
        self.options = options
        self.styles = Styles(document)
        self.paints = Paints(document, self.styles)
        self.left_out: Counter[str] = Counter()
        self.quota = Quota(options.limits)
        self.groups: Counter[tuple[str, ...]] = Counter()
        self.outlines: dict[tuple[ET.Element, Viewport], list[Subpath]] = {}
        labels = [name for item in document.root if name_of(item) == "g" for name in layer_names(item)]
        _check_names("element with the id", [options.element or ""], document.by_id)
        _check_names("layer", options.layers, labels)
        in_element, in_layer = options.element is None, not options.layers
        whole = Context(np.eye(3), document.viewport, in_element=in_element, in_layer=in_layer)
        self.shapes = self._shapes(document.root, whole)

    def _shapes(self, item: ET.Element, around: Context) -> list[Shape]:
        """The shapes of an element."""
        self.quota.spend("elements", 1)
        name = name_of(item)
        if name not in READ or not _is_meant(item) or (around.purpose == CLIP and name in GROUPS):
            return []
        if around.depth > MAX_DEPTH:
            problem = "The drawing nests its elements too deeply; simplify its groups and references."
            raise NestedCagesError(problem, code="limit.exceeded")
        style = self.styles.computed(item, around.style)
        opacity = around.opacity * share(style.get("opacity"))
        if style.get("display") == "none" or (around.purpose != CLIP and not opacity > 0.0):
            return []
        title, viewport = around.used_as or shown_name(item), around.viewport
        if font := self.styles.own(item).get("font-size"):
            viewport = replace(viewport, em=viewport.length(font, "font-size") or viewport.em)
        context = replace(
            around,
            matrix=around.matrix @ self._transform(item, style, around) if around.depth or name != "svg" else np.eye(3),
            viewport=viewport,
            style=style,
            opacity=opacity,
            in_element=around.in_element or item.get("id") == self.options.element,
            in_layer=around.in_layer or (around.depth == 1 and bool({*layer_names(item)} & {*self.options.layers})),
            depth=around.depth + 1,
            groups=self._inside(around.groups, title) if name == "g" else around.groups,
            used_as="",
        )
        counts = style.get("visibility", "visible") == "visible" and context.in_element and context.in_layer
        if name in LEFT_OUT:
            self.left_out.update([LEFT_OUT[name]] if counts else [])
            return []
        if style.get("filter", "none") != "none" and context.purpose != CLIP:
            self.left_out["filter"] += 1
        if name == "use":
            found = self._used(item, title, context)
        elif name in OUTLINED:
            found = self._outlined(item, title, context) if counts else []
        elif name == "svg" and around.depth:
            x, y = (attribute(item, key, context.viewport) for key in ("x", "y"))
            found = self._framed(item, context, x, y, (item.get("width"), item.get("height")))
        else:
            found = self._all(_chosen(item) if name == "switch" else item, context)
        return clipped(found, self._clips(style, context, found))

    def _all(self, items: Iterable[ET.Element], context: Context) -> list[Shape]:
        return [shape for item in items for shape in self._shapes(item, context)]

    def _transform(self, item: ET.Element, style: Style, around: Context) -> FloatArray:
        """The matrix from the units of an element to those around it."""
        if style.get("transform", "none") == "none":
            return np.eye(3)
        title, words = title_of(item), style.get("transform-origin", "").replace(",", " ").split()
        own = self.document.transform(style["transform"], title)
        if not words:
            return own
        if style.get("transform-box", "view-box") != "view-box":
            self.document.faults.add(f"The transform-box of the {title} is not the view box: the origin is at 0 0")
            return own
        if words[0] in ("top", "bottom") or words[1:2] in (["left"], ["right"]):
            words[:2] = [[*words, "center"][1], words[0]]
        what = f"transform-origin of the {title}"
        x, y = (
            parse_length(PLACES_OF_ORIGIN.get(word, word), key, what, around.viewport)
            for word, key in zip([*words, "center"], "xy", strict=False)
        )
        return translation(x, y) @ own @ translation(-x, -y)

    def _inside(self, around: tuple[str, ...], title: str) -> tuple[str, ...]:
        """The groups around the content of a group; a later one of the same name in the same group gets a number."""
        if not title:
            return around
        groups = (*around, title)
        self.groups[groups] += 1
        number = self.groups[groups]
        return groups if number == 1 else self._inside(around, f"{title} {number}")

    def _used(self, item: ET.Element, title: str, context: Context) -> list[Shape]:
        """The shapes of a `use` element."""
        link = link_of(item)
        target = self.document.linked(link)
        if target is None or any(target is user for user in context.users):
            problem = "not an element of the drawing" if target is None else "used by itself"
            self.document.faults.add(f"Left out: the use of {quoted(link)}, which is {problem}")
            return []
        x, y = (attribute(item, key, context.viewport) for key in ("x", "y"))
        context = replace(context, users=(*context.users, target))
        if not title or (is_automatic(title) and not is_automatic(shown_name(target))):
            title = shown_name(target)
        if name_of(target) not in ("symbol", "svg"):
            return self._shapes(target, replace(context, matrix=context.matrix @ translation(x, y), used_as=title))
        style = self.styles.computed(target, context.style)
        if style.get("display") == "none" and name_of(target) != "symbol":
            return []
        size = [item.get(key) or target.get(key) for key in ("width", "height")]
        context = replace(context, style=style, groups=self._inside(context.groups, title))
        return self._framed(target, context, x, y, size)

    def _framed(
        self, item: ET.Element, context: Context, x: float, y: float, size: Sequence[str | None]
    ) -> list[Shape]:
        """The shapes in a nested `svg` or `symbol`, its view box fitted to its size."""
        box, around = view_box_of(item), context.viewport
        whole = (around.width, around.height) if around.width is not None else (box[2:] if box else (None, None))
        if box is None and None in whole and None in size:
            width = height = None
        else:
            width, height = (
                parse_length(given or "", key, f"{key} of the {name_of(item)}", around, missing=missing or 0.0)
                for given, key, missing in zip(size, ("width", "height"), whole, strict=True)
            )
            if not (width > 0.0 and height > 0.0):
                return []
        inside = fitted(box, x, y, width or 0.0, height or 0.0, item.get("preserveAspectRatio", ""))
        viewport = around.sized(*(box[2:] if box else (width, height)))
        found = self._all(item, replace(context, matrix=context.matrix @ inside, viewport=viewport))
        if width is None or height is None or context.style.get("overflow", "hidden") not in ("hidden", "scroll"):
            return found
        return clipped(found, [rectangular_clip(x, y, width, height, context.matrix, self.quota)])

    def _outlined(self, item: ET.Element, title: str, context: Context) -> list[Shape]:
        """An element with an outline."""
        style = context.style
        key = (item, context.viewport)
        if key not in self.outlines:
            self.outlines[key] = outline(self.styles.placed(item), context.viewport, self.quota)
        subpaths, name = self.outlines[key], title_of(item)
        if not subpaths:
            return []
        if context.purpose == CLIP:
            shape = Shape(name, subpaths, context.matrix, style.get("clip-rule") == "evenodd", Paint(1.0))
        else:
            stroke = stroke_of(style, context.viewport)
            if stroke and stroke.dashes and item.get("pathLength"):
                length = attribute(item, "pathLength", context.viewport)
                stroke = stroke.along(length_of(subpaths) / length) if length > 0.0 else stroke
            shape = Shape(
                name,
                subpaths,
                context.matrix,
                style.get("fill-rule") == "evenodd",
                self._paint("fill", "black", context),
                stroke,
                self._paint("stroke", "none", context) if stroke else None,
                style.get("vector-effect") != "non-scaling-stroke",
                title,
                context.groups,
            )
        points = [*(path.points for path in subpaths), *shape.placed]
        if not np.abs(np.concatenate(points)).max() < MAX_COORDINATE:
            self.document.faults.add(f"Left out: the {name}, whose coordinates are not finite, or too large")
            return []
        for end in MARKERS if name_of(item) in MARKED else ():
            if self.document.linked(link_in(style.get(end, "none"))[0]) is not None:
                self.left_out["marker"] += 1
        return [shape]

    def _paint(self, key: str, default: str, context: Context) -> Paint | None:
        style = context.style
        opacity = context.opacity * share(style.get(f"{key}-opacity"))
        return self.paints.paint(style.get(key, default), opacity, style)

    def _clips(self, style: Style, context: Context, shapes: list[Shape]) -> list[Clip]:
        """The clip path and the mask of an element that draws some shapes."""
        found = []
        for key, tag, purpose in (("clip-path", "clipPath", CLIP), ("mask", "mask", MASK)):
            link, _ = link_in(style.get(key, "none"))
            if not link and style.get(key, "none") != "none" and context.purpose == PAINT:
                self.left_out[key.replace("-", " ")] += 1
            item = self.document.linked(link)
            if not shapes or item is None or name_of(item) != tag or any(item is user for user in context.users):
                continue
            own = self.styles.computed(item, {})
            units = item.get("clipPathUnits" if purpose == CLIP else "maskContentUnits", "")
            placed = self._in_units(units, context, shapes)
            if purpose == MASK and own.get("mask-type") == "alpha":
                purpose = PAINT
            matrix = self.document.transform(own.get("transform") or "", tag) if purpose == CLIP else np.eye(3)
            inner = replace(
                placed,
                matrix=placed.matrix @ matrix,
                style=own,
                opacity=1.0,
                purpose=purpose,
                in_element=True,
                in_layer=True,
                depth=context.depth + 1,
                users=(*context.users, item),
            )
            content = self._all(item, inner)
            content = clipped(content, self._clips(own, replace(inner, matrix=placed.matrix), content))
            found.append(Clip(content, is_mask=purpose == MASK))
            if tag == "mask":
                found.append(self._mask_region(item, self._in_units(item.get("maskUnits", BOX), context, shapes)))
        return found

    def _in_units(self, units: str, context: Context, shapes: list[Shape]) -> Context:
        """A context, for units of the box with the box around shapes as the unit square."""
        if units != BOX:
            return context
        return replace(context, matrix=unit_box(shapes, context.matrix), viewport=context.viewport.sized(1.0, 1.0))

    def _mask_region(self, item: ET.Element, context: Context) -> Clip:
        """The rectangle outside which a mask hides everything; by default a tenth wider than what it belongs to."""
        x, y, width, height = (
            parse_length(item.get(key) or default, key, f"{key} of the mask", context.viewport)
            for key, default in (("x", "-10%"), ("y", "-10%"), ("width", "120%"), ("height", "120%"))
        )
        return rectangular_clip(x, y, width, height, context.matrix, self.quota)


def clipped(shapes: list[Shape], clips: Sequence[Clip]) -> list[Shape]:
    return [replace(shape, clips=(*shape.clips, *clips)) for shape in shapes] if clips else shapes


def _check_names(what: str, names: Sequence[str], known: Iterable[str]) -> None:
    """Raise NestedCagesError if a name that is asked for is not in the drawing."""
    for name in names:
        if name and name not in known:
            others = ", ".join(list(filter(None, known))[:12]) or "none"
            raise invalid_file(f"The drawing has no {what} {quoted(name)}; there are: {others}.")


def _is_meant(item: ET.Element) -> bool:
    """Whether an element needs no extensions and is for readers of English, if it is for some only."""
    languages = item.get("systemLanguage")
    return not item.get("requiredExtensions") and (
        languages is None or any(part.strip().lower().startswith("en") for part in languages.split(","))
    )


def _chosen(item: ET.Element) -> list[ET.Element]:
    """The element that a `switch` draws: the first of its children that is meant."""
    return [child for child in item if name_of(child) not in ("", "foreignObject") and _is_meant(child)][:1]
