"""Closed loops on plain arrays: tracing edges into loops, turning sense, nesting and area."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray
from .broad_phase import BoxTree
from .predicates import Signs, as_integers, loop_windings, orientation
from .significance import significance
from .vectors import norm

CONNECTIVITY = ("begins", "loop", "ahead", "back", "successor", "predecessor")
"""What is computed of loops once and stays when their vertices move."""

CANCELLED_AREA = 1e-4
"""Fraction of the summed products below which an area has lost four digits or more and is summed exactly."""


@dataclass(frozen=True, eq=False)
class Loops:
    """Closed loops, one after the other, that are walked forwards or backwards.

    A place is an index into this order. What is walked backwards is enclosed from outside: no copy is made of it.
    """

    vertices: FloatArray
    """(n, 2) by place."""
    sizes: IntArray
    """(L,) number of vertices of each loop."""
    numbers: IntArray
    """(n,) number in a mesh of the vertex at each place."""
    sense: int = 1
    """1 forwards, -1 backwards."""

    @classmethod
    def of(cls, vertices: FloatArray, sizes: IntArray | Sequence[int]) -> Loops:
        """Loops of vertices (n, 2) whose numbers are their places."""
        return cls(vertices, np.asarray(sizes, np.int64), np.arange(len(vertices)))

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
        return self._walked(self.sense)

    @cached_property
    def back(self) -> IntArray:
        """(n,) previous place on the loop."""
        return self._walked(-self.sense)

    @cached_property
    def successor(self) -> IntArray:
        """(n,) number of the vertex after each vertex, by number."""
        return self._by_number(self.numbers[self.ahead])

    @cached_property
    def predecessor(self) -> IntArray:
        """(n,) number of the vertex before each vertex, by number."""
        return self._by_number(self.numbers[self.back])

    @property
    def ends(self) -> FloatArray:
        """(n, 2) where the edge that starts at each place ends."""
        return self.vertices.take(self.ahead, axis=0)

    @cached_property
    def tree(self) -> BoxTree:
        """The edges, each by the place of its start."""
        return BoxTree(self.vertices, self.ends)

    @cached_property
    def areas(self) -> FloatArray:
        """(L,) signed area of each loop: clockwise ones count negative."""
        return self.sense * self._areas[0]

    @property
    def area(self) -> float:
        """Area of the solid; negative for that around it."""
        return self.sense * self._areas[1]

    @cached_property
    def _areas(self) -> tuple[FloatArray, float]:
        return signed_areas(self)

    @cached_property
    def significance(self) -> FloatArray:
        """(n,) distance up to which each place may be left out; see `significance`."""
        return significance(self.split())

    @cached_property
    def centre(self) -> FloatArray:
        """(2,) centroid of the loops as wires, independent of rotation."""
        here = self.vertices - self.vertices[0]
        there = here.take(self.ahead, axis=0)
        lengths = norm(there - here)
        centre: FloatArray = self.vertices[0] + (lengths[:, None] * (0.5 * (here + there))).sum(axis=0) / lengths.sum()
        return centre

    @cached_property
    def diameter(self) -> float:
        """Diameter of the circle around the centre that holds the loops."""
        return 2.0 * float(norm(self.vertices - self.centre).max())

    def split(self) -> list[FloatArray]:
        """The vertices of each loop, (k, 2)."""
        return np.split(self.vertices, self.begins[1:])

    def moved(self, vertices: FloatArray) -> Loops:
        """The same loops with other vertices (n, 2)."""
        return self._sharing(vertices=vertices)

    def walked(self, sense: int) -> Loops:
        """The same loops forwards or backwards."""
        return self if sense == self.sense else replace(self, sense=sense)

    def turned(self, loops: BoolArray) -> Loops:
        """The same loops, those chosen by (L,) walked the other way from the same first vertex."""
        places = np.arange(len(self.numbers))
        begins = self.begins[self.loop]
        order = np.where(loops[self.loop], begins + (begins - places) % self.sizes[self.loop], places)
        return replace(self, vertices=self.vertices[order], numbers=self.numbers[order])

    def __getstate__(self) -> dict[str, Any]:
        """All but the tree, which is cheap to rebuild."""
        return {name: value for name, value in vars(self).items() if name != "tree"}

    def _walked(self, sense: int) -> IntArray:
        first, last = self.begins, self.begins + self.sizes - 1
        following = np.arange(len(self.numbers)) + sense
        following[last if sense > 0 else first] = first if sense > 0 else last
        return following

    def _by_number(self, values: IntArray) -> IntArray:
        ordered = np.empty_like(values)
        ordered[self.numbers] = values
        return ordered

    def _sharing(self, vertices: FloatArray) -> Loops:
        """With other vertices, and what has been computed of the order of the loops."""
        other = replace(self, vertices=vertices)
        known = vars(self)
        vars(other).update({name: known[name] for name in CONNECTIVITY if name in known})
        return other


def trace_loops(edges: IntArray, vertices: FloatArray) -> Loops:
    """The loops that edges (n, 2) make of vertices (n, 2) of degree two.

    Each loop starts at its smallest vertex, and loops are in the order of these. The direction is that of the first
    edge given at the smallest vertex, if that edge starts there.
    """
    ends, count = edges.ravel(), len(vertices)
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
        return Loops.of(vertices, jumps + 1 - begins)
    walked, sizes = _walk(ahead.tolist(), behind.tolist())
    return Loops(vertices.take(walked, axis=0), sizes, walked)


def _walk(ahead: list[int], behind: list[int]) -> tuple[IntArray, IntArray]:
    """Vertices (n,) and sizes (L,) of loops, from neighbour to neighbour, whichever way the edges point."""
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
    return np.array(walked, dtype=np.int64), np.array(sizes, dtype=np.int64)


def extreme_places(order: Loops) -> IntArray:
    """Place of the highest of the rightmost vertices of each loop, (L,)."""
    x, y = order.vertices.T
    rightmost = x == np.maximum.reduceat(x, order.begins)[order.loop]
    highest = np.maximum.reduceat(np.where(rightmost, y, -np.inf), order.begins)
    candidates = np.flatnonzero(rightmost & (y == highest[order.loop]))
    return candidates[np.unique(order.loop[candidates], return_index=True)[1]]


def turning_senses(order: Loops, extreme: IntArray) -> Signs:
    """Sense of each simple loop, (L,): 1 counter-clockwise, -1 clockwise; exact.

    extreme: (L,) as from `extreme_places`. A loop is convex there and cannot be flat, so the
    sign of that one corner is the sense of the whole loop.
    """
    points = order.vertices
    return orientation(points[order.back[extreme]], points[extreme], points[order.ahead[extreme]])


def enclosing_pairs(extremes: FloatArray, order: Loops) -> tuple[IntArray, IntArray]:
    """Pairs (inner, outer) where a loop of `order` runs around the inner one, (K,), (K,); exact.

    extremes: (I, 2) extreme vertices of loops that do not meet those, or are among them: the ray to the right leaves
    its own loop at once.
    """
    inner, outer, _ = loop_windings(extremes, order.vertices, order.ends, order.loop)
    return inner, outer


def parents(inner: IntArray, outer: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """Nesting depth of each of `count` loops, (L,), and the smallest loop around it (-1 for none), (L,)."""
    depth = np.bincount(inner, minlength=count)
    parent = np.full(count, -1, dtype=np.int64)
    direct = depth[outer] == depth[inner] - 1
    parent[inner[direct]] = outer[direct]
    return depth, parent


def signed_areas(order: Loops) -> tuple[FloatArray, float]:
    """Signed area of each loop, (L,), and their sum: Green's theorem; exact before rounding where digits cancel."""
    points = order.vertices
    x, y = (points - points.take(order.begins.take(order.loop), axis=0)).T
    left, right = x * (y[order.ahead] - y), y * (x[order.ahead] - x)
    areas = np.add.reduceat(left - right, order.begins) / 2.0
    doubtful = np.abs(areas) < CANCELLED_AREA * np.add.reduceat(np.abs(left) + np.abs(right), order.begins)
    for k in np.flatnonzero(doubtful & np.isfinite(areas)):
        areas[k] = float(_exact_area(np.split(points, order.begins[1:])[k]))
    total = math.fsum(areas)
    if abs(total) < CANCELLED_AREA * float(np.abs(areas).sum()):
        total = float(sum(map(_exact_area, np.split(points, order.begins[1:]))))
    return areas, total


def _exact_area(points: FloatArray) -> Any:
    """Signed area of a loop (k, 2) without rounding, as a fraction."""
    from fractions import Fraction  # few areas are doubtful

    integers, exponents = as_integers(points.reshape(1, -1))
    x, y = integers.reshape(-1, 2).T
    doubled = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    return Fraction(doubled) * Fraction(2) ** (2 * int(exponents[0]) - 1)
