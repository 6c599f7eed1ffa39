"""Shapes as areas: curves become chains of edges on one side, strokes outlines, clips and masks intersections."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, pairwise
from typing import Any

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh.validation import MAX_COORDINATE
from ...geometry.predicates import loop_windings
from ...geometry.vectors import cross
from ..closing import edges_of
from ..limits import Quota
from ..solids import Area, Painted, bounds_of, regions, shapely, spend, strip_width, union_of
from .curves import MAX_TURN, Pieces, pieces_of
from .document import SvgOptions
from .gradients import visible
from .paints import Paint
from .shapes import Clip, Shape
from .strokes import Polyline, Stroke, stroked
from .transforms import moved

STROKE_FINENESS = 0.2
"""Tolerance of the centre line of a stroke, and of its round parts, relative to that of fills."""

SMALL, THIN, MAX_FINER = 0.005, 0.02, 8.0
"""Default tolerance of small and thin fills over their thickness, the same of strokes over their width, and its largest
ratio to that of other shapes."""

MANY = 1_000_000
"""Loops times points beyond which holes are told by their direction alone."""

Chains = tuple[list[FloatArray], list[FloatArray], FloatArray, bool]
"""Loops on the outer side of the curves of a fill, on the inner one, slivers between them, and whether these sides are
known."""


@dataclass(frozen=True)
class Pen:
    """How the stroke of a shape is drawn."""

    shape: Shape
    stroke: Stroke
    points: list[FloatArray]
    """Control points of its subpaths, where its width is as given."""
    after: FloatArray
    """The matrix from there to the document."""
    tolerance: float
    """Of its centre line, and of its round parts."""

    @property
    def max_turn(self) -> float:
        """The largest angle in radians between edges of its centre line."""
        return float(min(MAX_TURN, 2.0 * np.arccos(1.0 / (1.0 + 2.0 * self.tolerance / self.stroke.width))))


class Areas:
    """Turns shapes into areas that cover them, or with `inside` in the options lie in them.

    tolerance: distance between curves and edges; pixel: width in user units of a non-scaling stroke of width 1.
    """

    def __init__(self, shapes: Sequence[Shape], options: SvgOptions, tolerance: float, pixel: float) -> None:
        self.options = options
        self.tolerance = tolerance
        self.pixel = pixel
        self.quota = Quota(options.limits)
        self.kept: dict[Clip, Any] = {}
        self.fills: dict[Shape, Chains] = {}
        self.strokes: dict[Shape, tuple[Pen, list[Polyline]]] = {}
        everything = list(_with_clips(shapes))
        if not all(np.abs(points).max() < MAX_COORDINATE for shape in everything for points in shape.placed):
            raise invalid_file("The drawing has coordinates that are not finite, or too large; correct them.")
        if fills := [shape for shape in everything if shape.fill and any(path.is_curved for path in shape.subpaths)]:
            self._chain_fills(fills)
        if pens := [pen for shape in everything if shape.stroke_paint and (pen := self._pen(shape)) is not None]:
            self._chain_strokes(pens)

    def of(self, shapes: Sequence[Shape]) -> list[Area]:
        """The areas that shapes paint."""
        found: list[Area] = []
        for clips, members in groupby(shapes, lambda shape: shape.clips):
            areas = [area for shape in members for area in (*self.fill_of(shape), *self.stroke_of(shape))]
            found += self.clipped(areas, clips)
        return found

    def clipped(self, areas: list[Area], clips: Sequence[Clip]) -> list[Area]:
        """Areas within clip paths and masks; those completely inside stay unchanged."""
        for clip in clips:
            if not areas:
                break
            if clip not in self.kept:
                self.kept[clip] = union_of(
                    self._masked(clip.shapes) if clip.is_mask else self.of(clip.shapes), self.quota
                )
            low, high = bounds_of(areas)
            if not shapely.covers(self.kept[clip], shapely.box(*low, *high)):
                areas = [self._of_two(shapely.intersection, union_of(areas, self.quota), self.kept[clip])]
        return areas

    def fill_of(self, shape: Shape) -> list[Area]:
        """The area that the fill of a shape paints, before it is clipped."""
        if shape.fill is None:
            return []
        return self._painted(shape, shape.fill, self._filled(shape, inside=self.options.inside))

    def stroke_of(self, shape: Shape) -> list[Area]:
        """The area that the stroke of a shape paints, before it is clipped."""
        if shape.stroke is None or shape.stroke_paint is None or not self.options.strokes:
            return []
        return self._painted(shape, shape.stroke_paint, self._stroked(shape, inside=self.options.inside))

    def _chain_fills(self, shapes: Sequence[Shape]) -> None:
        """Make chains of edges of the curves of all fills at once."""
        tolerances = [self._tolerance(shape) for shape in shapes]
        pieces, first = self._pieces(shapes, [shape.placed for shape in shapes], tolerances, [MAX_TURN] * len(shapes))
        ends = np.split(pieces.stops, pieces.first[1:-1])
        own = [slice(*each) for each in pairwise(first)]
        known = [_sides(ends[part], evenodd=shape.evenodd) for shape, part in zip(shapes, own, strict=True)]
        sides = np.concatenate([side for side, _ in known])
        outer, inner, slivers = pieces.chains(sides), pieces.chains(-sides), pieces.slivers()
        bent = np.append(0, np.cumsum(pieces.turns != 0))[pieces.first[first]]
        for k, (shape, part) in enumerate(zip(shapes, own, strict=True)):
            self.fills[shape] = outer[part], inner[part], slivers[bent[k] : bent[k + 1]], known[k][1]

    def _chain_strokes(self, pens: Sequence[Pen]) -> None:
        """Make lines of the curves of all strokes at once."""
        turns = [pen.max_turn for pen in pens]
        tolerances = [pen.tolerance for pen in pens]
        pieces, first = self._pieces([pen.shape for pen in pens], [pen.points for pen in pens], tolerances, turns)
        *bounds, cusps = pieces.errors(pieces.first[first[:-1]], np.array(turns))
        found = pieces.lines()
        for pen, own, error, turn in zip(pens, pairwise(first), *bounds, strict=True):
            paths = zip(pen.shape.subpaths, range(*own), strict=True)
            lines = [Polyline(*found[k], path.closed, float(error), float(turn), cusps[k]) for path, k in paths]
            self.strokes[pen.shape] = pen, lines

    def _pieces(
        self,
        shapes: Sequence[Shape],
        points: Iterable[Sequence[FloatArray]],
        tolerances: Sequence[float],
        max_turns: Sequence[float],
    ) -> tuple[Pieces, IntArray]:
        """Pieces of shapes whose control points were moved, the first subpath of each shape, and their number."""
        counts = [len(shape.subpaths) for shape in shapes]
        pieces = pieces_of(
            [path for shape in shapes for path in shape.subpaths],
            [each for own in points for each in own],
            np.repeat(tolerances, counts),
            np.repeat(max_turns, counts),
            partial(self.quota.spend, "points"),
        )
        return pieces, np.append(0, np.cumsum(counts))

    def _tolerance(self, shape: Shape) -> float:
        """Of the edges of a fill: finer for thin ones, unless the tolerance is given."""
        if self.options.tolerance is not None:
            return self.tolerance
        return min(max(SMALL * abs(strip_width(shape.placed)), self.tolerance / MAX_FINER), self.tolerance)

    def _filled(self, shape: Shape, *, inside: bool) -> list[Area]:
        """Areas that cover the inside of a shape, or lie in it.

        Chains of edges differ from curves in slivers alone: what they enclose, with those slivers that it does not
        cover, covers the shape, and without those that it does not leave out lies in the shape.
        """
        if shape not in self.fills:
            self.quota.spend("points", sum(map(len, shape.placed)))
            return [Painted(shape.placed, shape.evenodd)]
        loops, others, slivers, alternate = self.fills[shape]
        if inside:
            loops, others = others, loops
        region = _enclosed(loops) if alternate else None
        if region is None:
            others = [*loops, *others]
            (region,) = regions([Painted(loops, shape.evenodd)], self.quota)
        free = region
        if inside:
            low, high = bounds_of([Painted([*slivers, *loops])])
            free = shapely.box(*(low - self.tolerance), *(high + self.tolerance)) - region
        left = _uncovered(free, shapely.MultiLineString(others), slivers)
        painted = Painted(loops, shape.evenodd, region)
        if not inside:
            return [painted, *left]
        return [self._of_two(shapely.difference, region, union_of(left, self.quota))] if len(left) else [painted]

    def _painted(self, shape: Shape, paint: Paint, areas: list[Area]) -> list[Area]:
        """The visible parts of areas."""
        seen = paint.alphas > self.options.faintest
        if paint.gradient is None or seen.all() or not seen.any():
            return areas if seen.all() else []
        whole = union_of(areas, self.quota)
        if whole.is_empty:
            return []
        matrix, inside = shape.units_of(paint.gradient), self.options.inside
        part = visible(paint.gradient, paint.opacity, self.options.faintest, matrix, whole.bounds, inside=inside)
        return [self._of_two(shapely.intersection, whole, part)]

    def _pen(self, shape: Shape) -> Pen | None:
        """How to draw the stroke of a shape; None if it has no extent."""
        stroke, points, after = shape.stroke, [path.points for path in shape.subpaths], shape.matrix
        if stroke is None:
            return None
        if not shape.scales:
            stroke, points, after = stroke.scaled(self.pixel), shape.placed, np.eye(3)
        scale = float(np.linalg.norm(after[:2, :2], 2))
        if not scale > 0.0 or np.linalg.det(after[:2, :2]) == 0.0:
            return None
        tolerance = self.tolerance / scale
        if self.options.tolerance is None:
            tolerance = min(tolerance, max(THIN * stroke.width, tolerance / MAX_FINER))
        return Pen(shape, stroke, points, after, STROKE_FINENESS * tolerance)

    def _stroked(self, shape: Shape, *, inside: bool) -> list[Area]:
        """The area of the stroke of a shape."""
        if shape not in self.strokes:
            return []
        pen, lines = self.strokes[shape]
        parts = stroked(lines, pen.stroke, pen.tolerance, self.quota, inside=inside)
        self.quota.spend("points", int(shapely.get_num_coordinates(parts).sum()))
        return list(shapely.transform(parts, lambda points: moved(points, pen.after)))

    def _of_two(self, operation: Callable[[Any, Any], Any], one: Any, other: Any) -> Any:
        """What an operation of shapely makes of two areas, without lines and points; crossings are counted before."""
        spend([one, other], self.quota)
        return polygonal(operation(one, other))

    def _masked(self, shapes: Sequence[Shape]) -> list[Area]:
        """The region where a mask is more opaque than the faintest share: its shapes in order, by luminance.

        What hides others is inside of its outline where what shows them is outside of its own, and the other way round.
        """
        kept: list[Any] = []
        within = self.options.inside
        for shape in shapes:
            for paint, drawn in ((shape.fill, self._filled), (shape.stroke_paint, self._stroked)):
                if paint is None:
                    continue
                light = paint.opacity * paint.colour.luminance
                if paint.gradient is not None:
                    shown = replace(paint, gradient=paint.gradient.as_light())
                    kept += self.clipped(self._painted(shape, shown, drawn(shape, inside=within)), shape.clips)
                elif light > self.options.faintest:
                    kept += self.clipped(drawn(shape, inside=within), shape.clips)
                elif 1.0 - paint.opacity + light <= self.options.faintest:
                    hidden = self.clipped(drawn(shape, inside=not within), shape.clips)
                    rest, region = (union_of(each, self.quota) for each in (kept, hidden))
                    kept = [self._of_two(shapely.difference, rest, region)]
        return kept


def _with_clips(shapes: Iterable[Shape]) -> Iterator[Shape]:
    """Shapes and those that they are clipped by, each once."""
    waiting, known = list(shapes), set[Clip]()
    while waiting:
        shape = waiting.pop()
        yield shape
        for clip in shape.clips:
            if clip not in known:
                known.add(clip)
                waiting += clip.shapes


def _sides(loops: Sequence[FloatArray], *, evenodd: bool) -> tuple[IntArray, bool]:
    """(L,) the side of loops (k, 2) that is not painted, 1 for the right, -1 for the left; whether each has one.

    It is a guess where loops cross themselves or each other.
    """
    starts, ends = edges_of(loops)
    owner = np.repeat(np.arange(len(loops)), list(map(len, loops)))
    origin = np.array([loop[0] for loop in loops])[owner]
    own = np.where(np.bincount(owner, cross(starts - origin, ends - origin)) < 0.0, -1, 1)
    if len(loops) == 1 or len(loops) * len(starts) > MANY:
        return own, len(loops) == 1
    point, loop, winding = loop_windings(np.array([loop[0] for loop in loops]), starts, ends, owner)
    others = point != loop
    around = np.bincount(point[others], winding[others], len(loops)).astype(np.int64)
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
    shapely.prepare(region)
    if shapely.covers(region, outlines):
        parts = shapely.get_parts(region)
        holed = shapely.get_num_interior_rings(parts).any()
        largest = _areas(slivers).max(initial=0.0)
        if not holed or shapely.area(shapely.polygons(shapely.get_rings(parts))).min() > largest:
            return np.zeros(0, object)
    shapes = shapely.polygons(slivers)
    found = shapes[~shapely.covers(region, shapes)]
    return np.where(shapely.is_valid(found), found, shapely.convex_hull(found))


def _areas(loops: FloatArray) -> FloatArray:
    """(C,) areas of loops (C, k, 2)."""
    return np.asarray(np.abs(cross(loops - loops[:, :1], np.roll(loops, -1, axis=1) - loops[:, :1]).sum(axis=1)) / 2.0)


def polygonal(region: Any) -> Any:
    """A region without the lines and points where areas only touch."""
    if region.geom_type in ("Polygon", "MultiPolygon"):
        return region
    parts = shapely.get_parts(region)
    return shapely.MultiPolygon(list(shapely.get_parts(parts[shapely.get_dimensions(parts) == 2])))
