"""Exact winding numbers by signed crossings of rays."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ..arrays import FloatArray, IntArray
from .box_tree import FEW_PAIRS, BoxTree
from .orientation import Signs, orientation
from .sweep import expanded

ON_BOUNDARY = int(np.iinfo(np.int64).min)
"""Value of `winding_number` for a point that lies on an edge."""

ALL_WINDINGS_LIMIT = 100_000
"""Number of pairs of points and edges up to which `loop_windings` is faster than a tree (measured)."""

AT_HEIGHT = 16
"""Edges at the height of a point, per point and edge, above which a tree is faster than testing them (measured)."""


def winding_number(points: FloatArray, starts: FloatArray, ends: FloatArray) -> IntArray:
    """How often closed loops of directed edges (E, 2) -> (E, 2) run around points (P, 2); exact, (P,).

    Points on an edge get ON_BOUNDARY. A point inside a counter-clockwise loop gets 1.
    """
    points, starts, ends = (np.asarray(a, dtype=np.float64).reshape(-1, 2) for a in (points, starts, ends))
    pairs = _at_height(points, starts, ends, "right", AT_HEIGHT * (len(points) + len(starts)) + FEW_PAIRS)
    if pairs is None:
        from .rays import ray_crossings  # for crowded heights only

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
