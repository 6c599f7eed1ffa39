"""The one search for what is near: segments with bounding boxes, sorted along x or in a pyramid.

Few boxes are sorted along x. More, or those that are crowded along x, are opened from the top of a pyramid down. Its
level 0 has a box around each segment, each further level one around `FANOUT` consecutive boxes of the level below, and
all pairs of a level are tested in one call. Where boxes of long slanted segments overlap in crowds, oriented boxes
separate them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray
from .distance import SMALLEST_LENGTH
from .oriented_boxes import OrientedBoxes

FANOUT = 4
"""Boxes that share a parent: 4 was the fastest of 2, 4 and 8 for loops of 1,000 to 100,000 segments."""

SORTED_BOXES, SORTED_PAIRS = 10_000, 64
"""Number of boxes, and of pairs per box that overlap along x, up to which sorting is faster (measured)."""

PYRAMID_COST, PYRAMID_START = 80, 20_000
"""Cost of finding the closest by the pyramid per point or segment, and of starting it, in pairs that could be measured
in that time (measured)."""

FEW_PAIRS = 2**13
"""Pairs of points and segments, or boxes, that are all measured, which takes less time than a search (measured)."""

CACHED_PAIRS = 2**14
"""Pairs measured together: their arrays stay in the processor's cache (measured)."""

BLOCK_PAIRS = 2**16
"""Pairs tested together, which bounds the memory to about 100 MB."""

CROWDED = 8
"""Overlaps per box above which oriented boxes are tested too; smooth loops have about 3."""

FEW_CHAINS = 8
"""Number of chains up to which sorting them costs more than it saves."""

CURVE_CELLS = 2**16
"""Cells along either axis of the space-filling curve that sorts chains of segments."""


class ClosestEdge(NamedTuple):
    """The closest segment to each of P points."""

    distance: FloatArray
    """(P,) length ≥ 0."""
    edge: IntArray
    """(P,) index of the segment."""
    parameter: FloatArray
    """(P,) position of the closest point on the segment, in [0, 1]."""

    def between(self, starts: FloatArray, ends: FloatArray) -> FloatArray:
        """(P, ...) values at the closest points, from those at starts and ends (E, ...) of edges, such as places."""
        start = starts.take(self.edge, axis=0)
        share = self.parameter.reshape(-1, *[1] * (starts.ndim - 1))
        return np.asarray(start + share * (ends.take(self.edge, axis=0) - start))


class BoxTree:
    """Segments (E, 2) -> (E, 2) and the pyramid of their boxes, which is built when it is needed.

    Segments of which each begins near the end of the one before form a chain. In the pyramid chains stay whole and are
    sorted along a space-filling curve, so any order of the input is accepted. Where that makes smaller boxes, long
    segments are sorted one by one.

    Parameters
    ----------
    starts, ends
        The segments, (E, 2) each; points are segments that end where they start.
    """

    def __init__(self, starts: FloatArray, ends: FloatArray) -> None:
        self.starts = np.asarray(starts, dtype=np.float64).reshape(-1, 2)
        self.ends = np.asarray(ends, dtype=np.float64).reshape(-1, 2)
        self._levels: list[FloatArray] = []
        self._sizes: list[float] = []
        """Mean extents of the boxes of each level."""
        self._oriented: list[OrientedBoxes] = []

    def __len__(self) -> int:
        return len(self.starts)

    def segments(self, chosen: IntArray) -> tuple[FloatArray, FloatArray]:
        """Starts and ends, (K, 2) each, of some segments (K,)."""
        return self.starts.take(chosen, axis=0), self.ends.take(chosen, axis=0)

    def pairs(self, other: BoxTree | None = None, radius: float = 0.0) -> tuple[IntArray, IntArray]:
        """All pairs of `blocks`, (K,), (K,)."""
        listed = list(self.blocks(other, radius))
        none = np.zeros(0, dtype=np.int64)
        return np.concatenate([none, *(i for i, _ in listed)]), np.concatenate([none, *(j for _, j in listed)])

    def blocks(self, other: BoxTree | None = None, radius: float = 0.0) -> Iterator[tuple[IntArray, IntArray]]:
        """Pairs (i, j) of a segment of this tree and one of the other, or i < j of this one, in blocks of bounded size.

        All pairs at most ``radius`` apart are among them. The boxes of the others are as close along both axes; where
        they are crowded, some of these are left out.
        """
        second = self if other is None else other
        few = max(len(self), len(second)) <= SORTED_BOXES
        found = _overlapping_along_x(self, second, radius) if few else None
        if found is None:
            yield from self._opened(second, radius)
            return
        i, j = found
        yield (np.minimum(i, j), np.maximum(i, j)) if other is None else (i, j)

    def _opened(self, other: BoxTree, radius: float) -> Iterator[tuple[IntArray, IntArray]]:
        """The pairs of `blocks` by the pyramid."""
        a, b, tally, within = self._top, other._top, Counter[tuple[int, int]](), self is other
        waiting = [(a, b, *(each.ravel() for each in np.indices((self._count(a), other._count(b)))))]
        while waiting:
            a, b, i, j = waiting.pop()
            if len(i) > BLOCK_PAIRS:
                middle = len(i) // 2
                waiting += [(a, b, i[middle:], j[middle:]), (a, b, i[:middle], j[:middle])]
                continue
            if within:
                once = (i < j if a == 0 else i <= j).nonzero()[0]
                i, j = i.take(once), j.take(once)
            i, j = _overlapping(self._boxes(a), i, other._boxes(b), j, radius)
            tally[a, b] += len(i)
            if tally[a, b] > CROWDED * max(self._count(a), other._count(b)):
                close = (self._oriented_boxes(a).gap(i, other._oriented_boxes(b), j) <= radius).nonzero()[0]
                i, j = i.take(close), j.take(close)
            if a == 0 and b == 0:
                i, j = self._order.take(i), other._order.take(j)
                yield (np.minimum(i, j), np.maximum(i, j)) if within else (i, j)
            elif within:
                waiting.append((a - 1, b - 1, *_children_of_both(i, j)))
            elif b == 0 or (a > 0 and self._sizes[a] >= other._sizes[b]):
                waiting.append((a - 1, b, _children(i), j.repeat(FANOUT)))
            else:
                waiting.append((a, b - 1, i.repeat(FANOUT), _children(j)))

    def nearest(self, points: FloatArray) -> FloatArray:
        """(P, 2) the closest points on segments to points (P, 2)."""
        return self.closest(points).between(self.starts, self.ends)

    def near(self, points: FloatArray, radius: float) -> tuple[IntArray, IntArray]:
        """Pairs (point, segment) of all that are closer than ``radius``, segment by segment, (K,), (K,)."""
        columns, count = points.T.copy(), len(points)
        if count * len(self) <= FEW_PAIRS:
            segment, point = (np.sqrt(self.all_measured(columns)[0]) < radius).T.nonzero()
            return point, segment
        numbers = []
        for segment, point in self.blocks(BoxTree(points, points), radius):
            close = (np.sqrt(self.measure(columns, point, segment)[0]) < radius).nonzero()[0]
            numbers.append(segment.take(close) * count + point.take(close))
        number = np.sort(np.concatenate(numbers))
        segment = number // count
        return number - segment * count, segment

    def closest(self, points: FloatArray) -> ClosestEdge:
        """The closest segment to each of the points (P, 2); there must be one."""
        count = len(self)
        few = len(points) * count <= PYRAMID_COST * (len(points) + count) + PYRAMID_START
        rows, search = (
            (1 + CACHED_PAIRS // count, self._closest_of_all) if few else (CACHED_PAIRS // FANOUT, self._closest)
        )
        columns = np.ascontiguousarray(points.T)
        parts = [search(columns[:, k : k + rows]) for k in range(0, max(len(points), 1), rows)]
        return parts[0] if len(parts) == 1 else ClosestEdge(*map(np.concatenate, zip(*parts, strict=True)))

    def _closest_of_all(self, points: FloatArray) -> ClosestEdge:
        """The closest segment to points (2, P), all pairs measured."""
        squared, place = self.all_measured(points)
        edge = squared.argmin(axis=1)
        best = np.arange(len(edge)) * len(self) + edge
        return ClosestEdge(np.sqrt(squared.ravel().take(best)), edge, place.ravel().take(best))

    def _closest(self, points: FloatArray) -> ClosestEdge:
        """The closest segment to points (2, P) by the pyramid."""
        count, level, dots = points.shape[1], self._top, None
        while level > 0 and count * self._count(level - 1) <= FEW_PAIRS:
            level -= 1
        point = np.arange(count).repeat(self._count(level))
        box = np.tile(np.arange(self._count(level)), count)
        for k in range(level, 0, -1):
            at = points.take(point, axis=1)
            boxes = self._boxes(k).take(box, axis=1)
            apart = np.maximum(np.maximum(boxes[:2] - at, at - boxes[2:]), 0.0)
            at -= self._sorted[0].take(box * FANOUT**k, axis=1)
            bound = _least(_squared(at), point, count)
            near = (_squared(apart) <= bound.take(point)).nonzero()[0]
            if len(near) > CROWDED * count:
                dots = dots or OrientedBoxes.of_segments(points.T, points.T)
                gap = self._oriented_boxes(k).gap(box.take(near), dots, point.take(near))
                near = near[gap <= np.sqrt(bound.take(point.take(near)))]
            point, box = point.take(near).repeat(FANOUT), _children(box.take(near))
            exist = (box < self._count(k - 1)).nonzero()[0]
            point, box = point.take(exist), box.take(exist)
        edge = self._order.take(box)
        squared, place = self.measure(points, point, edge)
        least = _least(squared, point, count)
        alike = (squared == least.take(point)).nonzero()[0]
        best = alike.take(point.take(alike).searchsorted(np.arange(count)))
        return ClosestEdge(np.sqrt(least), edge.take(best), place.take(best))

    def all_measured(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(P, E), (P, E) what `measure` finds for all pairs."""
        starts, edges, along = (each[:, None] for each in self._columns)
        return _measured(points[:, :, None] - starts, edges, along)

    def measure(self, points: FloatArray, point: IntArray, edge: IntArray) -> tuple[FloatArray, FloatArray]:
        """(K,), (K,) squared distances of pairs of points (2, P) and segments, and places on these in [0, 1]."""
        starts, edges, along = (each.take(edge, axis=1) for each in self._columns)
        return _measured(points.take(point, axis=1) - starts, edges, along)

    @cached_property
    def _columns(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Starts of the segments, vectors along them, and these over their squared lengths, (2, E) each."""
        starts = self.starts.T.copy()
        along = self.ends.T - starts
        return starts, along, along / np.maximum(_squared(along), SMALLEST_LENGTH**2)

    @cached_property
    def _extents(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest coordinates of each segment, (2, E), (2, E)."""
        starts, ends = self.starts.T.copy(), self.ends.T
        return (starts, starts) if self.ends is self.starts else (np.minimum(starts, ends), np.maximum(starts, ends))

    @cached_property
    def _order(self) -> IntArray:
        """(E,) the index of each segment in the order of the pyramid."""
        starts, ends = self.starts.T.copy(), self.ends.T
        with np.errstate(over="ignore"):  # beyond the range of a double all are sorted
            farthest = ((starts.max(axis=1) - starts.min(axis=1)) / np.sqrt(len(self)))[:, None]
            apart = (np.abs(starts[:, 1:] - ends[:, :-1]) > farthest).any(axis=0)
            long = (np.abs(starts[:, 1:] - starts[:, :-1]) > farthest).any(axis=0)
        chained = self._sorted_chains(apart)
        if (long <= apart).all():
            return chained
        return min(chained, self._sorted_chains(apart | long), key=self._crowding)

    def _sorted_chains(self, apart: BoolArray) -> IntArray:
        """(E,) order in which segments stay together unless they are apart from the one before, (E - 1,)."""
        order = np.arange(len(self))
        begins = np.concatenate(([0], 1 + apart.nonzero()[0]))
        if len(begins) > FEW_CHAINS:
            sequence = _along_curve(self.starts[begins])
            sizes = np.diff(begins, append=len(order))[sequence]
            order += np.repeat(begins[sequence] - (np.cumsum(sizes) - sizes), sizes)
        return order

    def _crowding(self, order: IntArray) -> float:
        """Sum of the areas of the boxes around FANOUT segments each, in an order (E,)."""
        low, high = self._extents
        first = np.arange(0, len(order), FANOUT)
        low = np.minimum.reduceat(low.take(order, axis=1), first, axis=1)
        high = np.maximum.reduceat(high.take(order, axis=1), first, axis=1)
        with np.errstate(over="ignore", invalid="ignore"):
            return float(np.prod(high - low, axis=0).sum())

    @cached_property
    def _sorted(self) -> tuple[FloatArray, FloatArray]:
        """Starts and ends, (2, E) each, in that order."""
        starts = self.starts.T.take(self._order, axis=1)
        return starts, starts if self.ends is self.starts else self.ends.T.take(self._order, axis=1)

    @cached_property
    def _top(self) -> int:
        """The lowest level of at most FANOUT boxes."""
        level = 0
        while self._count(level) > FANOUT:
            level += 1
        return level

    def _count(self, level: int) -> int:
        """Number of boxes of a level."""
        return 1 + (len(self) - 1) // int(FANOUT**level)

    def _boxes(self, level: int) -> FloatArray:
        """(4, N) least x, least y, greatest x, greatest y; with empty boxes up to a multiple of FANOUT."""
        while len(self._levels) <= level:
            if not self._levels:
                starts, ends = self._sorted
                low, high = np.minimum(starts, ends), np.maximum(starts, ends)
            else:  # reducing along a short axis takes ten times as long as by slices
                low, high = self._levels[-1].reshape(2, 2, -1)
                low = reduce(np.minimum, (low[:, k::FANOUT] for k in range(FANOUT)))
                high = reduce(np.maximum, (high[:, k::FANOUT] for k in range(FANOUT)))
            with np.errstate(over="ignore", invalid="ignore"):  # only decides which level to open first
                self._sizes.append(float(high.mean() - low.mean()))
            empty = np.full((2, -low.shape[1] % FANOUT), np.inf)
            self._levels.append(np.concatenate((np.hstack((low, empty)), np.hstack((high, -empty)))))
        return self._levels[level]

    def _oriented_boxes(self, level: int) -> OrientedBoxes:
        if not self._oriented:
            self._oriented.append(OrientedBoxes.of_segments(*(each.T for each in self._sorted)))
        while len(self._oriented) <= level:
            self._oriented.append(self._oriented[-1].parents(FANOUT))
        return self._oriented[level]


def near_pairs(points: FloatArray, starts: FloatArray, ends: FloatArray, radius: float) -> tuple[IntArray, IntArray]:
    """Indices (point, edge) of points (P, 2) and edges (E, 2) closer than ``radius``; see `BoxTree.near`."""
    return BoxTree(starts, ends).near(points, radius)


def nearest(points: FloatArray, others: FloatArray) -> tuple[FloatArray, IntArray]:
    """(P,) distance of points (P, 2) from the nearest of others (Q, 2), and which that is."""
    distance, which, _ = BoxTree(others, others).closest(points)
    return distance, which


def position_in_group(counts: IntArray) -> IntArray:
    """0, 1, …, counts[0]-1, 0, 1, …, counts[1]-1, …: the position of every member in its group."""
    return np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)


def split_by(group: IntArray, count: int) -> list[IntArray]:
    """The indices of each of some groups, ascending; group: (K,) that of each index."""
    return np.split(np.argsort(group, kind="stable"), np.cumsum(np.bincount(group, minlength=count))[:-1])


def expanded(first: IntArray, count: IntArray) -> tuple[IntArray, IntArray]:
    """For each of `count` (N,) places from `first` on: whose it is, and the place."""
    whose = np.arange(len(first)).repeat(count)
    place = (first - np.cumsum(count) + count).take(whose)
    place += np.arange(len(whose))
    return whose, place


def _overlapping_along_x(one: BoxTree, other: BoxTree, radius: float) -> tuple[IntArray, IntArray] | None:
    """Pairs of boxes of two trees, or once each of one, within a radius along both axes; None if many are along x."""
    (low, high), (other_low, other_high) = one._extents, other._extents
    if radius:
        low, high = low - radius, high + radius
    order = other_low[0].argsort(kind="stable")
    begins = other_low[0].take(order)
    most = min(BLOCK_PAIRS, SORTED_PAIRS * (len(one) + len(other)))
    if one is other:
        first = np.arange(1, len(order) + 1)
        count = begins.searchsorted(high[0].take(order), "right") - first
        if count.sum() > most:
            return None
        i, place = expanded(first, count)
        i, j = order.take(i), order.take(place)
    else:
        # one of two that overlap begins within the other, where both begin at once the second within the first
        first = begins.searchsorted(low[0])
        count = begins.searchsorted(high[0], "right") - first
        own_order = low[0].argsort(kind="stable") if other_high is not other_low else order[:0]
        own_begins = low[0].take(own_order)
        own_first = own_begins.searchsorted(other_low[0], "right")
        own_count = own_begins.searchsorted(other_high[0], "right") - own_first
        if count.sum() + own_count.sum() > most:
            return None
        i, place = expanded(first, count)
        j, own_place = expanded(own_first, own_count)
        i, j = np.concatenate([i, own_order.take(own_place)]), np.concatenate([order.take(place), j])
    keep = low[1].take(i) <= other_high[1].take(j)
    keep &= other_low[1].take(j) <= high[1].take(i)
    kept = keep.nonzero()[0]
    return i.take(kept), j.take(kept)


def _overlapping(
    boxes: FloatArray, i: IntArray, others: FloatArray, j: IntArray, radius: float
) -> tuple[IntArray, IntArray]:
    """The pairs (i, j) of boxes within a radius along both axes."""
    for axis in (0, 1):
        keep = boxes[axis].take(i) - radius <= others[axis + 2].take(j)
        keep &= others[axis].take(j) - radius <= boxes[axis + 2].take(i)
        kept = keep.nonzero()[0]
        i, j = i.take(kept), j.take(kept)
    return i, j


def _squared(vectors: FloatArray) -> FloatArray:
    """Squared lengths of vectors (2, ...)."""
    return np.asarray(vectors[0] * vectors[0] + vectors[1] * vectors[1])


def _measured(to: FloatArray, edge: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Squared distances and places of the closest points on segments, for vectors from their starts to points.

    to, which is overwritten: (2, ...); edge, along: vectors of the segments, and these over their squared lengths.
    """
    place = to[0] * along[0]
    share = to[1] * along[1]
    place += share
    np.maximum(place, 0.0, out=place)
    np.minimum(place, 1.0, out=place)
    for axis in (0, 1):
        to[axis] -= np.multiply(place, edge[axis], out=share)
    to *= to
    to[0] += to[1]
    return to[0], place


def _least(values: FloatArray, point: IntArray, count: int) -> FloatArray:
    """(count,) the least of the values of each point, which follow each other; at least one each."""
    if count == 0:
        return values
    return np.asarray(np.minimum.reduceat(values, point.searchsorted(np.arange(count))))


def _children(nodes: IntArray) -> IntArray:
    """The boxes, one level down, of boxes (K,) of a level, (K FANOUT,)."""
    return (FANOUT * nodes[:, None] + np.arange(FANOUT)).ravel()


def _children_of_both(i: IntArray, j: IntArray) -> tuple[IntArray, IntArray]:
    offsets = np.indices((FANOUT, FANOUT)).reshape(2, -1)
    return (FANOUT * i[:, None] + offsets[0]).ravel(), (FANOUT * j[:, None] + offsets[1]).ravel()


def _along_curve(points: FloatArray) -> IntArray:
    """Order of points (K, 2) along a Morton curve, (K,): by the digits of x and y in turn."""
    low, high = points.min(axis=0), points.max(axis=0)
    with np.errstate(all="ignore"):
        cells = np.nan_to_num((points - low) / (high - low), nan=0.0, posinf=0.0, neginf=0.0)
    digits = np.unpackbits((cells * (CURVE_CELLS - 1)).astype(">u2").view(np.uint8).reshape(-1, 2, 2), axis=2)
    code = np.packbits(digits.transpose(0, 2, 1).reshape(len(points), -1), axis=1).view(">u4")[:, 0]
    return np.argsort(code, kind="stable")
