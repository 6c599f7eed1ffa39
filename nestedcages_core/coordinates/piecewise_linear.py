"""Linear on the triangles of the cage: three weights per point, none negative; creases where triangles meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.triangulation import triangulate
from .inside import require_inside


@dataclass(frozen=True)
class PiecewiseLinear:
    """Barycentric coordinates in the constrained Delaunay triangulation of the cage's own vertices."""

    def weights(self, points: FloatArray, cage: Mesh) -> scipy.sparse.csr_array:
        """W (P, m), sparse. Raises NestedCagesError for a point outside the cage."""
        require_inside(points, cage)
        return triangulate(cage).interpolation(points)

    def gradients(self, points: FloatArray, cage: Mesh) -> FloatArray:
        """(P, m, 2) slopes of the coordinates, constant on each triangle. Raises NestedCagesError as `weights`."""
        require_inside(points, cage)
        slopes = triangulate(cage).differentiation(points)
        return np.stack([slope.toarray() for slope in slopes], axis=2)
