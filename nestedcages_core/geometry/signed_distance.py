"""Signed distance to the solid that oriented closed loops bound: negative inside, with its gradient.

The sign comes from the exact winding number; a point within round-off of an edge is on the boundary.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .arrays import FloatArray, IntArray
from .broad_phase import BoxTree
from .distance import SMALLEST_LENGTH
from .mesh import Mesh
from .predicates import winding_number

BOUNDARY_TOLERANCE = 1e-14
"""Distance below which a point is on the boundary, as a fraction of the largest coordinate: about 50 roundings."""


class SignedSample(NamedTuple):
    """Signed distance of P points."""

    distance: FloatArray
    """(P,) length, negative inside the solid."""
    gradient: FloatArray
    """(P, 2) unit vector out of the solid; on the boundary itself the outward normal of the edge."""
    edge: IntArray
    """(P,) index of the nearest edge."""
    parameter: FloatArray
    """(P,) position of the closest point on that edge, in [0, 1]."""


class SignedDistance:
    """Signed distance to the solid bounded by (E, 2) oriented edges, solid on their left."""

    def __init__(
        self,
        starts: FloatArray,
        ends: FloatArray,
        outside: int = 0,
        tolerance: float = BOUNDARY_TOLERANCE,
    ) -> None:
        """outside: winding number of points outside the solid; 0 for meshes and outer loops, -1 for a hole alone.
        tolerance: distance, as a fraction of the largest coordinate, below which a point is on the boundary."""
        self.search = BoxTree(starts, ends)
        self.outside = outside
        self._touching = max(tolerance * float(np.abs(starts).max()), SMALLEST_LENGTH)

    @classmethod
    def of(cls, mesh: Mesh) -> SignedDistance:
        """Signed distance to the solid of a mesh; edge v starts at vertex v."""
        return cls(mesh.vertices, mesh.vertices[mesh.successor])

    def at(self, points: FloatArray) -> SignedSample:
        """Signed distance and gradient at (P, 2) points."""
        distance, edge, parameter = self.search.closest(points)
        starts, ends = self.search.starts.take(edge, axis=0), self.search.ends.take(edge, axis=0)
        away = points - (starts + parameter[:, None] * (ends - starts))
        touching = distance <= self._touching
        apart = (~touching).nonzero()[0]
        around = winding_number(points.take(apart, axis=0), self.search.starts, self.search.ends)
        sign = np.zeros(len(points))
        sign[apart] = np.where(around == self.outside, 1.0, -1.0)
        gradient = away * (sign / np.maximum(distance, SMALLEST_LENGTH))[:, None]
        if len(apart) < len(points):
            gradient[touching] = self._normals_at(edge[touching], parameter[touching])
        return SignedSample(sign * distance, gradient, edge, parameter)

    def _normals_at(self, edge: IntArray, parameter: FloatArray) -> FloatArray:
        """(K, 2) outward normals at places of edges (K,); at a vertex, that of the edge which starts there.

        Which of the two edges at a vertex is the closest one is a matter of round-off, and must not decide. Their mean
        would keep symmetries that are saddles of the area.
        """
        starts, ends = self.search.starts, self.search.ends
        length = np.hypot(*(ends[edge] - starts[edge]).T)
        at_end = np.nonzero((1.0 - parameter) * length <= self._touching)[0]
        if len(at_end):
            key = np.ascontiguousarray(starts).view(np.complex128)[:, 0]
            order = np.argsort(key)
            wanted = np.ascontiguousarray(ends[edge[at_end]]).view(np.complex128)[:, 0]
            edge = edge.copy()
            edge[at_end] = order[np.minimum(np.searchsorted(key, wanted, sorter=order), len(order) - 1)]
        direction = ends[edge] - starts[edge]
        length = np.maximum(np.hypot(direction[:, 0], direction[:, 1]), SMALLEST_LENGTH)
        normals: FloatArray = np.stack([direction[:, 1], -direction[:, 0]], axis=1) / length[:, None]
        return normals
