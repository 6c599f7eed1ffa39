"""Contacts as constraints on the motion of the cage: signed distances, their rows, and which of them matter.

To first order a motion D changes the distance of a point p to the edge a-b by n · (D_p - (1 - t) D_a - t D_b), with the
unit normal n from the edge to the point and the parameter t of the closest point. Pairs that the motion cannot bring
together, and pairs that others imply, are left out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._types import BoolArray, FloatArray, IntArray
from ..distance import SMALLEST_LENGTH
from ..solver.normal_equations import Rows
from .pairs import Pairs

HULL_PASSES = 6
"""Passes of the convex hull of an edge's contacts: each removes every point that lies above its two neighbours."""

THINNING_PASSES = 8
"""Passes of thinning: each halves the points of a smooth arc at the most."""


class Contacts(NamedTuple):
    """Signed distances of K pairs and what their derivatives need."""

    distance: FloatArray
    """(K,) negative where the point has changed to the other side of the edge."""
    parameter: FloatArray
    """(K,) position t of the closest point on the edge."""
    normal: FloatArray
    """(K, 2) gradient of the signed distance with respect to the point."""
    side: FloatArray
    """(K,) sign of the side of the edge's line on which the point lies: 1 left, -1 right."""


def measure(pairs: Pairs, x: FloatArray, side: FloatArray | None = None) -> Contacts:
    """Distances of the pairs at the positions x (m + n, 2); negative where a pair is no longer on its ``side`` (K,)."""
    a = x.take(pairs.start, axis=0)
    edge = x.take(pairs.end, axis=0) - a
    to = x.take(pairs.point, axis=0) - a
    edge_x, edge_y, to_x, to_y = edge[:, 0], edge[:, 1], to[:, 0], to[:, 1]
    squared_length = np.maximum(edge_x * edge_x + edge_y * edge_y, SMALLEST_LENGTH**2)
    parameter = np.minimum(np.maximum((to_x * edge_x + to_y * edge_y) / squared_length, 0.0), 1.0)
    left = np.where(edge_x * to_y >= edge_y * to_x, 1.0, -1.0)
    normal = to - parameter[:, None] * edge
    distance = np.sqrt(normal[:, 0] * normal[:, 0] + normal[:, 1] * normal[:, 1])
    if side is not None:
        distance[(left != side) & inside(parameter)] *= -1.0
    normal /= np.where(np.abs(distance) < SMALLEST_LENGTH, 1.0, distance)[:, None]
    return Contacts(distance, parameter, normal, left)


def inside(parameter: FloatArray) -> BoolArray:
    """Whether the closest point lies strictly between the ends of the edge."""
    return (parameter > 0.0) & (parameter < 1.0)


def constraint_rows(pairs: Pairs, contacts: Contacts, m: int) -> Rows:
    """The gradients of the distances with respect to the m cage vertices."""
    vertex = np.stack([pairs.point, pairs.start, pairs.end], axis=1)
    t = contacts.parameter
    weight = np.stack([np.ones(len(t)), t - 1.0, -t], axis=1)
    still = vertex >= m
    weight[still] = 0.0
    vertex[still] = 0
    return Rows(vertex, weight, contacts.normal)


def relevant(pairs: Pairs, contacts: Contacts, room: FloatArray, reach: FloatArray) -> BoolArray:
    """(K,) pairs that a motion can bring together and whose constraint no other pair repeats.

    room: (K,) distance minus wanted distance; reach: (m + n,) length that each vertex can move.
    """
    t = contacts.parameter
    approach = reach.take(pairs.point) + np.maximum(reach.take(pairs.start), reach.take(pairs.end))
    keep: BoolArray = room < approach
    # where two vertices are closest to each other the constraint is that of a fine vertex and the start of a cage edge
    keep[pairs.fine_cage] &= t[pairs.fine_cage] < 1.0
    keep[pairs.cage_fine] &= inside(t[pairs.cage_fine])
    return keep


def select(
    pairs: Pairs, contacts: Contacts, room: FloatArray, keep: BoolArray
) -> tuple[Pairs, Contacts, FloatArray]:
    """The pairs, contacts and room where ``keep`` (K,) is true."""
    return pairs.subset(keep), Contacts(*(part[keep] for part in contacts)), room[keep]


def not_implied(pairs: Pairs, contacts: Contacts, room: FloatArray, tolerance: float) -> BoolArray:
    """(K,) pairs whose constraints are not implied by others, up to ``tolerance`` (a length).

    All fine vertices on the inner side of a cage edge share its normal, so their constraints room + (1 - t) u + t v ≥ 0
    in the motions u, v of its two ends are implied by those on the lower convex hull of the points (t, room).
"""
    keep = np.ones(len(pairs), bool)
    family = pairs.fine_cage
    t = contacts.parameter
    inner = np.flatnonzero(inside(t[family]) & (contacts.side[family] > 0.0))
    if len(inner) < 3:
        return keep
    edge = pairs.start
    order = inner[np.lexsort((room[inner], t[inner], edge[inner]))]
    kept = _lower_hull(edge[order], t[order], room[order])
    if tolerance > 0.0:
        kept = kept[_thin(edge[order[kept]], t[order[kept]], room[order[kept]], tolerance)]
    keep[inner] = False
    keep[order[kept]] = True
    return keep


def _lower_hull(edge: IntArray, t: FloatArray, height: FloatArray) -> IntArray:
    """Indices of the points (t, height) on the lower convex hulls of their edges (all of them and possibly a few
    more)."""
    kept = np.arange(len(edge))
    for _ in range(HULL_PASSES):
        above = _above_neighbours(edge[kept], t[kept], height[kept], 0.0)
        if not above.any():
            break
        kept = kept[np.concatenate([[True], ~above, [True]])]
    return kept


def _thin(edge: IntArray, t: FloatArray, height: FloatArray, tolerance: float) -> IntArray:
    """Indices of enough points of convex chains that the others lie less than ``tolerance`` below their chords, per
    pass."""
    kept = np.arange(len(edge))
    for _ in range(THINNING_PASSES):
        close = _above_neighbours(edge[kept], t[kept], height[kept], tolerance)
        close[1::2] = False  # never two neighbours in one pass
        if not close.any():
            break
        kept = kept[np.concatenate([[True], ~close, [True]])]
    return kept


def _above_neighbours(edge: IntArray, t: FloatArray, height: FloatArray, tolerance: float) -> BoolArray:
    """(K - 2,) whether each inner point, raised by the tolerance, lies on or above the chord of its two neighbours on
    its edge."""
    if len(edge) < 3:
        return np.zeros(max(len(edge) - 2, 0), bool)
    before, after = t[1:-1] - t[:-2], t[2:] - t[1:-1]
    chord = height[:-2] * after + height[2:] * before
    above: BoolArray = (edge[:-2] == edge[2:]) & ((height[1:-1] + tolerance) * (before + after) >= chord)
    return above
