"""As rigid as possible: the cage stretches and bends little (Sacht et al. 2015, section 4.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.triangulation import triangulate
from ...geometry.vectors import cross
from .shape_matching import LocalFit, RotationFit, ShapeMatching, edge_stiffness

CELL_EDGES = np.array([0, 1, 2, 3])
"""First corners of the four edges of a boundary cell: two vertices, the middle one and two more."""

OPPOSITE = (np.array([1, 2, 0]), np.array([2, 0, 1]))
"""First and second corner of the edge opposite each corner of a triangle."""


@dataclass(frozen=True)
class BoundaryARAP:
    """½ L Σ min |z' - r p'|² over cells along the curve: a vertex, its spokes and its rims, with a rotation r per cell.

    Edges weigh 1 / length, so that sums over them are integrals of strain along the curve, and an edge counts a quarter
    in each of its four cells. L is the mean coarse edge length (spokes and rims after Chao et al. 2010).
    """

    def at(self, coarse: Mesh) -> ShapeMatching:
        """The energy of a cage whose rest shape is the coarse mesh."""
        return boundary_cells(coarse, RotationFit())


@dataclass(frozen=True)
class InteriorARAP:
    """½ Σ A |J - R|² over the triangles of the solid; A: area, J: linear map from rest, R: the nearest rotation.

    Triangles of the constrained Delaunay triangulation of the coarse mesh (energy after Liu et al. 2008).
    """

    def at(self, coarse: Mesh) -> ShapeMatching:
        """The energy of a cage whose rest shape is the coarse mesh. Raises InvalidMeshError if that has no inside."""
        corners = triangulate(coarse).triangles
        stiffness = edge_stiffness(3, *OPPOSITE, _half_cotangents(coarse, corners))
        return ShapeMatching.of(corners, coarse.vertices, stiffness, RotationFit())


def boundary_cells(coarse: Mesh, local_fit: LocalFit) -> ShapeMatching:
    """Shape matching of cells of four edges around each vertex."""
    before, after = coarse.predecessor, coarse.successor
    middle = np.arange(len(after))
    corners = np.stack([before[before], before, middle, after, after[after]], axis=1)
    lengths = coarse.edge_lengths
    weight = float(lengths.mean()) / (len(CELL_EDGES) * lengths[corners[:, CELL_EDGES]])
    stiffness = edge_stiffness(5, CELL_EDGES, CELL_EDGES + 1, weight)
    return ShapeMatching.of(corners, coarse.vertices, stiffness, local_fit)


def _half_cotangents(mesh: Mesh, corners: IntArray) -> FloatArray:
    """(T, 3) half the cotangent of the angle at each corner of triangles (T, 3)."""
    at = mesh.vertices[corners]
    one, other = at[:, OPPOSITE[0]] - at, at[:, OPPOSITE[1]] - at
    halves: FloatArray = 0.5 * (one * other).sum(axis=2) / cross(one, other)
    return halves
