"""Symmetric systems whose band is too wide for Cholesky factorisation on a single thread."""

from __future__ import annotations

import numpy as np
import scipy

from ..energies import Blocks
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.precision import INPUT_ROUND_OFF, NEGLIGIBLE
from .cholesky import Solve


def by_sparse_lu(band: FloatArray) -> Solve | None:
    """Solver of a system given by its band; None if it is not positive definite."""
    column, below = np.nonzero(band)
    row, value = column + below, band[column, below]
    off = below > 0
    places = np.concatenate([row, column[off]]), np.concatenate([column, row[off]])
    return _sparse_solver(np.concatenate([value, value[off]]), places, len(band))


def definite_solution(matrix: Blocks, right: FloatArray) -> FloatArray:
    """(m, 2) the solution of a positive definite system for a right side (m, 2).

    Entries may differ by many orders of magnitude. Where rounding made the matrix indefinite, the scaled right side is
    returned.
    """
    value, (row, column) = matrix.entries()
    diagonal = np.bincount(row, np.where(row == column, value, 0.0), right.size)
    # barrier stiffness across a gap of 1e-6 is 1e12 times that of the area
    scale = 1.0 / np.sqrt(np.maximum(diagonal, INPUT_ROUND_OFF * diagonal.max()))
    every = np.arange(right.size)
    solve = _sparse_solver(
        np.concatenate([value * scale[row] * scale[column], np.full(right.size, NEGLIGIBLE)]),
        (np.concatenate([row, every]), np.concatenate([column, every])),
        right.size,
    )
    scaled = scale * right.ravel()
    return np.asarray(scale * (scaled if solve is None else solve(scaled))).reshape(-1, 2)


def _sparse_solver(value: FloatArray, places: tuple[IntArray, IntArray], size: int) -> Solve | None:
    """LU factorisation without pivoting: the pivots are positive for positive definite matrices, and for no others."""
    matrix = scipy.sparse.csc_matrix((value, places), shape=(size, size))
    try:
        factors = scipy.sparse.linalg.splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:  # a zero pivot
        return None
    unpivoted = bool((factors.perm_r == factors.perm_c).all())
    return factors.solve if unpivoted and bool((factors.U.diagonal() > 0.0).all()) else None
