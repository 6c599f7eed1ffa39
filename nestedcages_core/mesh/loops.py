"""Closed loops on plain arrays: tracing edges into loops, turning sense, nesting and area."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from .._types import FloatArray, IntArray
from ..predicates import BoxTree, Signs, as_integers, orientation, ray_crossings

DOUBTFUL_AREA = 1e-4
"""Share of the summed products below which an area has lost four digits or more and is summed exactly instead."""


def trace_loops(edges: IntArray, count: int) -> list[IntArray]:
    """Vertices of each loop in walking order, from edges (m, 2) over `count` vertices of degree two.

    Each loop starts at its smallest vertex; loops are in the order of these. The direction is that of the first edge
    given at the smallest vertex, if that edge starts there.
    """
    ends = edges.ravel()
    places = np.arange(len(ends))
    first, last = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    first[ends[::-1]] = places[::-1]
    last[ends] = places
    leaves_here = first % 2 == 0
    ahead = ends[np.where(leaves_here, first, last) ^ 1].tolist()
    behind = ends[np.where(leaves_here, last, first) ^ 1].tolist()
    visited = bytearray(count)
    loops = []
    for start in range(count):
        if visited[start]:
            continue
        loop, previous, vertex = [start], start, ahead[start]
        while vertex != start:
            loop.append(vertex)
            visited[vertex] = 1
            onward = ahead[vertex]
            previous, vertex = vertex, onward if onward != previous else behind[vertex]
        loops.append(np.array(loop, dtype=np.int64))
    return loops


def successors(loops: Sequence[IntArray], count: int) -> IntArray:
    """The vertex after each vertex, (count,)."""
    following = np.empty(count, dtype=np.int64)
    for loop in loops:
        following[loop[:-1]] = loop[1:]
        following[loop[-1]] = loop[0]
    return following


def turning_senses(points: FloatArray, sizes: IntArray) -> tuple[Signs, IntArray]:
    """Sense of each simple loop (1 counter-clockwise, -1 clockwise), (L,), and the place of its extreme vertex, (L,).

    points: (n, 2), loop after loop; sizes: (L,). The extreme vertex is the highest of the rightmost ones; the loop
    is convex there and cannot be flat, so the exact sign of that one corner is the sense of the whole loop.
    """
    begins = np.cumsum(sizes) - sizes
    loop = np.repeat(np.arange(len(sizes)), sizes)
    x, y = points.T
    rightmost = x == np.maximum.reduceat(x, begins)[loop]
    highest = np.maximum.reduceat(np.where(rightmost, y, -np.inf), begins)
    candidates = np.flatnonzero(rightmost & (y == highest[loop]))
    extreme = candidates[np.unique(loop[candidates], return_index=True)[1]]
    before = begins + (extreme - begins - 1) % sizes
    after = begins + (extreme - begins + 1) % sizes
    return orientation(points[before], points[extreme], points[after]), extreme


def enclosing_pairs(points: FloatArray, sizes: IntArray, extreme: IntArray, tree: BoxTree) -> tuple[IntArray, IntArray]:
    """Pairs (inner, outer) of loops where the outer one runs around the inner one, (K,), (K,); exact.

    points: (n, 2), loop after loop; sizes: (L,); extreme: (L,) as from `turning_senses`; tree: of all the edges.
    The loops must be free of contact. The ray to the right of an extreme vertex leaves its own loop at once.
    """
    crossings = ray_crossings(points[extreme], tree)
    loop = np.repeat(np.arange(len(sizes)), sizes)
    crossed = loop[tree.order[tree.chain_starts[crossings.chain]]]
    keys, places = np.unique(crossings.point * len(sizes) + crossed, return_inverse=True)
    winding = np.bincount(places, weights=crossings.value, minlength=len(keys))
    inner, outer = np.divmod(keys[winding != 0], len(sizes))
    return inner[inner != outer], outer[inner != outer]


def parents(inner: IntArray, outer: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """Nesting depth of each of `count` loops, (L,), and the smallest loop around it (-1 for none), (L,)."""
    depth = np.bincount(inner, minlength=count)
    parent = np.full(count, -1, dtype=np.int64)
    direct = depth[outer] == depth[inner] - 1
    parent[inner[direct]] = outer[direct]
    return depth, parent


def signed_areas(vertices: FloatArray, loops: Sequence[IntArray]) -> tuple[FloatArray, float]:
    """Signed area of each loop, (L,), and their sum: Green's theorem; exact before rounding where digits cancel."""
    sizes = np.array([len(loop) for loop in loops])
    begins = np.cumsum(sizes) - sizes
    points = vertices[np.concatenate(loops)]
    x, y = (points - np.repeat(points[begins], sizes, axis=0)).T
    ahead = np.arange(1, len(points) + 1)
    ahead[begins + sizes - 1] = begins
    left, right = x * (y[ahead] - y), y * (x[ahead] - x)
    areas = np.add.reduceat(left - right, begins) / 2.0
    doubtful = np.abs(areas) < DOUBTFUL_AREA * np.add.reduceat(np.abs(left) + np.abs(right), begins)
    for k in np.flatnonzero(doubtful & np.isfinite(areas)):
        areas[k] = float(_exact_area(vertices[loops[k]]))
    total = math.fsum(areas)
    if abs(total) < DOUBTFUL_AREA * float(np.abs(areas).sum()):
        total = float(sum((_exact_area(vertices[loop]) for loop in loops), Fraction(0)))
    return areas, total


def _exact_area(points: FloatArray) -> Fraction:
    """Signed area of a loop (k, 2) without rounding."""
    integers, exponents = as_integers(points.reshape(1, -1))
    x, y = integers.reshape(-1, 2).T
    doubled = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    return Fraction(doubled) * Fraction(2) ** (2 * int(exponents[0]) - 1)
