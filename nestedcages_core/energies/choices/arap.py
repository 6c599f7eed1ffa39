"""As rigid as possible: the cage stretches and bends little (Sacht et al. 2015, section 4.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.triangulation import triangulate
from ...geometry.vectors import cross
from ...parameters import check_not_negative
from ..area import Area
from ..weighted_sum import WeightedSum
from .shape_matching import LocalFit, ShapeMatching, edge_stiffness, rotation_fit, scale_fit


@dataclass(frozen=True)
class BoundaryARAP:
    """½ L Σ min |z' - r p'|² over cells along the curve: a vertex, its spokes and its rims, with a rotation r per cell.

    Edges weigh 1 / length, so that sums over them are integrals of strain along the curve, and an edge counts a quarter
    in each of its four cells. L is the mean coarse edge length (spokes and rims after Chao et al. 2010).
    """

    def at(self, coarse: Mesh) -> ShapeMatching:
        """The energy of a cage whose rest shape is the coarse mesh."""
        return boundary_cells(coarse, rotation_fit)


@dataclass(frozen=True)
class InteriorARAP:
    """½ Σ A |J - R|² over the triangles of the solid; A: area, J: linear map from rest, R: the nearest rotation.

    Triangles of the constrained Delaunay triangulation of the coarse mesh (energy after Liu et al. 2008).
    """

    def at(self, coarse: Mesh) -> ShapeMatching:
        """The energy of a cage whose rest shape is the coarse mesh. Raises InvalidMeshError if that has no inside."""
        corners = triangulate(coarse).triangles
        corner = np.arange(3)
        opposite = np.roll(corner, -1), np.roll(corner, 1)
        stiffness = edge_stiffness(3, *opposite, _half_cotangents(coarse, corners))
        return ShapeMatching.of(corners, coarse.vertices, stiffness, rotation_fit)


def boundary_cells(coarse: Mesh, local_fit: LocalFit) -> ShapeMatching:
    """Shape matching of cells of four edges around each vertex."""
    before, after = coarse.predecessor, coarse.successor
    middle = np.arange(len(after))
    corners = np.stack([before[before], before, middle, after, after[after]], axis=1)
    lengths = coarse.edge_lengths
    edge = np.arange(4)  # from each corner but the last to the next
    weight = float(lengths.mean()) / (len(edge) * lengths[corners[:, edge]])
    stiffness = edge_stiffness(5, edge, edge + 1, weight)
    return ShapeMatching.of(corners, coarse.vertices, stiffness, local_fit)


def _half_cotangents(mesh: Mesh, corners: IntArray) -> FloatArray:
    """(T, 3) half the cotangent of the angle at each corner of triangles (T, 3)."""
    at = mesh.vertices[corners]
    one, other = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
    halves: FloatArray = 0.5 * (one * other).sum(axis=2) / cross(one, other)
    return halves


@dataclass(frozen=True)
class ShapeKeeping:
    """Area + strength · ½ L Σ min |z' - s p'|² over the cells of `BoundaryARAP`, with a scale s per cell.

    Each part of the cage may scale, but not turn, at no cost. The area alone is indefinite and rounding decides to
    which side an edge rolls; this energy keeps a symmetric coarse mesh symmetric.
    """

    strength: float = 3.0
    """Weight relative to the area, at least 0. The default is the smallest that kept symmetric shapes symmetric
    (measured)."""

    def __post_init__(self) -> None:
        check_not_negative(self, "strength")

    def at(self, coarse: Mesh) -> WeightedSum:
        """The energy of a cage whose rest shape is the coarse mesh."""
        return WeightedSum(((1.0, Area()), (self.strength, boundary_cells(coarse, scale_fit))))
