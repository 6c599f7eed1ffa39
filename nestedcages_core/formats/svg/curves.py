"""Curves of outlines: lines, conics and cubics, and chains of edges along them that stay on one side."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.vectors import cross, dot, norm, rotated_right

LINE, CONIC, CUBIC = 1, 2, 3
"""Degrees. A conic is a parabola or an arc of an ellipse."""

MAX_PIECES = 4096
"""Maximum number of pieces of a convex curve."""

MAX_TURN = math.pi / 4.0
"""Largest angle by which a piece of a curve turns."""

HALVINGS, CUSP = 16, 1.5
"""Times that pieces of cubics which turn farther are halved, and how much farther."""

NEAR_END = 1e-6
"""Parameter of inflections next to an end, which change nothing that can be told from rounding."""

STRAIGHT, SHORT = 1e-7, 0.25
"""Sine of the turn, and handles over the chord, below which a cubic's tangents do not tell where they meet."""

MEETING = 0.65
"""Distance of a piece from its tangents over the height of the point where they meet: a half for parabolas."""

PUSH = 2.0**-43
"""Distance over the largest coordinate by which chains keep away from curves: well above rounding."""

HANDLE = 8.0
"""Length over the push up to which a handle has none."""

JOINT, SMOOTH = 0.125, 0.01
"""Depth over the tolerance of points between two tangents that are left out, and their turn in radians on lines."""

TINY = float(np.finfo(float).tiny)
"""Smallest tolerance and length: scaled ones may underflow."""


@dataclass(frozen=True, eq=False)
class Subpath:
    """Consecutive lines and curves; each begins where the one before ends."""

    points: FloatArray
    """(k, 2) all control points; ends that curves share are there once."""
    degrees: IntArray
    """(n,) of the curves."""
    angles: FloatArray
    """(n,) half the angle in radians of arcs of ellipses, at most a quarter of pi; 0 for other curves."""
    closed: bool = False

    @property
    def is_curved(self) -> bool:
        return bool((self.degrees != LINE).any())

    @property
    def ends(self) -> FloatArray:
        """(n + 1, 2) the ends of its curves."""
        return np.asarray(self.points[np.append(0, np.cumsum(self.degrees))])


@dataclass(frozen=True, eq=False)
class Pieces:
    """Subpaths in P pieces, each of which lies in the hull of its ends and its two corners.

    Corners are on the outer side of the bend, the end tangents meet there; a line has its end for both.
    """

    starts: FloatArray
    """(P, 2)"""
    stops: FloatArray
    """(P, 2); the starts of the next ones, but for the last piece of a subpath."""
    corners: FloatArray
    """(P, 2, 2); the same one twice where the tangents meet in it."""
    turns: IntArray
    """(P,) 1 where a piece turns to the left, -1 to the right, 0 where it is straight."""
    rounded: BoolArray
    """(P, 2) whether the start and the stop of a piece are computed, not given."""
    first: IntArray
    """(L + 1,) the first piece of each subpath, and P."""
    tolerance: FloatArray
    """(P,)"""
    push: FloatArray
    """(P,) distance that computed points are moved away from curves."""

    def chains(self, sides: IntArray) -> list[FloatArray]:
        """For each subpath (k, 2) points of a chain to the right of its curves, side 1, or to their left, -1.

        On its side of a bend a chain follows the corners, on the other one the ends. Side 0: always the corners.
        """
        points, kept = self._candidates(sides)
        return self._split(points, kept)

    def lines(self) -> list[tuple[FloatArray, FloatArray]]:
        """For each subpath a chain of side 0, and (k,) lower bounds of the length of its curves up to each point."""
        points, kept = self._candidates(np.zeros(len(self.first) - 1, dtype=np.int64))
        chord, around = self.lengths()
        share = chord / np.maximum(around, TINY)
        first, last = norm(self.corners[:, 0] - self.starts), norm(self.stops - self.corners[:, 1])
        before = np.cumsum(chord) - chord
        before -= np.repeat(before[self.first[:-1]], np.diff(self.first))
        ahead = np.stack((np.zeros(len(chord)), share * first, chord - share * last, chord), axis=1)
        least = self._split(before[:, None] + ahead, kept)
        return list(zip(self._split(points, kept), least, strict=True))

    def _split(self, values: FloatArray, kept: BoolArray) -> list[FloatArray]:
        """Those values (P, 4, …) of each subpath that are kept."""
        numbers = np.add.reduceat(kept.sum(axis=1), self.first[:-1])
        return np.split(values[kept], np.cumsum(numbers)[:-1])

    def _candidates(self, sides: IntArray) -> tuple[FloatArray, BoolArray]:
        """(P, 4, 2) start, corners and stop of pieces, beside the curves, and which of them chains have."""
        side = np.repeat(sides, np.diff(self.first))
        outer = np.where(side == 0, self.turns != 0, self.turns == side)
        shift = (side * self.push)[:, None, None] * self._normals
        points = np.stack(
            (self.starts + shift[:, 0], *np.moveaxis(self.corners, 1, 0), self.stops + shift[:, 1]), axis=1
        )
        kept = np.ones((len(side), 4), dtype=bool)
        kept[:, 1] = outer
        kept[:, 2] = outer & (self.corners[:, 0] != self.corners[:, 1]).any(axis=1)
        kept[:, 3] = False
        kept[self.first[1:] - 1, 3] = True
        follows = np.append(False, outer[1:] & outer[:-1])
        follows[self.first[:-1]] = False
        joint = np.flatnonzero(follows)  # between two corners, and all but on the line through them
        before, after = self.corners[joint - 1, 1], self.corners[joint, 0]
        depth = cross(after - before, self.starts[joint] - before) / np.maximum(norm(after - before), TINY)
        depth *= np.where(side[joint] < 0, -1, 1)
        most = JOINT * self.tolerance[joint]
        least = np.where(side[joint] == 0, -most, 0.25 * self.push[joint])
        turn = angle_between(self.starts[joint] - before, after - self.starts[joint])
        goes_on = turn < np.where(side[joint] == 0, SMOOTH, math.pi / 2.0)
        kept[joint, 0] = ~(goes_on & (depth >= least) & (depth <= most))
        return points, kept

    def slivers(self) -> FloatArray:
        """(C, 6, 2) hulls of the ends and corners of curved pieces, which contain the pieces with their ends."""
        shift = (self.turns * self.push)[:, None, None] * self._normals
        starts, stops = (
            end[:, None] + shift[:, k, None] * ((-1.0,), (0.25,)) for k, end in ((0, self.starts), (1, self.stops))
        )
        return np.asarray(np.concatenate((starts, self.corners, stops[:, ::-1]), axis=1)[self.turns != 0])

    def lengths(self) -> tuple[FloatArray, FloatArray]:
        """(P,) lengths of pieces, along their chords and along their corners: lower and upper bounds."""
        middle = norm(self.corners[:, 1] - self.corners[:, 0])
        ends = norm(self.corners[:, 0] - self.starts) + norm(self.stops - self.corners[:, 1])
        return norm(self.stops - self.starts), ends + middle

    def errors(self, first: IntArray, max_turn: FloatArray) -> tuple[FloatArray, FloatArray, list[FloatArray]]:
        """Bounds of the distance of side 0 from the curves, and of the angle between its edges on one curve; and cusps.

        first: (S,) the first piece of each group of subpaths; max_turn: (S,) radians that pieces may turn. The bounds
        are (S,) too. Cusps are pieces that turn much farther, which the second bound leaves out: (k, 3) x, y and radius
        of circles around them for each subpath.
        """
        starts, stops, corners = self.starts, self.stops, self.corners
        chord = stops - starts
        height = np.abs(cross(corners - starts[:, None], chord[:, None])).max(axis=1) / np.maximum(norm(chord), TINY)
        extent = norm(corners - starts[:, None]).max(axis=1)
        height = np.minimum(height, extent)
        height *= np.where((corners[:, 0] == corners[:, 1]).all(axis=1), MEETING, 1.0)
        turn = angle_between(corners[:, 0] - starts, stops - corners[:, 1])
        group = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(starts))))
        turned = np.flatnonzero((self.turns != 0) & (turn > CUSP * max_turn[group]))
        turn[turned] = 0.0
        bounds = np.where(self.turns != 0, (height + JOINT * self.tolerance, turn + SMOOTH), 0.0)
        height, turn = np.maximum.reduceat(bounds, first, axis=1)
        circles = np.column_stack((starts, np.maximum(extent, norm(chord))))[turned]
        return height, turn, np.split(circles, np.searchsorted(turned, self.first[1:-1]))

    @cached_property
    def _normals(self) -> FloatArray:
        """(P, 2, 2) unit vectors to the right at the ends of pieces; zero where these are given."""
        steps = self.stops - self.starts
        steps = steps / np.maximum(norm(steps), TINY)[:, None]
        before, after = np.roll(steps, 1, axis=0), np.roll(steps, -1, axis=0)
        first, last = self.first[:-1], self.first[1:] - 1
        before[first], after[last] = steps[last], steps[first]  # used where a subpath is closed
        along = np.stack((before + steps, steps + after), axis=1)
        along *= (self.rounded / np.maximum(norm(along), TINY))[..., None]
        return rotated_right(along)


def pieces_of(
    paths: Sequence[Subpath],
    points: Sequence[FloatArray],
    tolerance: ArrayLike,
    max_turn: ArrayLike = MAX_TURN,
    spend: Callable[[int], None] = lambda number: None,
) -> Pieces:
    """The pieces of subpaths whose control points were moved to `points`.

    tolerance: of the distance between chords, curve and tangents; max_turn: radians that a piece may turn, both for
    each subpath or for all; spend: told how many pieces there will be before they are made.
    """
    degrees, angles = (np.concatenate([getattr(path, key) for path in paths]) for key in ("degrees", "angles"))
    counts = np.array([len(path.degrees) for path in paths])
    fineness, turning = (
        np.repeat(np.broadcast_to(np.asarray(each, np.float64), len(paths)), counts)
        for each in (np.maximum(tolerance, TINY), max_turn)
    )
    everything = np.concatenate(points)
    last = np.cumsum(degrees) + np.repeat(np.arange(len(paths)), counts)
    owner, place, corner, stop = [], [], [], []
    for degree, make in ((LINE, _lines), (CONIC, _conics), (CUBIC, _cubics)):
        which = np.flatnonzero(degrees == degree)
        if len(which):
            control = everything[(last[which] - degree)[:, None] + np.arange(degree + 1)]
            index, at, corners, stops = make(control, angles[which], fineness[which], turning[which], spend)
            owner.append(which[index])
            place.append(at)
            corner.append(corners)
            stop.append(stops)
    curve, at, corners, stops = (np.concatenate(each) for each in (owner, place, corner, stop))
    order = np.lexsort((at, curve))
    curve, corners, stops = curve[order], corners[order], stops[order]
    is_last = np.append(curve[1:] != curve[:-1], True)
    stops[is_last] = everything[last]
    starts = np.roll(stops, 1, axis=0)
    starts[np.append(True, is_last[:-1])] = everything[last - degrees]
    chord = stops - starts
    reach = HANDLE * PUSH * np.maximum(np.abs(starts), np.abs(stops)).max(axis=1)
    short = np.stack((norm(corners[:, 0] - starts), norm(corners[:, 1] - stops)), axis=1) <= reach[:, None]
    alone = short & ~short[:, ::-1]  # the tangents meet in the other one
    corners = np.where(alone[..., None], corners[:, ::-1], corners)
    middle = corners.sum(axis=1) / 2.0 - starts
    turns = np.where(degrees[curve] == LINE, 0, np.sign(cross(middle, chord))).astype(np.int64)
    first = np.append(0, np.flatnonzero(is_last)[np.cumsum(counts) - 1] + 1)
    rounded = _rounded(is_last, angles, curve, first, starts, stops)
    push = PUSH * np.maximum.reduceat(np.abs(stops).max(axis=1), first[:-1]).repeat(np.diff(first))
    corners += ((turns * push / np.maximum(norm(chord), TINY))[:, None] * rotated_right(chord))[:, None]
    return Pieces(starts, stops, corners, turns, rounded, first, fineness[curve], push)


def _rounded(
    is_last: BoolArray, angles: FloatArray, curve: IntArray, first: IntArray, starts: FloatArray, stops: FloatArray
) -> BoolArray:
    """(P, 2) whether ends of pieces are computed: those within curves, and those where arcs of ellipses meet."""
    is_arc = angles[curve] > 0.0
    following = np.roll(np.arange(len(curve)), -1)
    following[first[1:] - 1] = first[:-1]
    meets = (stops == starts[following]).all(axis=1)
    stop = ~is_last | (is_arc & is_arc[following] & meets)
    start = np.empty_like(stop)
    start[following] = stop
    return np.stack((start, stop), axis=1)


Made = tuple[IntArray, FloatArray, FloatArray, FloatArray]
"""For each piece its curve, its place on it, its corners (2, 2) and its end."""


def _lines(
    control: FloatArray, angles: FloatArray, tolerance: FloatArray, max_turn: FloatArray, spend: Callable[[int], None]
) -> Made:
    spend(len(control))
    ends = control[:, 1]
    return np.arange(len(control)), np.zeros(len(control)), np.stack((ends, ends), axis=1), ends


def _conics(
    control: FloatArray, angles: FloatArray, tolerance: FloatArray, max_turn: FloatArray, spend: Callable[[int], None]
) -> Made:
    """Pieces of equal angle, of parabolas of equal parameter, whose tangents meet in blossoms."""
    first, middle, last = np.moveaxis(control, 1, 0)
    is_arc = angles > 0.0
    half = np.where(is_arc, angles, 1.0)
    sine, cosine = np.sin(half), np.cos(half)
    across = (last - first) / (2.0 * sine)[:, None]  # the two axes of the ellipse about the middle of the arc
    along = (middle - (first + last) / 2.0) * (cosine / sine**2)[:, None]
    a, b, c = dot(along, along), dot(across, across), dot(along, across)
    radius = np.sqrt((a + b) / 2.0 + np.hypot((a - b) / 2.0, c))
    arcs = half / np.arccos(np.minimum(1.0 / (1.0 + tolerance / np.maximum(radius, TINY)), 1.0 - 1e-15))
    bend = norm(first - 2.0 * middle + last)
    turn = angle_between(middle - first, last - middle)
    wanted = np.where(is_arc, arcs, np.sqrt(bend / (4.0 * tolerance)))
    index, k, count = _divided(np.maximum(wanted, turn / max_turn), spend)
    half, is_arc = half[index], is_arc[index]

    def parameter(number: IntArray) -> FloatArray:
        share = number / count
        bent = 0.5 + 0.5 * np.tan((share - 0.5) * half) / np.tan(half / 2.0)
        return np.where(is_arc, bent, share)

    weight = np.where(is_arc, np.cos(half), 1.0)

    def blossom(s: FloatArray, t: FloatArray) -> FloatArray:
        shares = np.stack(((1.0 - s) * (1.0 - t), (s * (1.0 - t) + t * (1.0 - s)) * weight, s * t), axis=1)
        return np.asarray((shares[:, :, None] * control[index]).sum(axis=1) / shares.sum(axis=1)[:, None])

    s, t = parameter(k), parameter(k + 1)
    corners, ends = blossom(s, t), blossom(t, t)
    return index, t, np.stack((corners, corners), axis=1), ends


def _cubics(
    control: FloatArray, angles: FloatArray, tolerance: FloatArray, max_turn: FloatArray, spend: Callable[[int], None]
) -> Made:
    """Pieces of equal parameter between inflections, halved where they turn too far."""
    index, low, high = _convex(control)
    tolerance, turning = tolerance[index], max_turn[index]
    steps = np.diff(_between(control[index], low, high), axis=1)
    bend = norm(np.diff(steps, axis=1)).max(axis=1)
    turn = angle_between(steps[:, 0], steps[:, 1]) + angle_between(steps[:, 1], steps[:, 2])
    part, k, count = _divided(np.maximum(np.sqrt(0.75 * bend / tolerance), turn / turning), spend)
    index, step = index[part], ((high - low)[part]) / count
    s = low[part] + k * step
    t = np.where(k + 1 == count, high[part], low[part] + (k + 1) * step)
    curve = _between(control[index], s, t)
    found = []
    for _ in range(HALVINGS):
        far = _turn(curve, HANDLE * PUSH * np.abs(curve).max(axis=(1, 2), initial=0.0)) > CUSP * max_turn[index]
        found.append((index[~far], t[~far], curve[~far]))
        if not far.any():
            break
        index, s, t = index[far], s[far], t[far]
        spend(len(index))
        middle = (s + t) / 2.0
        index, s, t = np.tile(index, 2), np.append(s, middle), np.append(middle, t)
        curve = _between(control[index], s, t)
    else:
        found.append((index, t, curve))
    index, t, curve = (np.concatenate(each) for each in zip(*found, strict=True))
    steps = np.diff(curve, axis=1)
    ahead, behind, chord = steps[:, 0], steps[:, 2], curve[:, 3] - curve[:, 0]
    sizes = norm(np.stack((ahead, behind, chord)))
    bent = cross(ahead, behind)
    meets = (np.abs(bent) > STRAIGHT * sizes[0] * sizes[1]) & (sizes[:2].min(axis=0) > SHORT * sizes[2])
    meets &= dot(ahead, behind) > 0.0
    shares = np.where(meets, cross(chord, behind) / np.where(meets, bent, 1.0), 0.0)
    apex = curve[:, 0] + shares[:, None] * ahead
    corners = np.where(meets[:, None, None], apex[:, None], curve[:, 1:3])
    return index, t, corners, curve[:, 3]


def _convex(control: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """The parts of cubics between their inflections: the cubic of each, and its first and last parameter."""
    d = control[:, 1] - control[:, 0]
    e = control[:, 2] - 2.0 * control[:, 1] + control[:, 0]
    f = control[:, 3] - 3.0 * control[:, 2] + 3.0 * control[:, 1] - control[:, 0]
    a, b, c = cross(e, f), cross(d, f), cross(d, e)
    root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
    q = -0.5 * (b + np.where(b < 0.0, -root, root))
    real = b * b >= 4.0 * a * c
    roots = np.stack((np.where(real, q / a, 0.0), np.where(real, c / q, 0.0)), axis=1)
    roots = np.sort(np.where((roots > NEAR_END) & (roots < 1.0 - NEAR_END), roots, 0.0), axis=1)
    limits = np.concatenate((np.zeros((len(d), 1)), roots, np.ones((len(d), 1))), axis=1)
    index, part = np.nonzero(np.diff(limits, axis=1) > 0.0)
    return index, limits[index, part], limits[index, part + 1]


def _between(control: FloatArray, s: FloatArray, t: FloatArray) -> FloatArray:
    """(n, 4, 2) control points of the parts of cubics between two parameters, by blossoms."""
    first, second, third, last = np.moveaxis(control, 1, 0)
    linear, square = second - first, third - 2.0 * second + first
    cube = last - 3.0 * (third - second) - first
    u, v, w = np.stack((s, s, s, t)), np.stack((s, s, t, t)), np.stack((s, t, t, t))
    sums, pairs, products = u + v + w, u * v + v * w + w * u, u * v * w
    found = first + sums[..., None] * linear + pairs[..., None] * square + products[..., None] * cube
    return np.asarray(np.moveaxis(found, 0, 1))


def _turn(control: FloatArray, least: FloatArray) -> FloatArray:
    """(n,) angles between the tangents at the ends of cubics (n, 4, 2); handles no longer than (n,) have no length."""
    steps = np.diff(control, axis=1)
    has = norm(steps) > least[:, None]
    ahead, behind = (np.where(has[:, k, None], steps[:, k], steps[:, 1]) for k in (0, 2))
    return angle_between(ahead, behind)


def angle_between(a: FloatArray, b: FloatArray) -> FloatArray:
    """Angles from 0 to pi; 0 where one has no length."""
    return np.asarray(np.abs(np.arctan2(cross(a, b), dot(a, b))))


def _divided(wanted: FloatArray, spend: Callable[[int], None]) -> tuple[IntArray, IntArray, IntArray]:
    """The curve, the number and the count of its pieces, for each piece of curves that want so many."""
    counts = np.ceil(np.clip(np.nan_to_num(wanted, nan=1.0) - 1e-9, 1, MAX_PIECES)).astype(np.int64)
    spend(int(counts.sum()))
    index = np.repeat(np.arange(len(counts)), counts)
    return index, np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts), counts[index]


def length_of(subpaths: Sequence[Subpath], fineness: float = 1e-5) -> float:
    """The length of all subpaths together; fineness: tolerance over their size."""
    points = [path.points for path in subpaths]
    low, high = pieces_of(subpaths, points, fineness * _size(points)).lengths()
    return float(2.0 * low.sum() + high.sum()) / 3.0 if (low != high).any() else float(low.sum())


def box_around(
    subpaths: Sequence[Subpath], points: Sequence[FloatArray], fineness: float = 1e-7
) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right corner, (2,), (2,), of subpaths whose control points were moved to `points`."""
    ends = pieces_of(subpaths, points, fineness * _size(points)).stops
    starts = np.array([each[0] for each in points])
    return np.minimum(ends.min(axis=0), starts.min(axis=0)), np.maximum(ends.max(axis=0), starts.max(axis=0))


def _size(points: Sequence[FloatArray]) -> float:
    return float(np.ptp(np.concatenate(points), axis=0).max())
