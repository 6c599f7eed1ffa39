"""Distance between points and edges, with its gradient and what its Hessian is made of, in closed form.

The six degrees of freedom of a point-edge pair are ordered (p, a, b): the point, the start and the end of the edge, x
before y. With the unit normal n from the edge to the point, the unit tangent τ from a to b, the edge length L and the
parameter t of the closest point, clamped to [0, 1], the derivatives need only the coefficients c = (1, -(1 - t), -t):

    ∂d = c ⊗ n,
    ∂²d = -(c_t qᵀ + q c_tᵀ) - d q qᵀ   in the interior of the edge, with c_t = c ⊗ τ, q = (0, -n, n) / L,
    ∂²d = (c ⊗ τ)(c ⊗ τ)ᵀ / d            where an end point is closest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray
from .vectors import dot

SMALLEST_LENGTH = 1e-150
"""Length in input units below which a distance or an edge counts as zero; its square is still a normal float64."""


class PointEdge(NamedTuple):
    """Closest point of each of K edges to its point."""

    distance: FloatArray
    """(K,) length ≥ 0."""
    parameter: FloatArray
    """(K,) position of the closest point on the edge, 0 at its start, 1 at its end."""
    normal: FloatArray
    """(K, 2) unit vector from the closest point to the point (zero where the distance is zero)."""
    length: FloatArray
    """(K,) length of the edge."""

    def take(self, keep: BoolArray | IntArray) -> PointEdge:
        """The pairs where ``keep`` (K,) is true, or at these indices."""
        return PointEdge(*(field[keep] for field in self))


def point_edge(p: FloatArray, a: FloatArray, b: FloatArray) -> PointEdge:
    """Distance from points p to edges a-b; arrays (..., 2) that broadcast against each other.

    The result's arrays have the broadcast shape (K stands for it); ``normal`` has a last axis of 2.
    """
    edge_x, edge_y = b[..., 0] - a[..., 0], b[..., 1] - a[..., 1]
    to_x, to_y = p[..., 0] - a[..., 0], p[..., 1] - a[..., 1]
    squared_length = np.maximum(edge_x * edge_x + edge_y * edge_y, SMALLEST_LENGTH**2)
    parameter = np.minimum(np.maximum((to_x * edge_x + to_y * edge_y) / squared_length, 0.0), 1.0)
    to_x = to_x - parameter * edge_x
    to_y = to_y - parameter * edge_y
    distance = np.sqrt(to_x * to_x + to_y * to_y)
    inverse = 1.0 / np.maximum(distance, SMALLEST_LENGTH)
    normal = np.empty((*distance.shape, 2))
    np.multiply(to_x, inverse, out=normal[..., 0])
    np.multiply(to_y, inverse, out=normal[..., 1])
    return PointEdge(distance, parameter, normal, np.sqrt(squared_length))


def coefficients(pairs: PointEdge) -> FloatArray:
    """(K, 3) weights c = (1, -(1 - t), -t) of (p, a, b) in the gradient of the distance."""
    c = np.empty((len(pairs.parameter), 3))
    c[:, 0] = 1.0
    np.subtract(pairs.parameter, 1.0, out=c[:, 1])
    np.negative(pairs.parameter, out=c[:, 2])
    return c


def tangents(pairs: PointEdge, a: FloatArray, b: FloatArray) -> FloatArray:
    """(K, 2) unit tangents: along the edge in its interior, perpendicular to the normal where an end point is
    closest."""
    tangent: FloatArray = np.stack([-pairs.normal[:, 1], pairs.normal[:, 0]], axis=1)
    backwards = dot(b - a, tangent) < 0.0
    tangent[backwards] *= -1.0
    return tangent


def interior(pairs: PointEdge) -> BoolArray:
    """(K,) whether the closest point lies strictly between the two ends of the edge."""
    return (pairs.parameter > 0.0) & (pairs.parameter < 1.0)


def distance_gradient(pairs: PointEdge) -> FloatArray:
    """(K, 6) gradient ∂d = c ⊗ n of the distances with respect to (p, a, b)."""
    gradient: FloatArray = (coefficients(pairs)[:, :, None] * pairs.normal[:, None, :]).reshape(-1, 6)
    return gradient


def bending(pairs: PointEdge) -> FloatArray:
    """(K, 6) vectors q = (0, -n, n) / L: the rate at which a motion turns the edge."""
    q = np.zeros((len(pairs.distance), 3, 2))
    np.divide(pairs.normal, pairs.length[:, None], out=q[:, 2])
    np.negative(q[:, 2], out=q[:, 1])
    return q.reshape(-1, 6)
