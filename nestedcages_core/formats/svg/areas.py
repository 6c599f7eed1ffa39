"""A scene as areas: curves become chords, strokes outlines, clips and masks intersections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray
from ...geometry.mesh.validation import MAX_COORDINATE
from ..limits import Quota
from ..solids import Area, Painted, bounds_of, shapely, spend, strip_width, union_of
from .fading import visible
from .nodes import Clip, Group, Shape
from .options import SvgOptions
from .paints import Paint
from .path_data import Subpath, flattened
from .strokes import Polyline, Stroke, stroked
from .transforms import moved, scaling, translation

STROKE_FINENESS = 0.25
"""Tolerance of the centre line of a stroke, relative to that of its outline."""

SMALL, THIN, MAX_FINER = 0.005, 0.02, 8.0
"""Default tolerance of small and thin fills over their thickness, the same of strokes over their width, and its largest
ratio to that of other shapes."""


AreasOf = Callable[[Shape, FloatArray], list[Area]]


class Areas:
    """Turns the shapes of a scene into areas.

    tolerance: largest distance between curves and chords; pixel: width in user units of a non-scaling stroke of
    width 1.
    """

    def __init__(self, options: SvgOptions, tolerance: float, pixel: float) -> None:
        self.options = options
        self.tolerance = tolerance
        self.pixel = pixel
        self.quota = Quota(options.limits)

    def of(self, node: Group | Shape, outer: FloatArray) -> list[Area]:
        """The areas that a node paints. outer: from its units to those of the document."""
        if isinstance(node, Shape):
            return self._of_shape(node, outer)
        return self._kept([area for child in node.children for area in self.of(child, outer)], node, outer)

    def parts(
        self, node: Group | Shape, outer: FloatArray, painted: AreasOf | None = None
    ) -> Iterator[tuple[Shape, list[Area]]]:
        """Each shape of a node with the areas that it paints, those that paint none left out.

        painted: `fill_of` or `stroke_of` for these alone.
        """
        if isinstance(node, Shape):
            yield node, (painted or self._of_shape)(node, outer)
            return
        for child in node.children:
            for shape, areas in self.parts(child, outer, painted):
                kept = self._kept(areas, node, outer)
                if kept:
                    yield shape, kept

    def _kept(self, areas: list[Area], group: Group, outer: FloatArray) -> list[Area]:
        """Areas of a group after its clip paths and masks."""
        for clip in group.clips:
            if areas:
                areas = self._clipped(areas, group, clip, outer)
        return areas

    def _of_shape(self, shape: Shape, outer: FloatArray) -> list[Area]:
        return [*self.fill_of(shape, outer), *self.stroke_of(shape, outer)]

    def fill_of(self, shape: Shape, outer: FloatArray) -> list[Area]:
        """The area that the fill of a shape paints."""
        if shape.fill is None:
            return []
        return self._painted(shape, shape.fill, [self._filled(shape, outer @ shape.matrix)], outer)

    def stroke_of(self, shape: Shape, outer: FloatArray) -> list[Area]:
        """The area that the stroke of a shape paints."""
        if shape.stroke is None or shape.stroke_paint is None or not self.options.strokes:
            return []
        areas = self._stroked(shape, shape.stroke, outer @ shape.matrix)
        return self._painted(shape, shape.stroke_paint, areas, outer)

    def _filled(self, shape: Shape, matrix: FloatArray) -> Painted:
        """The inside of a shape; curves of thin shapes have finer chords, unless the tolerance is given."""
        tolerance = self.tolerance
        loops = [self._flat(path, matrix, tolerance) for path in shape.subpaths]
        if self.options.tolerance is None and any(path.is_curved for path in shape.subpaths):
            finer = max(SMALL * abs(strip_width(loops)), tolerance / MAX_FINER)
            if finer < tolerance:
                loops = [self._flat(path, matrix, finer) for path in shape.subpaths]
        return Painted(loops, shape.evenodd)

    def _flat(self, path: Subpath, matrix: FloatArray, tolerance: float) -> FloatArray:
        points = moved(path.points, matrix)
        if not np.abs(points).max() < MAX_COORDINATE:
            raise invalid_file("The drawing has coordinates that are not finite, or too large; correct them.")
        return flattened(points, path.degrees, tolerance, partial(self.quota.spend, "points"))

    def _painted(self, shape: Shape, paint: Paint, areas: list[Area], outer: FloatArray) -> list[Area]:
        """The visible parts of areas."""
        seen = paint.alphas > self.options.faintest
        if paint.gradient is None or seen.all() or not seen.any():
            return areas if seen.all() else []
        whole = union_of(areas, self.quota)
        if whole.is_empty:
            return []
        matrix = outer @ shape.matrix
        box = _box(self._outline(replace(shape, matrix=np.eye(3)), np.eye(3)))
        gradient, faintest = paint.gradient, self.options.faintest
        part = visible(gradient, paint.alphas, faintest, box, matrix, shapely.bounds(whole))
        return [self._of_two(shapely.intersection, whole, part)]

    def _stroked(self, shape: Shape, stroke: Stroke, matrix: FloatArray) -> list[Area]:
        """The area of a stroke."""
        before, after = (np.eye(3), matrix) if shape.scales else (matrix, np.eye(3))
        if not shape.scales:
            stroke = stroke.scaled(self.pixel)
        scale = float(np.linalg.norm(after[:2, :2], 2))
        if not scale > 0.0 or np.linalg.det(after[:2, :2]) == 0.0:
            return []
        tolerance = self.tolerance / scale
        if self.options.tolerance is None:
            tolerance = min(tolerance, max(THIN * stroke.width, tolerance / MAX_FINER))
        lines = [
            Polyline(self._flat(path, before, STROKE_FINENESS * tolerance), path.closed) for path in shape.subpaths
        ]
        parts = stroked(lines, stroke, tolerance, self.quota)
        self.quota.spend("points", int(shapely.get_num_coordinates(parts).sum()))
        return [shapely.transform(part, lambda points: moved(points, after)) for part in parts]

    def _outline(self, node: Group | Shape, outer: FloatArray) -> list[FloatArray]:
        """Points of the outlines of a node, regardless of paint."""
        shapes = [node] if isinstance(node, Shape) else node.shapes()
        return [self._flat(path, outer @ shape.matrix, self.tolerance) for shape in shapes for path in shape.subpaths]

    def _of_two(self, operation: Callable[[Any, Any], Any], one: Any, other: Any) -> Any:
        """What an operation of shapely makes of two areas, their crossings counted before."""
        spend([one, other], self.quota)
        return operation(one, other)

    def _clipped(self, areas: list[Area], group: Group, clip: Clip, outer: FloatArray) -> list[Area]:
        """The areas of a group within a clip path or mask; areas completely inside stay unchanged."""
        matrix = outer @ clip.matrix
        if clip.of_box:
            if np.linalg.det(clip.matrix[:2, :2]) == 0.0:
                return []
            low, high = _box(self._outline(group, np.asarray(np.linalg.inv(clip.matrix), np.float64)))
            matrix = matrix @ translation(*low) @ scaling(*(high - low))
        low, high = bounds_of(areas)
        inside = self._masked(clip.content, matrix) if clip.is_mask else self.of(clip.content, matrix)
        if len(inside) == 1 and _is_box_around(inside[0], low, high):
            return areas
        kept = union_of(inside, self.quota)
        if shapely.covers(kept, shapely.box(*low, *high)):
            return areas
        return [self._of_two(shapely.intersection, union_of(areas, self.quota), kept)]

    def _masked(self, content: Group, outer: FloatArray) -> list[Area]:
        """The region where a mask is more opaque than the faintest share: its shapes in order, by luminance."""
        kept: list[Any] = []
        for shape in content.shapes():
            matrix = outer @ shape.matrix
            layers: list[tuple[Paint, Sequence[Area]]] = []
            if shape.fill is not None:
                layers.append((shape.fill, [self._filled(shape, matrix)]))
            if shape.stroke is not None and shape.stroke_paint is not None:
                layers.append((shape.stroke_paint, self._stroked(shape, shape.stroke, matrix)))
            for paint, part in layers:
                light = paint.opacity * paint.colour.luminance
                if paint.gradient is not None:
                    kept += self._painted(shape, replace(paint, gradient=paint.gradient.as_light()), list(part), outer)
                elif light > self.options.faintest:
                    kept += part
                elif 1.0 - paint.opacity + light <= self.options.faintest:
                    rest, region = (union_of(areas, self.quota) for areas in (kept, part))
                    kept = [self._of_two(shapely.difference, rest, region)]
        clipped: list[Area] = [union_of(kept, self.quota)]
        for clip in content.clips:
            clipped = self._clipped(clipped, content, clip, outer)
        return clipped


def _box(outlines: list[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right corner."""
    points = np.concatenate(outlines)
    return points.min(axis=0), points.max(axis=0)


def _is_box_around(area: Any, low: FloatArray, high: FloatArray) -> bool:
    """Whether an area is a rectangle along the axes that covers another one."""
    if not isinstance(area, Painted) or len(area.loops) != 1:
        return False
    (loop,) = area.loops
    least, most = loop.min(axis=0), loop.max(axis=0)
    is_rectangle = len(loop) in (4, 5) and all(len(np.unique(loop[:, axis])) == 2 for axis in (0, 1))
    return is_rectangle and len(np.unique(loop, axis=0)) == 4 and bool((least <= low).all() and (most >= high).all())
