"""Exact containment: winding numbers by signed crossings of rays, summed over whole stretches of the loops."""

from __future__ import annotations

import numpy as np

from .._types import FloatArray, IntArray
from .box_tree import FANOUT, BoxTree
from .orientation import orientation

ON_BOUNDARY = int(np.iinfo(np.int64).min)
"""Value of `winding_number` for a point that lies on an edge."""


def winding_number(points: FloatArray, starts: FloatArray, ends: FloatArray) -> IntArray:
    """How often closed loops of directed edges (E, 2) -> (E, 2) run around points (P, 2); exact, (P,).

    Points on an edge get ON_BOUNDARY. A point inside a counter-clockwise loop gets 1.
    """
    points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    crossings = ray_crossings(points, BoxTree(starts, ends))
    winding = np.zeros(len(points), dtype=np.int64)
    np.add.at(winding, crossings.point, crossings.value)
    winding[crossings.touching] = ON_BOUNDARY
    return winding


class RayCrossings:
    """Signed crossings of the rays from points to the right, summed per chain of a tree.

    point, chain, value: (K,) each; touching: (T,) indices of points that lie on an edge (may repeat).
    """

    def __init__(self) -> None:
        self.point = self.chain = self.value = self.touching = np.zeros(0, dtype=np.int64)

    def add(self, point: IntArray, chain: IntArray, value: IntArray) -> None:
        counts = value != 0
        self.point = np.concatenate((self.point, point[counts]))
        self.chain = np.concatenate((self.chain, chain[counts]))
        self.value = np.concatenate((self.value, value[counts]))


def ray_crossings(points: FloatArray, tree: BoxTree) -> RayCrossings:
    """Crossings of the chains of a tree with the rays from points (P, 2) to the right; exact.

    A stretch of a chain outside whose box a point lies counts by its two ends alone: +1 if it ends above and starts
    not above the ray, -1 for the reverse, 0 left of the point. Only boxes around a point are opened, so the cost is
    about log E per point. An end on the ray counts as below, so a ray through a vertex is counted once.
    """
    crossings = RayCrossings()
    if len(tree) == 0 or len(points) == 0:
        return crossings
    x, y = np.ascontiguousarray(points.T)
    start_y, end_y = tree.starts[tree.order, 1], tree.ends[tree.order, 1]
    level = len(tree.levels) - 1
    top = tree.levels[level].shape[1]
    p, node = np.repeat(np.arange(len(points)), top), np.tile(np.arange(top), len(points))
    span = FANOUT**level
    while True:
        low_x, low_y, high_x, high_y = tree.levels[level].take(node, axis=1)
        px, py = x.take(p), y.take(p)
        relevant = px <= high_x
        inside = relevant & (low_x <= px) & (low_y <= py) & (py <= high_y)
        outside = relevant & ~inside & (low_y <= py) & (py <= high_y)
        first, last = node * span, np.minimum(node * span + span, len(tree)) - 1
        if not tree.closed:
            divided = outside.copy()
            divided[outside] = tree.chain[first[outside]] != tree.chain[last[outside]]
            inside |= divided
            outside &= ~divided
        q, first, last, qy = p[outside], first[outside], last[outside], py[outside]
        _count_stretches(crossings, tree, q, qy, first, last, start_y, end_y)
        p, node = p[inside], node[inside]
        if level == 0:
            break
        level, span = level - 1, span // FANOUT
        p, node = np.repeat(p, FANOUT), (FANOUT * node[:, None] + np.arange(FANOUT)).ravel()
    _count_edges(crossings, tree, points, p, node)
    return crossings


def _count_stretches(
    crossings: RayCrossings,
    tree: BoxTree,
    point: IntArray,
    y: FloatArray,
    first: IntArray,
    last: IntArray,
    start_y: FloatArray,
    end_y: FloatArray,
) -> None:
    """Count runs of segments first..last to the right of their points; whole closed chains in between add nothing."""
    begin, finish = tree.chain[first], tree.chain[last]
    one = begin == finish
    up_to, down_from = end_y[last] > y, start_y[first] > y
    crossings.add(point[one], begin[one], up_to[one].astype(np.int64) - down_from[one])
    many = ~one
    if many.any():
        opening, closing = start_y[tree.chain_starts[begin]] > y, start_y[tree.chain_starts[finish]] > y
        crossings.add(point[many], begin[many], opening[many].astype(np.int64) - down_from[many])
        crossings.add(point[many], finish[many], up_to[many].astype(np.int64) - closing[many])


def _count_edges(
    crossings: RayCrossings, tree: BoxTree, points: FloatArray, point: IntArray, segment: IntArray
) -> None:
    """Count single edges whose boxes hold their points: by the side of the edge that the point is on."""
    a, b, c = tree.starts[tree.order[segment]], tree.ends[tree.order[segment]], points[point]
    side = orientation(a, b, c)
    rises = (b[:, 1] > c[:, 1]).astype(np.int64) - (a[:, 1] > c[:, 1])
    crossings.add(point, tree.chain[segment], np.where(rises == side, rises, 0))
    crossings.touching = np.unique(point[side == 0])
