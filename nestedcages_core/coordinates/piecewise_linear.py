"""Linear on the triangles of the cage: three weights per point, none negative; creases where triangles meet."""

from __future__ import annotations

from dataclasses import dataclass

from scipy.sparse import csr_array

from .._types import FloatArray
from ..mesh import Mesh
from ..triangulation import triangulate
from .inside import require_inside


@dataclass(frozen=True)
class PiecewiseLinear:
    """Barycentric coordinates in the constrained Delaunay triangulation of the cage's own vertices."""

    def weights(self, points: FloatArray, cage: Mesh) -> csr_array:
        """W (P, m), sparse. Raises NestedCagesError for a point outside the cage."""
        require_inside(points, cage)
        return triangulate(cage).interpolation(points)
