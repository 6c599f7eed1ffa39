"""A scene as areas: curves become chains of edges on one side, strokes outlines, clips and masks intersections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh.validation import MAX_COORDINATE
from ..limits import Quota
from ..solids import Area, Painted, bounds_of, regions, shapely, spend, strip_width, union_of
from .curves import MAX_TURN, Pieces, Subpath, cross, pieces_of
from .fading import visible
from .nodes import Clip, Group, Shape
from .options import SvgOptions
from .paints import Gradient, Paint
from .strokes import Polyline, Stroke, stroked
from .transforms import moved, scaling, translation

STROKE_FINENESS = 0.2
"""Tolerance of the centre line of a stroke, and of its round parts, relative to that of fills."""

SMALL, THIN, MAX_FINER = 0.005, 0.02, 8.0
"""Default tolerance of small and thin fills over their thickness, the same of strokes over their width, and its largest
ratio to that of other shapes."""

BOX_FINENESS = 1e-4
"""Tolerance of boxes around curves, relative to that of their chords."""

MANY = 1_000_000
"""Loops times points beyond which holes are told by their direction alone."""

AreasOf = Callable[[Shape, FloatArray], list[Area]]


class Areas:
    """Turns the shapes of a scene into areas that cover them, or with `inside` in the options lie in them.

    tolerance: distance between curves and edges; pixel: width in user units of a non-scaling stroke of width 1.
    """

    def __init__(self, options: SvgOptions, tolerance: float, pixel: float) -> None:
        self.options = options
        self.tolerance = tolerance
        self.pixel = pixel
        self.inside = options.inside
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
        return self._painted(shape, shape.fill, self._filled(shape, outer @ shape.matrix), outer)

    def stroke_of(self, shape: Shape, outer: FloatArray) -> list[Area]:
        """The area that the stroke of a shape paints."""
        if shape.stroke is None or shape.stroke_paint is None or not self.options.strokes:
            return []
        areas = self._stroked(shape, shape.stroke, outer @ shape.matrix)
        return self._painted(shape, shape.stroke_paint, areas, outer)

    def _filled(self, shape: Shape, matrix: FloatArray) -> list[Area]:
        """The inside of a shape; curves of thin shapes have finer edges, unless the tolerance is given.

        Chains of edges differ from curves in slivers alone: what they enclose, with those slivers that it does not
        cover, covers the shape, and without those that it does not leave out lies in the shape.
        """
        points = [self._moved(path, matrix) for path in shape.subpaths]
        if not any(path.is_curved for path in shape.subpaths):
            self.quota.spend("points", sum(map(len, points)))
            return [Painted(points, shape.evenodd)]
        tolerance = self.tolerance
        if self.options.tolerance is None:
            tolerance = min(max(SMALL * abs(strip_width(points)), tolerance / MAX_FINER), tolerance)
        pieces = self._pieces(shape.subpaths, points, tolerance)
        sides, alternate = _sides(np.split(pieces.stops, pieces.first[1:-1]), evenodd=shape.evenodd)
        sides *= -1 if self.inside else 1
        loops, slivers = pieces.chains(sides), pieces.slivers()
        region = _enclosed(loops) if alternate else None
        inner = pieces.chains(-sides) if region is not None else [*loops, *pieces.chains(-sides)]
        if region is None:
            (region,) = regions([Painted(loops, shape.evenodd)], self.quota)
        free = region
        if self.inside:
            low, high = bounds_of([Painted([*slivers, *loops])])
            free = shapely.box(*(low - tolerance), *(high + tolerance)) - region
        left = _uncovered(free, shapely.MultiLineString(inner), slivers)
        painted = Painted(loops, shape.evenodd, region)
        if not self.inside:
            return [painted, *left]
        return [self._of_two(shapely.difference, region, union_of(left, self.quota))] if len(left) else [painted]

    def _pieces(
        self, paths: Sequence[Subpath], points: Sequence[FloatArray], tolerance: float, max_turn: float = MAX_TURN
    ) -> Pieces:
        return pieces_of(paths, points, tolerance, max_turn, partial(self.quota.spend, "points"))

    def _moved(self, path: Subpath, matrix: FloatArray) -> FloatArray:
        points = moved(path.points, matrix)
        if not np.abs(points).max() < MAX_COORDINATE:
            raise invalid_file("The drawing has coordinates that are not finite, or too large; correct them.")
        return points

    def _painted(self, shape: Shape, paint: Paint, areas: list[Area], outer: FloatArray) -> list[Area]:
        """The visible parts of areas."""
        seen = paint.alphas > self.options.faintest
        if paint.gradient is None or seen.all() or not seen.any():
            return areas if seen.all() else []
        whole = union_of(areas, self.quota)
        if whole.is_empty:
            return []
        matrix = outer @ self.units_of(shape, paint.gradient)
        part = visible(paint.gradient, paint.alphas, self.options.faintest, matrix, whole.bounds, inside=self.inside)
        return [self._of_two(shapely.intersection, whole, part)]

    def units_of(self, shape: Shape, gradient: Gradient) -> FloatArray:
        """The matrix (3, 3) to the document from the units of a gradient of a shape, before its own matrix."""
        box = self._outline(replace(shape, matrix=np.eye(3)), np.eye(3)) if gradient.of_box else None
        return shape.matrix if box is None else np.asarray(shape.matrix @ _unit_box(box))

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
        tolerance *= STROKE_FINENESS
        max_turn = min(MAX_TURN, 2.0 * np.arccos(1.0 / (1.0 + 2.0 * tolerance / stroke.width)))
        points = [self._moved(path, before) for path in shape.subpaths]
        pieces = self._pieces(shape.subpaths, points, tolerance, max_turn)
        errors = pieces.errors()
        found: list[tuple[FloatArray, FloatArray | None]] = [*pieces.lines()] if stroke.dashes else []
        if not stroke.dashes:
            found = [(chain, None) for chain in pieces.chains(np.zeros(len(points), dtype=np.int64))]
        lines = [
            Polyline(chain, path.closed, least, *errors)
            for path, (chain, least) in zip(shape.subpaths, found, strict=True)
        ]
        parts = stroked(lines, stroke, tolerance, self.quota, inside=self.inside)
        self.quota.spend("points", int(shapely.get_num_coordinates(parts).sum()))
        return list(shapely.transform(parts, lambda points: moved(points, after)))

    def _outline(self, node: Group | Shape, outer: FloatArray) -> list[FloatArray]:
        """Points of the outlines of a node, regardless of paint."""
        shapes = [node] if isinstance(node, Shape) else node.shapes()
        fine = BOX_FINENESS * self.tolerance
        return [
            self._pieces(
                shape.subpaths, [self._moved(path, outer @ shape.matrix) for path in shape.subpaths], fine
            ).stops
            for shape in shapes
        ]

    def _of_two(self, operation: Callable[[Any, Any], Any], one: Any, other: Any) -> Any:
        """What an operation of shapely makes of two areas, without lines and points; crossings are counted before."""
        spend([one, other], self.quota)
        return polygonal(operation(one, other))

    def _clipped(self, areas: list[Area], group: Group, clip: Clip, outer: FloatArray) -> list[Area]:
        """The areas of a group within a clip path or mask; areas completely inside stay unchanged."""
        matrix = outer @ clip.matrix
        if clip.of_box:
            if np.linalg.det(clip.matrix[:2, :2]) == 0.0:
                return []
            matrix = matrix @ _unit_box(self._outline(group, np.asarray(np.linalg.inv(clip.matrix), np.float64)))
        low, high = bounds_of(areas)
        inside = self._masked(clip.content, matrix) if clip.is_mask else self.of(clip.content, matrix)
        if len(inside) == 1 and _is_box_around(inside[0], low, high):
            return areas
        kept = union_of(inside, self.quota)
        if shapely.covers(kept, shapely.box(*low, *high)):
            return areas
        return [self._of_two(shapely.intersection, union_of(areas, self.quota), kept)]

    def _masked(self, content: Group, outer: FloatArray) -> list[Area]:
        """The region where a mask is more opaque than the faintest share: its shapes in order, by luminance.

        What hides others is inside of its outline where what shows them is outside of its own, and the other way round.
        """
        kept: list[Any] = []
        for shape in content.shapes():
            matrix = outer @ shape.matrix
            for paint, drawn in ((shape.fill, self._filled), (shape.stroke_paint, self._drawn)):
                if paint is None:
                    continue
                light = paint.opacity * paint.colour.luminance
                if paint.gradient is not None:
                    shown = replace(paint, gradient=paint.gradient.as_light())
                    kept += self._painted(shape, shown, drawn(shape, matrix), outer)
                elif light > self.options.faintest:
                    kept += drawn(shape, matrix)
                elif 1.0 - paint.opacity + light <= self.options.faintest:
                    self.inside = not self.inside
                    hidden = drawn(shape, matrix)
                    self.inside = not self.inside
                    rest, region = (union_of(each, self.quota) for each in (kept, hidden))
                    kept = [self._of_two(shapely.difference, rest, region)]
        clipped: list[Area] = [union_of(kept, self.quota)]
        for clip in content.clips:
            clipped = self._clipped(clipped, content, clip, outer)
        return clipped

    def _drawn(self, shape: Shape, matrix: FloatArray) -> list[Area]:
        """The area of the stroke of a shape, if it has one."""
        return self._stroked(shape, shape.stroke, matrix) if shape.stroke else []


def _sides(loops: Sequence[FloatArray], *, evenodd: bool) -> tuple[IntArray, bool]:
    """(L,) the side of loops (k, 2) that is not painted, 1 for the right, -1 for the left; whether each has one.

    It is a guess where loops cross themselves or each other.
    """
    starts = np.concatenate(loops)
    ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    owner = np.repeat(np.arange(len(loops)), list(map(len, loops)))
    origin = np.array([loop[0] for loop in loops])[owner]
    own = np.where(np.bincount(owner, cross(starts - origin, ends - origin)) < 0.0, -1, 1)
    if len(loops) == 1 or len(loops) * len(starts) > MANY:
        return own, len(loops) == 1
    x, y = np.array([loop[0] for loop in loops]).T[:, :, None]
    (x0, y0), (x1, y1) = starts.T, ends.T
    to_right = x < x0 + (y - y0) / (y1 - y0) * (x1 - x0)
    crossing = np.where(to_right, ((y0 <= y) & (y < y1)).astype(np.int64) - ((y1 <= y) & (y < y0)), 0)
    crossing[np.arange(len(loops))[:, None] == owner] = 0
    around = crossing.sum(axis=1)
    beyond, within = (around % 2, (around + 1) % 2) if evenodd else (around, around + own)
    return np.where((beyond != 0) & (within == 0), -own, own), bool(((beyond != 0) != (within != 0)).all())


def _enclosed(loops: Sequence[FloatArray]) -> Any:
    """The region between loops that neither cross nor touch, nested alternately; None where they do not."""
    if min(map(len, loops)) < 4:
        return None
    rings = [shapely.LinearRing(loop) for loop in loops]
    region = shapely.Polygon(rings[0]) if len(rings) == 1 else shapely.build_area(shapely.GeometryCollection(rings))
    whole = shapely.get_num_coordinates(region) == shapely.get_num_coordinates(rings).sum()
    return region if whole and region.is_valid else None


def _uncovered(region: Any, outlines: Any, slivers: FloatArray) -> Any:
    """Polygons of those slivers (C, 6, 2) that a region does not cover.

    outlines: lines along all of them. A sliver whose outline is covered is covered, unless a hole is as small.
    """
    shapes = shapely.polygons(slivers)
    holes = [ring for part in shapely.get_parts(region) for ring in part.interiors]
    shapely.prepare(region)
    roomy = not holes or shapely.area(shapely.polygons(holes)).min() > shapely.area(shapes).max()
    if roomy and shapely.covers(region, outlines):
        return shapes[:0]
    found = shapes[~shapely.covers(region, shapes)]
    return np.where(shapely.is_valid(found), found, shapely.convex_hull(found))


def polygonal(region: Any) -> Any:
    """A region without the lines and points where areas only touch."""
    if region.geom_type in ("Polygon", "MultiPolygon"):
        return region
    parts = shapely.get_parts(region)
    return shapely.MultiPolygon(list(shapely.get_parts(parts[shapely.get_dimensions(parts) == 2])))


def _unit_box(outlines: list[FloatArray]) -> FloatArray:
    """The matrix that takes the unit square to the box around outlines."""
    points = np.concatenate(outlines)
    return translation(*points.min(axis=0)) @ scaling(*np.ptp(points, axis=0))


def _is_box_around(area: Any, low: FloatArray, high: FloatArray) -> bool:
    """Whether an area is a rectangle along the axes that covers another one."""
    if not isinstance(area, Painted) or len(area.loops) != 1:
        return False
    (loop,) = area.loops
    least, most = loop.min(axis=0), loop.max(axis=0)
    is_rectangle = len(loop) in (4, 5) and all(len(np.unique(loop[:, axis])) == 2 for axis in (0, 1))
    return is_rectangle and len(np.unique(loop, axis=0)) == 4 and bool((least <= low).all() and (most >= high).all())
