"""Contacts as linear constraints on the motion of the cage.

To first order a motion D changes the distance of a point p to the edge a-b by n · (D_p - (1 - t) D_a - t D_b), with the
unit normal n from the edge to the point and the parameter t of the closest point.

Where an end of the edge is closest, this is the distance between two vertices, and the constraint would stop them from
sliding past each other. It is used only where each vertex lies in the normal cone of the other. At reflex corners, seen
from the point, the distance to the line of the edge is exact and replaces it: a cage vertex then slides along the fine
edges of a pocket without stopping at their ends. Elsewhere an edge of the corner is closer, and the pair is dropped.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.distance import SMALLEST_LENGTH
from ..geometry.vectors import column_cross, column_dot
from ..solver.banded import Rows
from .pairs import Bodies, Pairs

OVERSHOOT = 1.02
"""Factor on motions that restore distances or bounds: it makes up for what is not linear, so that passes end
(docs/numbers.md: overshoot of restoration)."""


class Contacts(NamedTuple):
    """Signed distances of K pairs, with what their derivatives need."""

    distance: FloatArray
    """(K,) negative where the point is on the wrong side of the edge."""
    parameter: FloatArray
    """(K,) position t of the closest point on the edge, or on its line."""
    normal: FloatArray
    """(K, 2) gradient of the signed distance with respect to the point."""
    side: FloatArray
    """(K,) side of the edge that the point is on: 1 left, -1 right, 0 beyond its ends."""
    on_line: BoolArray
    """(K,) whether the distance is to the line of the edge, not to one of its ends."""

    def take(self, keep: BoolArray | IntArray) -> Contacts:
        """The contacts where ``keep`` (K,) is true, or at these indices."""
        kept = np.flatnonzero(keep) if keep.dtype == bool else keep
        distance, parameter, normal, side, on_line = self
        return Contacts(
            distance.take(kept),
            parameter.take(kept),
            normal.T.take(kept, axis=1).T,
            side.take(kept),
            on_line.take(kept),
        )


def measure(pairs: Pairs, x: FloatArray, side: FloatArray | None = None) -> Contacts:
    """Distances of the pairs at x (m + n, 2); negative where a point is not on its ``side`` (K,) of the edge."""
    columns = np.ascontiguousarray(x.T)  # arrays (2, K) are faster than (K, 2)
    a = columns.take(pairs.start, axis=1)
    edge = columns.take(pairs.end, axis=1) - a
    to = columns.take(pairs.point, axis=1) - a
    squared_length = np.maximum(column_dot(edge, edge), SMALLEST_LENGTH**2)
    along = column_dot(to, edge)
    along /= squared_length
    parameter = np.minimum(np.maximum(along, 0.0), 1.0)
    on_line = along == parameter
    left = np.copysign(on_line, column_cross(edge, to))
    edge *= parameter
    to -= edge
    distance = np.sqrt(column_dot(to, to))
    normal = np.divide(to, np.maximum(distance, SMALLEST_LENGTH), out=to)
    if side is not None:
        wrong = left * side < 0.0
        np.negative(distance, out=distance, where=wrong)
        np.negative(normal, out=normal, where=wrong)
    return Contacts(distance, parameter, normal.T, left, on_line)


def constraint_rows(pairs: Pairs, contacts: Contacts) -> tuple[Rows, Rows, Rows]:
    """Gradients of the distances with respect to the cage vertices, family by family."""
    t, normal = contacts.parameter, contacts.normal.T
    fc, cf, cc = pairs.fine_cage, pairs.cage_fine, pairs.cage_cage
    vertex = np.concatenate([pairs.point, pairs.start, pairs.end]).reshape(3, -1)
    weight = np.ones(vertex.shape)
    np.subtract(t, 1.0, out=weight[1])
    np.negative(t, out=weight[2])
    return (
        Rows(vertex[1:, fc], weight[1:, fc], normal[:, fc]),
        Rows(vertex[:1, cf], weight[:1, cf], normal[:, cf]),
        Rows(vertex[:, cc], weight[:, cc], normal[:, cc]),
    )


def distance_change(pairs: Pairs, contacts: Contacts, motion: FloatArray) -> FloatArray:
    """(K,) first-order change of the distances under a motion (m + n, 2)."""
    t = contacts.parameter[:, None]
    relative = motion.take(pairs.point, axis=0) - (1.0 - t) * motion.take(pairs.start, axis=0)
    relative -= t * motion.take(pairs.end, axis=0)
    out: FloatArray = (contacts.normal * relative).sum(axis=1)
    return out


def local_axes(bodies: Bodies, x: FloatArray) -> FloatArray:
    """(m, 2, 2) unit vectors along and across the cage at each cage vertex of x (m + n, 2)."""
    columns = x[: bodies.m].T
    along = columns.take(bodies.cage.successor, axis=1) - columns.take(bodies.cage.predecessor, axis=1)
    length = np.hypot(along[0], along[1])
    short = np.flatnonzero(length <= SMALLEST_LENGTH)
    along[0, short], along[1, short], length[short] = 1.0, 0.0, 1.0
    along /= length
    axes = np.empty((bodies.m, 2, 2))
    axes[:, 0, 0] = axes[:, 1, 1] = along[0]
    axes[:, 0, 1] = along[1]
    np.negative(along[1], out=axes[:, 1, 0])
    return axes


def resolve_corners(
    bodies: Bodies, pairs: Pairs, contacts: Contacts, x: FloatArray, least: float
) -> tuple[Pairs, Contacts]:
    """The active pairs at x (m + n, 2), with the distance to the line of the edge where the module says so.

    least: smallest distance to the line on the correct side for it to be used.
    """
    ends = np.flatnonzero(~contacts.on_line[: pairs.cage_cage.start])
    if len(ends) == 0:
        return pairs, contacts
    columns = np.ascontiguousarray(x.T)
    # fine vertices are left of cage edges, cage vertices right of fine edges
    inner = np.ones(len(ends))
    cage_edges = int(ends.searchsorted(pairs.cage_fine.start))
    inner[cage_edges:] = -1.0
    at_start = contacts.parameter.take(ends) <= 0.0
    start, end, point = pairs.start.take(ends), pairs.end.take(ends), pairs.point.take(ends)
    corner = np.where(at_start, start, end)
    a = columns.take(start, axis=1)
    edge, to = columns.take(end, axis=1) - a, columns.take(point, axis=1) - a
    length = np.hypot(edge[0], edge[1])
    offset = inner * column_cross(edge, to)
    offset /= length
    before, after = _edges_at(bodies, columns, corner)
    exact = (inner * column_cross(before, after) > 0.0) & (offset >= least)
    lone = np.flatnonzero(at_start[:cage_edges] & ~exact[:cage_edges])
    lone = lone[_in_corner(bodies, columns, corner.take(lone), point.take(lone))]
    lone = lone[_in_corner(bodies, columns, point.take(lone), corner.take(lone))]

    line = np.flatnonzero(exact)
    put = ends.take(line)
    keep = contacts.on_line.copy()
    keep[pairs.cage_cage] = True  # cage against cage: which side of a corner the point is on is unknown
    keep[put] = True
    keep[ends.take(lone)] = True
    kept = np.flatnonzero(keep)
    resolved = contacts.take(kept)
    place = kept.searchsorted(put)
    resolved.distance[place] = offset.take(line)
    resolved.on_line[place] = True
    resolved.side[place] = side = inner.take(line)
    turned = side / length.take(line)
    edge = edge.take(line, axis=1)
    resolved.normal[place, 0], resolved.normal[place, 1] = -turned * edge[1], turned * edge[0]
    # the lever arm of a cage edge is measured on its line; a fine edge, which may be short, keeps its end
    turning = line[: int(line.searchsorted(cage_edges))]
    arm = column_dot(to.take(turning, axis=1), edge[:, : len(turning)])
    resolved.parameter[place[: len(turning)]] = arm / length.take(turning) ** 2
    return pairs.take(kept), resolved


def _in_corner(bodies: Bodies, columns: FloatArray, corner: IntArray, point: IntArray) -> BoolArray:
    """Whether each corner vertex is the closest point of both its edges to ``point``; columns: (2, m + n)."""
    to = columns.take(point, axis=1) - columns.take(corner, axis=1)
    before, after = _edges_at(bodies, columns, corner)
    inside: BoolArray = (column_dot(to, before) >= 0.0) & (column_dot(to, after) <= 0.0)
    return inside


def _edges_at(bodies: Bodies, columns: FloatArray, corner: IntArray) -> tuple[FloatArray, FloatArray]:
    """Vectors (2, K) along the edges that end and that start in the corners (K,)."""
    at = columns.take(corner, axis=1)
    before = at - columns.take(bodies.predecessor.take(corner), axis=1)
    return before, columns.take(bodies.successor.take(corner), axis=1) - at
