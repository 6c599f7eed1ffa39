"""Signed crossings of rays with loops, summed over whole stretches of these."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from .box_tree import CROWDED, FANOUT, FEW_PAIRS, BoxTree, children
from .orientation import orientation

PAIR_BLOCK = 2**19
"""Pairs of a point and a box tested together; bounds the memory to about 100 MB."""


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
