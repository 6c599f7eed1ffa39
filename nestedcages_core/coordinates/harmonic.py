"""Coordinates that are never negative, for points inside the cage: harmonic ones, and those linear on its triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number
from ..geometry.triangulation import Sampling, Triangulation, triangulate
from ..geometry.vectors import format_point
from ..parameters import check_fraction
from .precision import CHUNK_ENTRIES, corrected

CHUNK_COLUMNS = 64
"""Cage vertices solved for together; bounds the memory in addition to the result."""


@dataclass(frozen=True)
class Harmonic:
    """Δh_i = 0 inside the cage, h_i on it the hat function of vertex i (Joshi et al. 2007), by linear finite elements.

    The elements are a constrained Delaunay triangulation, on which the discrete maximum principle holds.
    """

    spacing: float = 1.0 / 96.0
    """Maximum distance between points of the triangulation, as a fraction of the cage's diagonal, at most 1."""
    at_corners: float = 1.0 / 16.0
    """Spacing at the cage's vertices, where the coordinates bend most, as a fraction of that spacing or of the edge."""

    def __post_init__(self) -> None:
        check_fraction(self, "spacing", "at_corners")

    def weights(self, points: FloatArray, cage: Mesh) -> FloatArray:
        """Coordinates of points, never negative.

        Parameters
        ----------
        points : (P, 2) array
            In the cage or on it.
        cage : Mesh
            A cage of m vertices.

        Returns
        -------
        (P, m) array

        Raises
        ------
        NestedCagesError
            For a point outside the cage.
        """
        require_inside(points, cage)
        cage, points = _centred(cage, points)
        grid = triangulate(cage, Sampling(self.spacing * cage.diagonal, self.at_corners))
        weights = from_values(grid, grid.interpolation(points), len(cage.vertices))
        np.maximum(weights, 0.0, out=weights)
        chunk = max(CHUNK_ENTRIES // weights.shape[1], 1)
        for first in range(0, len(points), chunk):
            rows = slice(first, first + chunk)
            weights[rows] = corrected(weights[rows], points[rows], cage.vertices)
        return weights


def _centred(cage: Mesh, points: FloatArray) -> tuple[Mesh, FloatArray]:
    """Cage and points relative to the centre of the cage, where coordinates have most digits."""
    centre = 0.5 * (cage.vertices.min(axis=0) + cage.vertices.max(axis=0))
    return cage.moved(cage.vertices - centre).validated(), points - centre


def from_values(grid: Triangulation, operator: scipy.sparse.csr_array, corners: int) -> FloatArray:
    """(P, m) an operator (P, N) on what the m coordinates are at the N vertices of the grid."""
    boundary = grid.boundary_values(corners).tocsc()
    rim, inner = grid.on_boundary, len(grid.inside)
    stiffness = grid.stiffness().tocsc()
    stiff, coupling = stiffness[rim:, rim:].tocsc(), stiffness[rim:, :rim]
    factors = (
        scipy.sparse.linalg.splu(stiff, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}) if inner else None
    )
    on_rim, in_inner = operator.tocsc()[:, :rim], operator.tocsc()[:, rim:]
    values = np.empty((operator.shape[0], corners))
    for first in range(0, corners, CHUNK_COLUMNS):
        some = slice(first, first + CHUNK_COLUMNS)
        hats = boundary[:, some].toarray()
        inside = np.zeros((inner, hats.shape[1]))
        if factors is not None:
            load = -(coupling @ hats)
            inside = factors.solve(load)
            inside += factors.solve(load - stiff @ inside)
        values[:, some] = on_rim @ hats + in_inner @ inside
    return values


@dataclass(frozen=True)
class PiecewiseLinear:
    """Barycentric coordinates in the constrained Delaunay triangulation of the cage's own vertices."""

    def weights(self, points: FloatArray, cage: Mesh) -> scipy.sparse.csr_array:
        """Coordinates of points, three per point; see `Harmonic.weights`."""
        require_inside(points, cage)
        return triangulate(cage).interpolation(points)


def require_inside(points: FloatArray, cage: Mesh) -> None:
    """Raise NestedCagesError unless all (P, 2) points lie in the solid of the cage or on it, by exact predicates."""
    outside = np.flatnonzero(winding_number(points, cage.vertices, cage.vertices[cage.successor]) == 0)
    if len(outside):
        raise NestedCagesError(
            f"Point {outside[0]} at {format_point(points[outside[0]])} is outside the cage, where these coordinates "
            "are not defined; use a cage that encloses all points, or MeanValue().",
            code="coordinates.outside",
            vertex=outside[0],
            place=points[outside[0]],
        )
