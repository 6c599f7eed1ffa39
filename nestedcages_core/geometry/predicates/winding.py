"""Exact winding numbers by signed crossings of rays: pair by pair, or summed over whole stretches of the loops."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from .box_tree import CROWDED, FANOUT, BoxTree, children
from .orientation import Signs, orientation
from .sweep import expanded

ON_BOUNDARY = int(np.iinfo(np.int64).min)
"""Value of `winding_number` for a point that lies on an edge."""

ALL_WINDINGS_LIMIT = 100_000
"""Number of pairs of points and edges up to which `loop_windings` is faster than a tree (measured)."""

AT_HEIGHT = 16
"""Edges at the height of a point, per point and edge, above which a tree is faster than testing them (measured)."""

PAIR_BLOCK = 2**19
"""Pairs of a point and a box tested together; bounds the memory to about 100 MB."""

FEW_PAIRS = 20_000
"""Number of point-segment pairs up to which testing all of them is faster than descending the tree (measured)."""


def winding_number(points: FloatArray, starts: FloatArray, ends: FloatArray) -> IntArray:
    """How often closed loops of directed edges (E, 2) -> (E, 2) run around points (P, 2); exact, (P,).

    Points on an edge get ON_BOUNDARY. A point inside a counter-clockwise loop gets 1.
    """
    points, starts, ends = (np.asarray(a, dtype=np.float64).reshape(-1, 2) for a in (points, starts, ends))
    pairs = _at_height(points, starts, ends, "right", AT_HEIGHT * (len(points) + len(starts)) + FEW_PAIRS)
    if pairs is None:
        crossings = ray_crossings(points, BoxTree(starts, ends))
        winding = np.bincount(crossings.point, crossings.value, len(points)).astype(np.int64)
        winding[crossings.touching] = ON_BOUNDARY
        return winding
    point, edge = pairs
    a, b, p = starts.take(edge, axis=0), ends.take(edge, axis=0), points.take(point, axis=0)
    (ax, ay), (bx, by), (x, y) = a.T, b.T, p.T
    side = orientation(a, b, p)
    rises = (by > y).astype(np.int64) - (ay > y)
    crossed = (rises != 0) & (side == rises)
    winding = np.bincount(point[crossed], rises[crossed], len(points)).astype(np.int64)
    winding[point[(side == 0) & (np.minimum(ax, bx) <= x) & (x <= np.maximum(ax, bx))]] = ON_BOUNDARY
    return winding


def winding_around(points: FloatArray, starts: FloatArray, ends: FloatArray) -> IntArray:
    """`winding_number` where points on edges may get any value, (P,)."""
    pairs = _at_height(points, starts, ends, "left", AT_HEIGHT * (len(points) + len(starts)) + FEW_PAIRS)
    if pairs is None:
        return winding_number(points, starts, ends)
    point, _, value = _crossed(points, starts, ends, *pairs)
    return np.bincount(point, value, len(points)).astype(np.int64)


def loop_windings(points: FloatArray, starts: FloatArray, ends: FloatArray, loop: IntArray) -> IntArray:
    """How often each of L closed loops of edges (E, 2) -> (E, 2) runs around points (P, 2) on none of them, (P, L).

    loop: (E,) the loop of each edge. Exact; every pair of a point and an edge is tested.
    """
    pairs = _at_height(points, starts, ends, "left", len(points) * len(starts))
    assert pairs is not None
    point, edge, value = _crossed(points, starts, ends, *pairs)
    count = int(loop.max()) + 1
    winding = np.bincount(point * count + loop.take(edge), value, len(points) * count)
    return winding.astype(np.int64).reshape(len(points), count)


def _at_height(
    points: FloatArray, starts: FloatArray, ends: FloatArray, side: Literal["left", "right"], most: int
) -> tuple[IntArray, IntArray] | None:
    """Pairs (point, edge) where the point is at the height of the edge, (K,), (K,); None if more than ``most``.

    side: whether the upper end of an edge counts ("right") or not ("left").
    """
    height, start, end = points[:, 1], starts[:, 1], ends[:, 1]
    order = height.argsort()
    height = height.take(order)
    first = height.searchsorted(np.minimum(start, end))
    count = height.searchsorted(np.maximum(start, end), side) - first
    if count.sum() > most:
        return None
    edge, place = expanded(first, count)
    return order.take(place), edge


def _crossed(
    points: FloatArray, starts: FloatArray, ends: FloatArray, point: IntArray, edge: IntArray
) -> tuple[IntArray, IntArray, Signs]:
    """Those of some pairs where the ray from the point to the right crosses the edge, and 1 for upwards, -1 for down.

    The pairs are those at one height, upper ends left out: a vertex on the ray counts as below it, so a ray through a
    vertex is counted once.
    """
    start, end, place = starts.take(edge, axis=0), ends.take(edge, axis=0), points.take(point, axis=0)
    rises: Signs = 2 * (end[:, 1] > place[:, 1]).view(np.int8) - 1
    right = (orientation(start, end, place) == rises).nonzero()[0]
    return point.take(right), edge.take(right), rises.take(right)


class RayCrossings(NamedTuple):
    """Signed crossings of the rays from points to the right, in parts that add up per point and chain of a tree."""

    point: IntArray
    """(K,) index of the point."""
    chain: IntArray
    """(K,) chain of the tree that is crossed."""
    value: IntArray
    """(K,) crossings upwards less crossings downwards."""
    touching: IntArray
    """(T,) points that lie on an edge."""


def ray_crossings(points: FloatArray, tree: BoxTree) -> RayCrossings:
    """Crossings of the chains of a tree with the rays from points (P, 2) to the right; exact.

    A stretch of a chain in a convex region without the point is crossed as often as its chord, the segment from its
    first to its last vertex. So only boxes around a point are opened, and the cost is about log E per point. A vertex
    on the ray counts as below it, so a ray through a vertex is counted once.
    """
    rays = _Rays(points, tree)
    if len(tree):
        rays.follow()
    point, chain, value = (np.concatenate(column) for column in zip(*rays.parts, strict=True))
    return RayCrossings(point, chain, value, np.unique(np.concatenate(rays.touching)))


class _Rays:
    """The rays from points (P, 2) to the right, and their descent of a tree.

    parts: (point, chain, value) counted so far; touching: points found on an edge so far.
    """

    def __init__(self, points: FloatArray, tree: BoxTree) -> None:
        self.points, self.tree = points, tree
        self.starts, self.ends = tree.sorted_segments
        none = np.zeros(0, dtype=np.int64)
        self.parts: list[tuple[IntArray, IntArray, IntArray]] = [(none, none, none)]
        self.touching: list[IntArray] = [none]

    def follow(self) -> None:
        """Open the boxes around each point, down to the single segments."""
        count, level = len(self.points), len(self.tree.levels) - 1
        if count * len(self.tree) <= FEW_PAIRS:
            level = 0
        top = self.tree.levels[level].shape[1]
        waiting = [(level, np.repeat(np.arange(count), top), np.tile(np.arange(top), count))]
        tally = [0] * (level + 1)
        while waiting:
            level, p, node = waiting.pop()
            if len(p) > PAIR_BLOCK:
                middle = len(p) // 2
                waiting += [(level, p[middle:], node[middle:]), (level, p[:middle], node[:middle])]
                continue
            p, node = self._open(level, p, node, tally)
            if level == 0:
                self._touch(p, node)
            else:
                waiting.append((level - 1, np.repeat(p, FANOUT), children(node)))

    def _open(self, level: int, p: IntArray, node: IntArray, tally: list[int]) -> tuple[IntArray, IntArray]:
        """The pairs whose box holds the point; pairs whose box is to the right are counted. tally: pairs opened."""
        tree = self.tree
        low_x, low_y, high_x, high_y = tree.levels[level].take(node, axis=1)
        x, y = self.points[p].T
        beside = (x <= high_x) & (low_y <= y) & (y <= high_y)
        inside = beside & (low_x <= x)
        tally[level] += int(np.count_nonzero(inside))
        if level > 0 and tally[level] > CROWDED * len(self.points):
            held = np.flatnonzero(inside)
            inside[held] = tree.oriented(level).may_hold(node[held], self.points[p[held]])
        done = np.flatnonzero(beside & ~inside)
        span = FANOUT**level
        first, last = node[done] * span, np.minimum(node[done] * span + span, len(tree)) - 1
        if not tree.closed:
            whole = tree.chain[first] == tree.chain[last]
            inside[done[~whole]] = True
            done, first, last = done[whole], first[whole], last[whole]
        self._cross(p[done], first, last)
        return p[inside], node[inside]

    def _cross(self, point: IntArray, first: IntArray, last: IntArray) -> None:
        """Count stretches of segments first..last by their chords; whole closed chains in between add nothing."""
        if len(point) == 0:
            return
        chain, bounds = self.tree.chain, self.tree.chain_starts
        one = chain[first] == chain[last]
        self._count(point[one], first[one], last[one])
        if one.all():
            return
        point, first, last = point[~one], first[~one], last[~one]
        self._count(point, first, bounds[chain[first] + 1] - 1)
        self._count(point, bounds[chain[last]], last)

    def _touch(self, point: IntArray, segment: IntArray) -> None:
        """Count single segments, and note the points that lie on one."""
        if len(point) == 0:
            return
        self._count(point, segment, segment)
        sides = orientation(self.starts[segment], self.ends[segment], self.points[point])
        self.touching.append(point[sides == 0])

    def _count(self, point: IntArray, first: IntArray, last: IntArray) -> None:
        """Count the chords from the start of segment first to the end of last, where they pass right of the point."""
        y = self.points[point, 1]
        rises = (self.ends[last, 1] > y).astype(np.int64) - (self.starts[first, 1] > y)
        k = np.flatnonzero(rises)
        if len(k) == 0:
            return
        side = orientation(self.starts[first[k]], self.ends[last[k]], self.points[point[k]])
        k = k[side == rises[k]]
        self.parts.append((point[k], self.tree.chain[first[k]], rises[k]))
