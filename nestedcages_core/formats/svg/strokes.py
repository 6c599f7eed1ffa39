"""Outlines of strokes: width, caps, joins and dashes (SVG 1.1, section 11.4)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray
from ...geometry.vectors import cross, norm, rotated_left
from ..limits import Limits, Quota
from ..solids import shapely, spend
from .curves import angle_between
from .lengths import Viewport, numbers, parse_length

MAX_ARC_SEGMENTS = 64
"""Maximum number of chords of a quarter circle at a cap or join."""

SNAP, PARALLEL, SHALLOW = 2e-4, 1e-3, 0.0125
"""What GEOS takes liberties with, over half the width: points that close are one, turns below (radians) have no join,
and dents that deep are levelled."""

TIE = 1e-6
"""Segments of a join beyond a half that GEOS may round down."""

TIGHT = 1.2
"""Factor on the width up to which bends are tight."""

ROUNDING = 1.0 - 2.0**-38
"""Factor on the size of parts of a stroke that its outline has to cover."""

NAMES = {"butt": "flat", "miter": "mitre"}
"""GEOS's names of caps and joins, where they differ."""

DASH_POINTS = 8
"""Points that a dash counts for, before it is made: as many take as long."""


@dataclass(frozen=True)
class Stroke:
    """Style of a line, in the units of the line."""

    width: float
    cap: str = "butt"
    join: str = "miter"
    miter_limit: float = 4.0
    dashes: tuple[float, ...] = ()
    offset: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "dashes", self.dashes * (1 + len(self.dashes) % 2))

    def scaled(self, factor: float) -> Stroke:
        """The same stroke in other units."""
        return replace(self.along(factor), width=factor * self.width)

    def along(self, factor: float) -> Stroke:
        """The same stroke with other lengths along its line."""
        return replace(self, dashes=tuple(factor * dash for dash in self.dashes), offset=factor * self.offset)


@dataclass(frozen=True, eq=False)
class Polyline:
    """A line in place of curves, which touches them and has their end tangents."""

    points: FloatArray
    """(k, 2); a closed one ends where it begins."""
    least: FloatArray
    """(k,) lower bounds of the length of the curves up to each point."""
    closed: bool
    error: float
    """Bound of its distance from the curves."""
    turn: float
    """Largest angle between its edges on one curve but at cusps, in radians."""
    cusps: FloatArray
    """(k, 3) x, y and radius of circles around its cusps."""


def stroke_of(style: Mapping[str, str], viewport: Viewport) -> Stroke | None:
    """The stroke of an element with these properties, None if it has none."""
    if style.get("stroke", "none") == "none":
        return None
    width = parse_length(style.get("stroke-width", "1"), "r", "stroke-width", viewport, 1.0)
    if not width > 0.0:
        return None
    text = style.get("stroke-dasharray", "none")
    lengths = [viewport.length(part, "r") for part in text.replace(",", " ").split()]
    dashes = () if None in lengths else tuple(length or 0.0 for length in lengths)
    limit = numbers(style.get("stroke-miterlimit", "4"))
    return Stroke(
        width,
        style.get("stroke-linecap", "butt"),
        style.get("stroke-linejoin", "miter"),
        limit[0] if limit else 4.0,
        dashes,
        parse_length(style.get("stroke-dashoffset", "0"), "r", "stroke-dashoffset", viewport),
    )


def stroked(lines: Sequence[Polyline], stroke: Stroke, tolerance: float, quota: Quota, *, inside: bool) -> list[Any]:
    """Geometries that together cover the stroke of the curves that lines stand for; inside: that lie in it instead.

    tolerance: distance of chords from round caps and joins. Raises NestedCagesError for too many dashes, and for lines
    that cross themselves too often.
    """
    radius = 0.5 * stroke.width
    half = math.acos(1.0 / (1.0 + max(tolerance / radius, 1e-9)))
    segments = min(max(math.ceil(math.pi / 4.0 / half), 2), MAX_ARC_SEGMENTS)
    found = []
    for line in _dashed(lines, stroke, quota.limits, inside=inside):
        points = _different(line)
        closed = line.closed and len(points) > 2
        around = np.concatenate((points, points[:2])) if closed else points
        steps = np.diff(around, axis=0)
        turns = angle_between(steps[:-1], steps[1:])
        reach = _reach(steps, turns, line, stroke, segments, inside=inside)
        if not reach > 0.0:
            continue
        if len(points) == 1:
            curve = shapely.Point(points[0])
        else:
            curve = shapely.LinearRing(points) if closed else shapely.LineString(points)
        if not curve.is_simple:
            spend([curve], quota, own=True)
        join = NAMES.get(stroke.join, stroke.join)
        tips = _tips(around, steps, reach, stroke.miter_limit, line) if join == "mitre" and len(turns) else None
        join = "bevel" if tips is not None else join
        style = {"cap_style": NAMES.get(stroke.cap, stroke.cap), "join_style": join}
        outline = shapely.buffer(curve, reach, quad_segs=segments, mitre_limit=1.01 * stroke.miter_limit, **style)
        found.append(outline)
        for corners in _folds(around, steps, turns, reach, line.turn) if len(turns) and not inside else []:
            shapely.prepare(outline)
            middles = corners.mean(axis=1, keepdims=True)
            lost = ~shapely.covers(outline, _hulls(middles + ROUNDING * (corners - middles)))
            found += list(_hulls(corners[lost]))
        if tips is not None:
            found += list(shapely.polygons(tips))
        if len(line.cusps) and not inside:
            shapely.prepare(curve)
            cusps = shapely.points(line.cusps[:, :2])
            near = shapely.dwithin(curve, cusps, line.cusps[:, 2] + line.error)
            radii = (radius + line.cusps[near, 2]) / math.cos(math.pi / (4.0 * segments))
            found += list(shapely.buffer(cusps[near], radii, quad_segs=segments))
    return [geometry for geometry in found if not geometry.is_empty]


def _folds(around: FloatArray, steps: FloatArray, turns: FloatArray, reach: float, max_turn: float) -> list[FloatArray]:
    """Corners (K, k, 2) of convex parts of the stroke of a line that has bends tighter than the width.

    around: (k, 2) points of the line, the first two again if it is closed; steps: from each to the next; turns: between
    these, farther than `max_turn` at corners.

    GEOS leaves out what lies on the inner side of such a bend next to a cap, and the line does not show how far the
    ends of its curve's normals swing back next to an end or a corner. Parts are what edges sweep, and what they do as
    they turn, there all along both edges.
    """
    lengths = norm(steps)
    tight = TIGHT * reach * turns
    folds = _tight(lengths, turns, reach)
    if not folds.any():
        return []
    along = steps / lengths[:, None]
    aside = reach * rotated_left(along)
    ends = np.stack((around[:-1], around[1:]), axis=1)[:, :, None]
    swept = ends + np.stack((aside, -aside), axis=1)[:, None]
    at = around[1:-1][folds]
    closed = len(around) > 3 and bool((around[:2] == around[-2:]).all())
    beside = np.concatenate((turns[-1:], turns, turns[:1])) if closed else np.pad(turns, 1, constant_values=math.inf)
    near = np.where((turns <= max_turn) & (np.maximum(beside[:-2], beside[2:]) > max_turn), tight, 0.0)
    back, ahead = (np.minimum(size, near)[folds, None] for size in (lengths[:-1], lengths[1:]))
    bend = np.stack((at - back * along[:-1][folds], at, at + ahead * along[1:][folds]), axis=1)[:, :, None]
    turned = np.stack([sign * each[folds] for each in (aside[:-1], aside[1:]) for sign in (-1.0, 1.0)], axis=1)
    left = cross(along[:-1], along[1:])[folds, None] > 0.0
    turned[(near[folds, None] == 0.0) & (left != (True, False, True, False))] = 0.0  # elsewhere only the outer side
    return [swept.reshape(-1, 4, 2), (bend + turned[:, None]).reshape(-1, 12, 2)]


def _tight(lengths: FloatArray, turns: FloatArray, reach: float) -> BoolArray:
    """Whether bends between edges of lengths (n,) are tighter than the width, (n - 1,)."""
    return np.asarray(np.minimum(lengths[:-1], lengths[1:]) < TIGHT * reach * turns)


def _hulls(points: FloatArray) -> Any:
    """Convex hulls of points (K, k, 2)."""
    count, size = points.shape[:2]
    return shapely.convex_hull(shapely.multipoints(points.reshape(-1, 2), indices=np.repeat(np.arange(count), size)))


def _reach(
    steps: FloatArray, turns: FloatArray, line: Polyline, stroke: Stroke, segments: int, *, inside: bool
) -> float:
    """The distance of GEOS's outline from a line that puts it beyond the stroke; inside: within it."""
    parallel = float(turns.max(initial=0.0, where=turns < PARALLEL))
    chord = line.turn
    if stroke.join == "round":
        quarter = math.pi / (2.0 * segments)
        chord = max(chord, float((turns / np.maximum(np.ceil(turns / quarter - 0.5 - TIE), 1.0)).max(initial=0.0)))
    if stroke.cap == "round" and not line.closed:
        chord = max(chord, math.pi / (2.0 * segments))
    lost = min(math.cos(parallel), math.cos(min(chord, math.pi / 3.0) / 2.0))
    radius = 0.5 * stroke.width
    if inside:
        return (radius - line.error) * lost * (1.0 - SHALLOW)
    short = chord > 0.0 or norm(steps).min(initial=math.inf) < SNAP * radius
    return (radius + line.error) / lost * (1.0 + SNAP * short)


def _different(line: Polyline) -> FloatArray:
    """Points without those that repeat the one before, at least one."""
    repeated = (np.diff(line.points, axis=0) == 0.0).all(axis=1)
    points = line.points[np.append(True, ~repeated)]
    repeats = line.closed and len(points) > 1 and bool((points[0] == points[-1]).all())
    return np.asarray(points[:-1] if repeats else points)


def _tips(around: FloatArray, steps: FloatArray, radius: float, limit: float, line: Polyline) -> FloatArray | None:
    """(K, 4, 2) quadrilaterals that mitres add to bevels; None if GEOS can, since all corners have mitres.

    SVG bevels corners beyond the limit, GEOS cuts their mitres off, and takes a tight bend for one corner; cusps are no
    corners.
    """
    lengths = norm(steps)
    corner, along = around[1:-1], steps / lengths[:, None]
    before, after = along[:-1], along[1:]
    cosine = (before * after).sum(axis=1)
    turn = cross(before, after)
    squared = np.where(cosine > -1.0, 2.0 / np.maximum(1.0 + cosine, 1e-300), np.inf)  # of mitre length by width
    within = squared <= limit * limit * (1.0 + 1e-9)
    if len(line.cusps):
        tree = shapely.STRtree(shapely.points(line.cusps[:, :2]))
        near, _ = tree.query(shapely.points(corner), "dwithin", line.cusps[:, 2].max() + line.error)
        within[near] = False
    if within.all() and not _tight(lengths, angle_between(before, after), radius).any():
        return None
    bent = within & (turn != 0.0)
    side = -np.sign(turn[bent])[:, None] * radius
    first, second = (side * rotated_left(step[bent]) for step in (before, after))
    tip = (first + second) / (1.0 + cosine[bent])[:, None]
    centre = corner[bent]
    return np.asarray(np.stack((centre, centre + first, centre + tip, centre + second), axis=1))


def _dashed(lines: Sequence[Polyline], stroke: Stroke, limits: Limits, *, inside: bool) -> list[Polyline]:
    """The dashes of lines, which cover those of the curves or lie inside; the whole line if dashes leave no gap."""
    period = sum(stroke.dashes)
    if not period > 0.0 or not math.isfinite(period):
        return list(lines)
    found: list[Polyline] = []
    for line in lines:
        points, least = line.points, line.least
        along = np.concatenate(([0.0], np.cumsum(norm(np.diff(points, axis=0)))))
        number = len(stroke.dashes) // 2 * math.ceil(min(along[-1] / period, 1e18))
        limits.check("points", DASH_POINTS * (len(found) + number))
        for low, high in _dashes(stroke, period, along[-1]):
            first, last = (float(np.interp(at, least, along)) for at in (low, high))
            first, last = (first + line.error, high - line.error) if inside else (low - line.error, last + line.error)
            if first <= last:
                piece = _substring(points, along, max(first, 0.0), min(last, along[-1]))
                found.append(replace(line, points=piece, closed=False))
    return found


def _dashes(stroke: Stroke, period: float, length: float) -> Iterator[tuple[float, float]]:
    """Start and end of each dash along a line."""
    at = -(stroke.offset % period)
    while at < length:
        for k, size in enumerate(stroke.dashes):
            low, high = max(at, 0.0), min(at + size, length)
            if k % 2 == 0 and low <= high and low < length:
                yield low, high
            at += size


def _substring(points: FloatArray, along: FloatArray, low: float, high: float) -> FloatArray:
    """The part of a line between two lengths."""
    first, last = int(along.searchsorted(low, "right")), int(along.searchsorted(high))
    around = slice(max(min(first - 1, last), 0), last + 1)
    ends = [[np.interp(at, along[around], points[around, axis]) for axis in (0, 1)] for at in (low, high)]
    return np.concatenate((ends[:1], points[first:last], ends[1:]))
