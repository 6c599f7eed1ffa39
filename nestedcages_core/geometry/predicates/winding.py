"""Exact winding numbers by signed crossings of rays to the right."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..broad_phase import expanded
from .orientation import Signs, orientation

ON_BOUNDARY = int(np.iinfo(np.int64).min)
"""Value of `winding_number` for a point that lies on an edge."""

MAX_PAIRS = 2**18
"""Pairs of a point and an edge at its height tested together; bounds the memory to about 30 MB."""


def winding_number(points: FloatArray, starts: FloatArray, ends: FloatArray) -> IntArray:
    """How often closed loops of directed edges (E, 2) -> (E, 2) run around points (P, 2); exact, (P,).

    Points on an edge get ON_BOUNDARY. A point inside a counter-clockwise loop gets 1.
    """
    points, starts, ends = (np.asarray(a, dtype=np.float64).reshape(-1, 2) for a in (points, starts, ends))
    winding, touching = np.zeros(len(points), np.int64), np.zeros(len(points), bool)
    for point, _, value, touches in _crossings(points, starts, ends):
        winding += np.bincount(point, value, len(points)).astype(np.int64)
        touching[point[touches]] = True
    winding[touching] = ON_BOUNDARY
    return winding


def loop_windings(
    points: FloatArray, starts: FloatArray, ends: FloatArray, loop: IntArray
) -> tuple[IntArray, IntArray, IntArray]:
    """The windings that are not 0 of closed loops of edges (E, 2) -> (E, 2) around points (P, 2) on none of them.

    loop: (E,) the loop of each edge. Points (K,), loops (K,) and how often these run around them, (K,); exact.
    """
    count = int(loop.max()) + 1
    keys, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int8)]
    for point, edge, value, _ in _crossings(points, starts, ends):
        crossed = value.nonzero()[0]
        keys.append((point * count + loop.take(edge)).take(crossed))
        values.append(value.take(crossed))
    key, which = np.unique(np.concatenate(keys), return_inverse=True)
    winding = np.bincount(which, np.concatenate(values), len(key)).astype(np.int64)
    key, winding = key[winding != 0], winding[winding != 0]
    return key // count, key % count, winding


def _crossings(
    points: FloatArray, starts: FloatArray, ends: FloatArray
) -> Iterator[tuple[IntArray, IntArray, Signs, BoolArray]]:
    """Pairs (point, edge) of edges at the height of the point and not left of it, in blocks: 1 where the ray from the
    point crosses the edge upwards, -1 downwards, else 0, and whether the point is on the edge.

    A vertex on the ray counts as below it, so that a ray through a vertex is counted once.
    """
    order = points[:, 1].argsort()
    height = points[:, 1].take(order)
    low, high = np.minimum(starts, ends).T, np.maximum(starts, ends).T
    first = height.searchsorted(low[1])
    count = height.searchsorted(high[1], "right") - first
    total = np.cumsum(count)
    begin = 0
    while begin < len(starts):
        done = int(total[begin] - count[begin])
        stop = max(begin + 1, int(total.searchsorted(done + MAX_PAIRS, "right")))
        edge, place = expanded(first[begin:stop], count[begin:stop])
        edge, point = edge + begin, order.take(place)
        begin = stop
        kept = (high[0].take(edge) >= points[:, 0].take(point)).nonzero()[0]
        edge, point = edge.take(kept), point.take(kept)
        x, y = points.take(point, axis=0).T
        value: Signs = (ends[:, 1].take(edge) > y).astype(np.int8) - (starts[:, 1].take(edge) > y)
        on_edge = np.zeros(len(edge), bool)
        beside = (low[0].take(edge) <= x).nonzero()[0]
        at = edge.take(beside)
        side = orientation(starts.take(at, axis=0), ends.take(at, axis=0), points.take(point.take(beside), axis=0))
        on_edge[beside] = side == 0
        value[beside] *= side == value[beside]
        yield point, edge, value, on_edge
