"""Harmonic coordinates: never negative inside, however concave the cage and whatever its holes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import splu

from .._types import FloatArray
from ..mesh import Mesh
from ..triangulation import Sampling, triangulate
from .inside import require_inside
from .precision import corrected

COLUMNS_AT_ONCE = 64
"""Cage vertices solved for at once; bounds the memory beside the result."""

ROWS_AT_ONCE = 1_000_000
"""Entries of W corrected at once; bounds the memory to about 200 MB."""


@dataclass(frozen=True)
class Harmonic:
    """Δh_i = 0 inside the cage, h_i on it the hat function of vertex i (Joshi et al. 2007), by linear finite elements.

    The elements are a constrained Delaunay triangulation, on which the discrete maximum principle holds.
    """

    spacing: float = 1.0 / 96.0
    """Greatest distance between points of the triangulation, as a share of the cage's diagonal."""
    at_corners: float = 1.0 / 16.0
    """Spacing at the cage's vertices, where the coordinates bend most, as a share of that spacing or of the edge."""

    def weights(self, points: FloatArray, cage: Mesh) -> FloatArray:
        """W (P, m), never negative. Raises NestedCagesError for a point outside the cage."""
        require_inside(points, cage)
        low, high = cage.vertices.min(axis=0), cage.vertices.max(axis=0)
        centre = 0.5 * (low + high)
        cage = cage.moved(cage.vertices - centre).validated()
        points = points - centre
        grid = triangulate(cage, Sampling(self.spacing * cage.diagonal, self.at_corners))
        boundary = grid.boundary_values(len(cage.vertices)).tocsc()
        at_points = grid.interpolation(points).tocsc()
        rim, inner = grid.on_boundary, len(grid.inside)
        on_rim, in_inner = at_points[:, :rim], at_points[:, rim:]
        stiffness = grid.stiffness().tocsc()
        stiff, coupling = stiffness[rim:, rim:].tocsc(), stiffness[rim:, :rim]
        factors = splu(stiff, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}) if inner else None
        weights = np.empty((len(points), len(cage.vertices)))
        for first in range(0, len(cage.vertices), COLUMNS_AT_ONCE):
            some = slice(first, first + COLUMNS_AT_ONCE)
            hats = boundary[:, some].toarray()
            weights[:, some] = on_rim @ hats
            if factors is not None:
                load = -(coupling @ hats)
                inside = factors.solve(load)
                inside += factors.solve(load - stiff @ inside)
                weights[:, some] += in_inner @ inside
        np.maximum(weights, 0.0, out=weights)
        chunk = max(ROWS_AT_ONCE // weights.shape[1], 1)
        for first in range(0, len(points), chunk):
            rows = slice(first, first + chunk)
            weights[rows] = corrected(weights[rows], points[rows], cage.vertices)
        return weights
