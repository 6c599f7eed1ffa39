"""Closed loops on plain arrays: tracing edges into loops, turning sense, nesting and area."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray
from .predicates import ALL_WINDINGS_LIMIT, BoxTree, Signs, as_integers, loop_windings, orientation, ray_crossings

CANCELLED_AREA = 1e-4
"""Fraction of the summed products below which an area has lost four digits or more and is summed exactly."""


@dataclass(frozen=True, eq=False)
class LoopOrder:
    """Vertices in walking order, loop after loop; a place is an index into this order.

    vertices: (n,) vertex at each place; sizes: (L,) number of vertices of each loop.
    """

    vertices: IntArray
    sizes: IntArray

    @cached_property
    def begins(self) -> IntArray:
        """(L,) first place of each loop."""
        return np.cumsum(self.sizes) - self.sizes

    @cached_property
    def loop(self) -> IntArray:
        """(n,) loop of each place."""
        return np.repeat(np.arange(len(self.sizes)), self.sizes)

    @cached_property
    def ahead(self) -> IntArray:
        """(n,) next place on the loop."""
        ahead = np.arange(1, len(self.vertices) + 1)
        ahead[self.begins + self.sizes - 1] = self.begins
        return ahead

    def turned(self, loops: BoolArray) -> LoopOrder:
        """The same loops, those chosen by (L,) walked the other way from the same first vertex."""
        places = np.arange(len(self.vertices))
        begins = self.begins[self.loop]
        mirrored = begins + (begins - places) % self.sizes[self.loop]
        return LoopOrder(self.vertices[np.where(loops[self.loop], mirrored, places)], self.sizes)

    def successor(self) -> IntArray:
        """(n,) the vertex after each vertex."""
        following = np.empty_like(self.vertices)
        following[self.vertices] = self.vertices[self.ahead]
        return following


def trace_loops(edges: IntArray, count: int) -> LoopOrder:
    """The loops that edges (n, 2) make of `count` vertices of degree two.

    Each loop starts at its smallest vertex, and loops are in the order of these. The direction is that of the first
    edge given at the smallest vertex, if that edge starts there.
    """
    ends = edges.ravel()
    places = np.arange(len(ends))
    first, last = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    first[ends[::-1]] = places[::-1]
    last[ends] = places
    leaves_here = first % 2 == 0
    ahead = ends[np.where(leaves_here, first, last) ^ 1]
    behind = ends[np.where(leaves_here, last, first) ^ 1]
    jumps = np.flatnonzero(ahead != np.arange(1, count + 1))
    begins = np.concatenate(([0], jumps[:-1] + 1))
    if np.array_equal(ahead[jumps], begins):  # loop after loop, the usual case
        return LoopOrder(np.arange(count), jumps + 1 - begins)
    return _walk(ahead.tolist(), behind.tolist())


def _walk(ahead: list[int], behind: list[int]) -> LoopOrder:
    """The loops found by walking from neighbour to neighbour, whichever way the edges point."""
    visited = bytearray(len(ahead))
    walked: list[int] = []
    sizes = []
    for start in range(len(ahead)):
        if visited[start]:
            continue
        before = len(walked)
        walked.append(start)
        previous, vertex = start, ahead[start]
        while vertex != start:
            walked.append(vertex)
            visited[vertex] = 1
            onward = ahead[vertex]
            previous, vertex = vertex, onward if onward != previous else behind[vertex]
        sizes.append(len(walked) - before)
    return LoopOrder(np.array(walked, dtype=np.int64), np.array(sizes, dtype=np.int64))


def extreme_places(points: FloatArray, order: LoopOrder) -> IntArray:
    """Place of the highest of the rightmost vertices of each loop, (L,); points: (n, 2) by place."""
    x, y = points.T
    rightmost = x == np.maximum.reduceat(x, order.begins)[order.loop]
    highest = np.maximum.reduceat(np.where(rightmost, y, -np.inf), order.begins)
    candidates = np.flatnonzero(rightmost & (y == highest[order.loop]))
    return candidates[np.unique(order.loop[candidates], return_index=True)[1]]


def turning_senses(points: FloatArray, order: LoopOrder, extreme: IntArray) -> Signs:
    """Sense of each simple loop, (L,): 1 counter-clockwise, -1 clockwise; exact.

    points: (n, 2) by place; extreme: (L,) as from `extreme_places`. A loop is convex there and cannot be flat, so the
    sign of that one corner is the sense of the whole loop.
    """
    before = order.begins + (extreme - order.begins - 1) % order.sizes
    return orientation(points[before], points[extreme], points[order.ahead[extreme]])


def enclosing_pairs(extremes: FloatArray, order: LoopOrder, tree: BoxTree) -> tuple[IntArray, IntArray]:
    """Pairs (inner, outer) where the outer loop runs around the inner one, (K,), (K,); exact.

    extremes: (I, 2) extreme vertices of loops that do not meet those of the tree, or are among them: the ray to the
    right leaves its own loop at once. tree: over the edges by place of the outer loops in `order`.
    """
    if len(extremes) * len(tree) <= ALL_WINDINGS_LIMIT:
        inner, outer = loop_windings(extremes, tree.starts, tree.ends, order.loop).nonzero()
        return inner, outer
    crossings = ray_crossings(extremes, tree)
    crossed = order.loop[tree.order[tree.chain_starts[crossings.chain]]]
    count = len(order.sizes)
    keys, places = np.unique(crossings.point.astype(np.int64) * count + crossed, return_inverse=True)
    winding = np.bincount(places, weights=crossings.value, minlength=len(keys))
    inner, outer = np.divmod(keys[winding != 0], count)
    return inner, outer


def parents(inner: IntArray, outer: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """Nesting depth of each of `count` loops, (L,), and the smallest loop around it (-1 for none), (L,)."""
    depth = np.bincount(inner, minlength=count)
    parent = np.full(count, -1, dtype=np.int64)
    direct = depth[outer] == depth[inner] - 1
    parent[inner[direct]] = outer[direct]
    return depth, parent


def signed_areas(points: FloatArray, order: LoopOrder) -> tuple[FloatArray, float]:
    """Signed area of each loop, (L,), and their sum: Green's theorem; exact before rounding where digits cancel.

    points: (n, 2) by place.
    """
    x, y = (points - points.take(order.begins.take(order.loop), axis=0)).T
    left, right = x * (y[order.ahead] - y), y * (x[order.ahead] - x)
    areas = np.add.reduceat(left - right, order.begins) / 2.0
    doubtful = np.abs(areas) < CANCELLED_AREA * np.add.reduceat(np.abs(left) + np.abs(right), order.begins)
    for k in np.flatnonzero(doubtful & np.isfinite(areas)):
        areas[k] = float(_exact_area(np.split(points, order.begins[1:])[k]))
    total = math.fsum(areas)
    if abs(total) < CANCELLED_AREA * float(np.abs(areas).sum()):
        total = float(sum((_exact_area(loop) for loop in np.split(points, order.begins[1:])), Fraction(0)))
    return areas, total


def _exact_area(points: FloatArray) -> Fraction:
    """Signed area of a loop (k, 2) without rounding."""
    integers, exponents = as_integers(points.reshape(1, -1))
    x, y = integers.reshape(-1, 2).T
    doubled = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    return Fraction(doubled) * Fraction(2) ** (2 * int(exponents[0]) - 1)
