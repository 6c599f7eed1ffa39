"""As rigid as possible: the cage bends and stretches as little as it can (Sacht et al. 2015, section 4.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.triangulation import triangulate
from ..geometry.vectors import cross
from .shape_matching import LocalFit, RotationFit, ShapeMatching, stiffness_of

CELL = np.array([0, 1, 2, 3])
"""First corners of the four edges of a boundary cell, whose corners are two vertices, the middle one and two more."""


@dataclass(frozen=True)
class BoundaryARAP:
    """½ L Σ min |z' - r p'|² over the curve: cells of a vertex, its spokes and the rims beyond, each with a rotation r.

    Edges weigh 1 / length, so that sums over them are integrals of strain along the curve, and each of the four cells
    that an edge is in has a quarter of it; L is the mean coarse edge length (Chao et al. 2010 for spokes and rims).
    """

    def at(self, coarse: Mesh) -> ShapeMatching:
        """The energy of a cage that rests as the coarse mesh."""
        return boundary_cells(coarse, RotationFit())


@dataclass(frozen=True)
class InteriorARAP:
    """½ Σ A |J - R|² over the triangles inside: A: area, J: linear map from rest to now, R: the nearest rotation.

    The triangles are the constrained Delaunay triangulation of the coarse mesh (Liu et al. 2008 for the energy).
    """

    def at(self, coarse: Mesh) -> ShapeMatching:
        """The energy of a cage that rests as the coarse mesh. Raises InvalidMeshError if that has no inside."""
        corners = triangulate(coarse).triangles
        stiffness = stiffness_of(3, *OPPOSITE, _cotangents(coarse, corners))
        return ShapeMatching.of(corners, coarse.vertices, stiffness, RotationFit())


OPPOSITE = (np.array([1, 2, 0]), np.array([2, 0, 1]))
"""First and second corner of the edge opposite to each corner of a triangle."""


def boundary_cells(coarse: Mesh, freedom: LocalFit) -> ShapeMatching:
    """ShapeMatching of four edges around every vertex."""
    before, after = coarse.predecessor, coarse.successor
    middle = np.arange(len(after))
    corners = np.stack([before[before], before, middle, after, after[after]], axis=1)
    lengths = coarse.edge_lengths
    weight = float(lengths.mean()) / (len(CELL) * lengths[corners[:, CELL]])
    return ShapeMatching.of(corners, coarse.vertices, stiffness_of(5, CELL, CELL + 1, weight), freedom)


def _cotangents(mesh: Mesh, corners: IntArray) -> FloatArray:
    """(T, 3) half the cotangent of the angle at each corner of triangles (T, 3)."""
    at = mesh.vertices[corners]
    one, other = at[:, OPPOSITE[0]] - at, at[:, OPPOSITE[1]] - at
    halves: FloatArray = 0.5 * (one * other).sum(axis=2) / cross(one, other)
    return halves
