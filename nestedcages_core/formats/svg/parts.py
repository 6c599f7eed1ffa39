"""The parts of a layered SVG: each shape with its paints, its groups and its place in the stack."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import numpy as np

from ...errors import InvalidMeshError
from ...geometry.mesh import Mesh
from ..solids import Area, shapely, union_of
from .areas import Areas
from .elements import is_automatic, name_of
from .gradients import Shading
from .paints import Paint
from .reading import Reading
from .shapes import Shape

Colour = tuple[float, float, float, float]
"""sRGB and opacity, from 0 to 1."""

UNPAINTED: Colour = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class SvgPart:
    """What one shape paints, in user units, y pointing down."""

    name: str
    """Its label or id; else that of the innermost group, or its kind, and its number. Names that programs made up count
    less, and no shape is named after a group around all of them."""
    groups: tuple[str, ...]
    """Names of the groups around it, the outermost first."""
    fill: Mesh | None
    """What is seen of the fill: without the stroke, which lies on it. Along it both have the same points."""
    fill_colour: Colour
    """The mean of its stops for a gradient."""
    fill_gradient: Shading | None
    """The colours of a gradient by their places."""
    stroke: Mesh | None
    stroke_colour: Colour
    stroke_gradient: Shading | None


def svg_parts(text: str | bytes, **options: Any) -> tuple[tuple[SvgPart, ...], tuple[str, ...]]:
    """The shapes of a document with their paints, the lowest first, and notes on omissions.

    options: fields of `SvgOptions`. Raises NestedCagesError as `from_svg`.
    """
    reading = Reading(text, options)
    if any(name_of(item) == "pattern" for item in reading.document.root.iter()):
        reading.document.faults.add("Patterns become their mean colour")

    def work(shapes: Sequence[Shape], areas: Areas) -> tuple[SvgPart, ...]:
        found: list[SvgPart] = []
        around = _around_all(shapes)
        for number, shape in enumerate(shapes, 1):
            fill, stroke = (areas.clipped(paint(shape), shape.clips) for paint in (areas.fill_of, areas.stroke_of))
            made = [_mesh(each, reading, areas) for each in _disjoint(fill, stroke, areas)]
            if made != [None, None]:
                found.append(_svg_part(shape, number, around, *made))
        if not found:
            raise InvalidMeshError("The shapes have no inside.", code="mesh.empty")
        return tuple(found)

    parts: tuple[SvgPart, ...] = reading.made(work)
    return parts, reading.said()


def _around_all(shapes: Sequence[Shape]) -> int:
    """The number of groups that all shapes are in."""
    levels = zip(*(shape.groups for shape in shapes), strict=False)
    return sum(1 for _ in takewhile(lambda level: len(set(level)) == 1, levels))


def _given(groups: tuple[str, ...]) -> tuple[str, ...]:
    """Those groups that an artist named."""
    return tuple(group for group in groups if not is_automatic(group))


def _svg_part(shape: Shape, number: int, around: int, fill: Mesh | None, stroke: Mesh | None) -> SvgPart:
    """around: number of the groups that all shapes are in."""
    outer, inner = shape.groups[:around], shape.groups[around:]
    inner = _given(inner) or inner
    own = "" if inner and is_automatic(shape.id) else shape.id
    kind = inner[-1] if inner else shape.name.partition(" ")[0]
    return SvgPart(
        own or f"{kind} {number}",
        (*_given(outer), *inner),
        fill,
        shape.fill.rgba if shape.fill else UNPAINTED,
        _shading(shape, shape.fill),
        stroke,
        shape.stroke_paint.rgba if shape.stroke_paint else UNPAINTED,
        _shading(shape, shape.stroke_paint),
    )


def _shading(shape: Shape, paint: Paint | None) -> Shading | None:
    """The colours of a gradient of a shape; None for one colour, and for what is flattened to a line."""
    if paint is None or paint.gradient is None:
        return None
    matrix = shape.units_of(paint.gradient) @ paint.gradient.matrix
    if not abs(np.linalg.det(matrix[:2, :2])) > 0.0:
        return None
    return Shading(paint.gradient, paint.opacity, np.asarray(np.linalg.inv(matrix)))


def _mesh(found: list[Area], reading: Reading, areas: Areas) -> Mesh | None:
    """Areas as a mesh, None where nothing is inside."""
    try:
        return reading.solid(found, areas) if found else None
    except InvalidMeshError:
        return None


def _disjoint(fill: list[Area], stroke: list[Area], areas: Areas) -> tuple[list[Area], list[Area]]:
    """Fill and stroke without overlap, with the same points along their common border."""
    if not fill or not stroke:
        return fill, stroke
    inner, outer = (union_of(each, areas.quota) for each in (fill, stroke))
    lines = shapely.union_all([shapely.boundary(each) for each in (inner, outer)])
    faces = shapely.get_parts(shapely.polygonize([lines]))
    middles = shapely.point_on_surface(faces)
    of_stroke = shapely.contains(outer, middles)
    of_fill = shapely.contains(inner, middles) & ~of_stroke
    return [shapely.union_all(faces[of_fill])] if of_fill.any() else [], [shapely.union_all(faces[of_stroke])]
