"""A document as a list of painted shapes: styles, references and transforms resolved, nothing flattened yet."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import NestedCagesError
from ...geometry.mesh.validation import MAX_COORDINATE
from ..limits import Quota
from .curves import Subpath, length_of
from .document import Document
from .elements import link_of, name_of, title_of
from .faults import quoted
from .lengths import Viewport, attribute, parse_length, share
from .names import is_automatic, layer_names, shown_name
from .nodes import (
    CLIP,
    MASK,
    PAINT,
    Clip,
    Context,
    Shape,
    check_names,
    chosen,
    is_meant,
    origin_of,
    rectangular_clip,
    unit_box,
)
from .options import SvgOptions
from .outlines import OUTLINED, outline
from .paints import Paint, Paints, link_in
from .strokes import stroke_of
from .style import MARKERS, Style, Styles
from .transforms import fitted, translation, view_box_of

GROUPS = frozenset(("svg", "g", "a", "switch"))
"""Elements that draw their children."""

MARKED = frozenset(("path", "line", "polyline", "polygon"))
"""Elements that have markers."""

LEFT_OUT = {"text": "text", "image": "image", "foreignObject": "foreign object"}
"""Visible elements that are not read."""

BOX = "objectBoundingBox"
"""Units of clip paths and masks: shares of the box around what they belong to."""

MAX_DEPTH = 64
"""Maximum nesting depth of elements."""


class Scene:
    """Walks through a document; `shapes` are those that it draws, the lowest first."""

    def __init__(self, document: Document, options: SvgOptions, *, colours: bool = False) -> None:
        """colours: whether colours matter, not only what is visible."""
        self.document = document
        self.options = options
        self.styles = Styles(document)
        self.paints = Paints(document, self.styles, colours=colours)
        self.left_out: Counter[str] = Counter()
        self.quota = Quota(options.limits)
        self.groups: Counter[tuple[str, ...]] = Counter()
        self.outlines: dict[tuple[ET.Element, Viewport], list[Subpath]] = {}
        check_names(document, options)
        self.shapes: list[Shape] = []
        in_element, in_layer = options.element is None, not options.layers
        whole = Context(np.eye(3), document.viewport, in_element=in_element, in_layer=in_layer)
        self._add(document.root, whole, self.shapes)

    def _add(self, item: ET.Element, around: Context, shapes: list[Shape]) -> None:
        """Add the shapes of an element."""
        self.quota.spend("elements", 1)
        name = name_of(item)
        if name not in GROUPS and name not in OUTLINED and name != "use" and name not in LEFT_OUT:
            return
        if not is_meant(item) or (around.purpose == CLIP and name in GROUPS):
            return
        _check_depth(around)
        style = self.styles.computed(item, around.style)
        opacity = around.opacity * share(style.get("opacity"))
        if style.get("display") == "none" or (around.purpose != CLIP and not opacity > 0.0):
            return
        title, matrix = around.used_as or shown_name(item), around.matrix
        if (around.depth or name != "svg") and style.get("transform", "none") != "none":
            origin = translation(*origin_of(style, around.viewport, title_of(item), self.document.faults))
            own = self.document.transform(style.get("transform") or "", title_of(item))
            matrix = matrix @ origin @ own @ np.linalg.inv(origin)
        context = replace(
            around,
            matrix=matrix,
            style=style,
            opacity=opacity,
            in_element=around.in_element or item.get("id") == self.options.element,
            in_layer=around.in_layer or (around.depth == 1 and bool({*layer_names(item)} & {*self.options.layers})),
            depth=around.depth + 1,
            groups=self._inside(around.groups, title) if name == "g" else around.groups,
            used_as="",
        )
        font = self.styles.own(item).get("font-size")
        if font:
            em = around.viewport.length(font, "font-size") or around.viewport.em
            context = replace(context, viewport=replace(context.viewport, em=em))
        if name in LEFT_OUT:
            if style.get("visibility", "visible") == "visible" and context.in_element and context.in_layer:
                self.left_out[LEFT_OUT[name]] += 1
            return
        if style.get("filter", "none") != "none" and context.purpose != CLIP:
            self.left_out["filter"] += 1
        first = len(shapes)
        if name == "use":
            self._add_used(item, title, context, shapes)
        elif name in OUTLINED:
            self._add_shape(item, title, context, shapes)
        elif name == "svg" and around.depth:
            x, y = (attribute(item, key, context.viewport) for key in ("x", "y"))
            self._add_framed(item, context, shapes, x, y, (item.get("width"), item.get("height")))
        else:
            for child in chosen(item) if name == "switch" else item:
                self._add(child, context, shapes)
        clip(shapes, first, self._clips(style, context, shapes[first:]))

    def _inside(self, around: tuple[str, ...], title: str) -> tuple[str, ...]:
        """The groups around the content of a group; a later one of the same name in the same group gets a number."""
        if not title:
            return around
        groups = (*around, title)
        self.groups[groups] += 1
        number = self.groups[groups]
        return groups if number == 1 else self._inside(around, f"{title} {number}")

    def _add_used(self, item: ET.Element, title: str, context: Context, shapes: list[Shape]) -> None:
        """Add the shapes of a `use` element."""
        link = link_of(item)
        target = self.document.linked(link)
        if target is None or any(target is user for user in context.users):
            problem = "not an element of the drawing" if target is None else "used by itself"
            self.document.faults.add(f"Left out: the use of {quoted(link)}, which is {problem}")
            return
        x, y = (attribute(item, key, context.viewport) for key in ("x", "y"))
        context = replace(context, users=(*context.users, target))
        if not title or (is_automatic(title) and not is_automatic(shown_name(target))):
            title = shown_name(target)
        if name_of(target) not in ("symbol", "svg"):
            self._add(target, replace(context, matrix=context.matrix @ translation(x, y), used_as=title), shapes)
            return
        context = replace(context, groups=self._inside(context.groups, title))
        size = [item.get(key) or target.get(key) for key in ("width", "height")]
        style = self.styles.computed(target, context.style)
        if style.get("display") != "none" or name_of(target) == "symbol":
            self._add_framed(target, replace(context, style=style), shapes, x, y, size)

    def _add_framed(
        self, item: ET.Element, context: Context, shapes: list[Shape], x: float, y: float, size: Sequence[str | None]
    ) -> None:
        """Add the shapes in a nested `svg` or `symbol`, its view box fitted to its size."""
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
                return
        inside = fitted(box, x, y, width or 0.0, height or 0.0, item.get("preserveAspectRatio", ""))
        viewport = around.sized(*(box[2:] if box else (width, height)))
        first, within = len(shapes), replace(context, matrix=context.matrix @ inside, viewport=viewport)
        for child in item:
            self._add(child, within, shapes)
        if width is not None and height is not None and context.style.get("overflow", "hidden") in ("hidden", "scroll"):
            clip(shapes, first, [rectangular_clip(x, y, width, height, context.matrix, self.quota)])

    def _add_shape(self, item: ET.Element, title: str, context: Context, shapes: list[Shape]) -> None:
        """Add an element with an outline."""
        style, purpose = context.style, context.purpose
        if not (context.in_element and context.in_layer) or style.get("visibility", "visible") != "visible":
            return
        key = (item, context.viewport)
        if key not in self.outlines:
            self.outlines[key] = outline(self.styles.placed(item), context.viewport, self.quota)
        subpaths, name = self.outlines[key], title_of(item)
        if not subpaths:
            return
        if purpose == CLIP:
            rule = style.get("clip-rule", "nonzero")
            shape = Shape(name, subpaths, context.matrix, rule == "evenodd", Paint(1.0))
        else:
            stroke = stroke_of(style, context.viewport)
            if stroke and stroke.dashes and item.get("pathLength"):
                told = attribute(item, "pathLength", context.viewport)
                stroke = stroke.along(length_of(subpaths) / told) if told > 0.0 else stroke
            shape = Shape(
                name,
                subpaths,
                context.matrix,
                style.get("fill-rule", "nonzero") == "evenodd",
                self._paint("fill", "black", context),
                stroke,
                self._paint("stroke", "none", context) if stroke else None,
                style.get("vector-effect") != "non-scaling-stroke",
                title,
                context.groups,
                item.get("class", ""),
            )
        points = [*(path.points for path in subpaths), *shape.placed]
        if not np.abs(np.concatenate(points)).max() < MAX_COORDINATE:
            self.document.faults.add(f"Left out: the {name}, whose coordinates are not finite, or too large")
            return
        shapes.append(shape)
        for end in MARKERS if name_of(item) in MARKED else ():
            if self.document.linked(link_in(style.get(end, "none"))[0]) is not None:
                self.left_out["marker"] += 1

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
            units = item.get("clipPathUnits" if purpose == CLIP else "maskContentUnits", "")
            placed = self._in_box(context, shapes) if units == BOX else context
            own = self.styles.computed(item, {})
            if purpose == MASK:
                purpose = PAINT if own.get("mask-type") == "alpha" else MASK
            inner = replace(
                placed,
                style=own,
                opacity=1.0,
                purpose=purpose,
                in_element=True,
                in_layer=True,
                depth=context.depth + 1,
                users=(*context.users, item),
            )
            _check_depth(inner)
            matrix = self.document.transform(own.get("transform") or "", tag) if purpose == CLIP else np.eye(3)
            content: list[Shape] = []
            for child in item:
                self._add(child, replace(inner, matrix=placed.matrix @ matrix), content)
            clip(content, 0, self._clips(own, inner, content))
            found.append(Clip(content, is_mask=purpose == MASK))
            if tag == "mask":
                units = item.get("maskUnits", BOX)
                found.append(self._mask_region(item, self._in_box(context, shapes) if units == BOX else context))
        return found

    def _in_box(self, context: Context, shapes: list[Shape]) -> Context:
        """A context with the box around shapes as the unit square."""
        viewport = context.viewport.sized(1.0, 1.0)
        return replace(context, matrix=unit_box(shapes, context.matrix), viewport=viewport)

    def _mask_region(self, item: ET.Element, context: Context) -> Clip:
        """The rectangle outside which a mask hides everything; by default a tenth wider than what it belongs to."""
        x, y, width, height = (
            parse_length(item.get(key) or default, key, f"{key} of the mask", context.viewport)
            for key, default in (("x", "-10%"), ("y", "-10%"), ("width", "120%"), ("height", "120%"))
        )
        return rectangular_clip(x, y, width, height, context.matrix, self.quota)


def clip(shapes: list[Shape], first: int, clips: Sequence[Clip]) -> None:
    """Clip shapes from the first on."""
    if clips:
        shapes[first:] = [replace(shape, clips=(*shape.clips, *clips)) for shape in shapes[first:]]


def _check_depth(context: Context) -> None:
    """Raises NestedCagesError beyond the depth of nesting that is read."""
    if context.depth > MAX_DEPTH:
        problem = "The drawing nests its elements too deeply; simplify its groups and references."
        raise NestedCagesError(problem, code="limit.exceeded")
