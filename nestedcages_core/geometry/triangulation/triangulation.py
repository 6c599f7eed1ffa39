"""Triangles that tile a solid: areas, where points are, and functions that are linear on each triangle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from ..arrays import FloatArray, IntArray
from ..broad_phase import BoxTree
from ..vectors import cross
from .constrained import opposite_edges

INSIDE_TOLERANCE = -1e-12
"""Smallest barycentric coordinate of a point inside a triangle, negative to allow for rounding."""

MAX_WALK = 3.0
"""Maximum number of triangles of a walk to a point, in √T; then all triangles are searched."""

CHUNK_TRIANGLES = 1_000_000
"""Pairs of points and triangles measured together; bounds the memory to about 200 MB."""


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Triangles of a solid; the first vertices are those of its mesh, the next lie on its edges, the rest inside."""

    vertices: FloatArray
    """(N, 2)."""
    triangles: IntArray
    """(T, 3) corners, counter-clockwise."""
    edge: IntArray
    """(B,) for each of the first B vertices, those on the boundary, the mesh vertex that its edge starts at."""
    end: IntArray
    """(B,) the mesh vertex that this edge ends at."""
    parameter: FloatArray
    """(B,) place on that edge: 0 at its start."""

    @property
    def on_boundary(self) -> int:
        """Number B of vertices on the boundary."""
        return len(self.edge)

    @property
    def inside(self) -> IntArray:
        """(N - B,) the vertices that are not on the boundary."""
        return np.arange(self.on_boundary, len(self.vertices))

    @cached_property
    def areas(self) -> FloatArray:
        """(T,) areas."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        return np.asarray(0.5 * cross(b - a, c - a))

    def boundary_values(self, mesh_vertices: int) -> scipy.sparse.csr_array:
        """(B, n) maps values at the n mesh vertices, linear along edges, to values at the boundary vertices."""
        row = np.tile(np.arange(self.on_boundary), 2)
        column = np.concatenate((self.edge, self.end))
        value = np.concatenate((1.0 - self.parameter, self.parameter))
        used = value != 0.0
        return scipy.sparse.csr_array((value[used], (row[used], column[used])), shape=(self.on_boundary, mesh_vertices))

    def stiffness(self) -> scipy.sparse.csr_array:
        """(N, N) the cotangent Laplacian: ∫ ∇φᵢ·∇φⱼ for the hat functions φ (Pinkall & Polthier 1993)."""
        opposite = [
            self.vertices[self.triangles[:, (k + 2) % 3]] - self.vertices[self.triangles[:, (k + 1) % 3]]
            for k in range(3)
        ]
        scale = 0.25 / self.areas
        entries = [(opposite[i] * opposite[j]).sum(axis=1) * scale for i in range(3) for j in range(3)]
        return self._assembled(np.concatenate(entries))

    def mass(self) -> scipy.sparse.csr_array:
        """(N, N) ∫ φᵢ φⱼ."""
        entries = [self.areas / (6.0 if i == j else 12.0) for i in range(3) for j in range(3)]
        return self._assembled(np.concatenate(entries))

    def interpolation(self, points: FloatArray) -> scipy.sparse.csr_array:
        """(P, N) maps values at the vertices, linear on each triangle, to values at (P, 2) points of the solid.

        Three entries per row, none negative, of sum 1. A point outside gets the values of a point on the boundary.
        """
        triangle, weights = self.locate(points)
        row = np.repeat(np.arange(len(points)), 3)
        column = self.triangles[triangle].ravel()
        used = weights.ravel() != 0.0
        shape = (len(points), len(self.vertices))
        return scipy.sparse.csr_array((weights.ravel()[used], (row[used], column[used])), shape=shape)

    def locate(self, points: FloatArray) -> tuple[IntArray, FloatArray]:
        """The triangle around each of (P, 2) points, (P,), and its barycentric coordinates, (P, 3)."""
        found = self._centres.closest(points).edge
        lost = self._walk(points, found)
        chunk = max(CHUNK_TRIANGLES // len(self.triangles), 1)
        for first in range(0, len(lost), chunk):
            some = lost[first : first + chunk]
            pairs = self._barycentric(points[some, None], np.arange(len(self.triangles))[None])
            found[some] = pairs.min(axis=2).argmax(axis=1)
        weights = np.maximum(self._barycentric(points, found), 0.0)
        weights /= weights.sum(axis=1, keepdims=True)
        # one step of iterative refinement, for thin triangles
        corners = self.vertices[self.triangles[found]]
        missed = points - (weights[:, :, None] * corners).sum(axis=1)
        refined = weights + self._barycentric(corners[:, 0] + missed, found) - (1.0, 0.0, 0.0)
        inside = refined.min(axis=1) >= 0.0
        weights[inside] = refined[inside]
        return found, weights

    def _walk(self, points: FloatArray, found: IntArray) -> IntArray:
        """Walk from triangle to triangle towards the points; returns the points (K,) whose walk ended elsewhere."""
        active = np.arange(len(points))
        hidden = [np.zeros(0, dtype=np.int64)]
        for _ in range(int(MAX_WALK * np.sqrt(len(self.triangles))) + 1):
            weights = self._barycentric(points[active], found[active])
            outside = weights.min(axis=1) < INSIDE_TOLERANCE
            active, weights = active[outside], weights[outside]
            if not len(active):
                break
            onward = self.neighbours[found[active]]
            choice = np.where((weights < INSIDE_TOLERANCE) & (onward >= 0), weights, np.inf)
            best = choice.argmin(axis=1)
            row = np.arange(len(active))
            open_ = np.isfinite(choice[row, best])
            hidden.append(active[~open_])
            found[active[open_]] = onward[row, best][open_]
            active = active[open_]
        return np.concatenate([*hidden, active])

    def _barycentric(self, points: FloatArray, triangle: IntArray) -> FloatArray:
        """Barycentric coordinates (..., 3) of points (..., 2) in triangles (...,)."""
        a, b, c = (self.vertices[self.triangles[triangle, k]] - points for k in range(3))
        weights = np.stack((cross(b, c), cross(c, a), cross(a, b)), axis=-1)
        return np.asarray(weights / weights.sum(axis=-1, keepdims=True))

    @cached_property
    def neighbours(self) -> IntArray:
        """(T, 3) the triangle across the edge opposite to each corner, -1 at the boundary."""
        across = opposite_edges(self.triangles, len(self.vertices)).reshape(3, -1)[[1, 2, 0]].T
        return np.where(across >= 0, across % len(self.triangles), -1)

    @cached_property
    def _centres(self) -> BoxTree:
        centres = self.vertices[self.triangles].mean(axis=1)
        return BoxTree(centres, centres)

    def _assembled(self, entries: FloatArray) -> scipy.sparse.csr_array:
        """(N, N) sums of entries (9T,), ordered by pairs of corners, then triangles."""
        row = np.concatenate([self.triangles[:, i] for i in range(3) for _ in range(3)])
        column = np.concatenate([self.triangles[:, j] for _ in range(3) for j in range(3)])
        return scipy.sparse.csr_array((entries, (row, column)), shape=(len(self.vertices),) * 2)
