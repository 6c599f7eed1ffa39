"""Symmetric systems whose band is too wide for one Cholesky factorisation on a single thread."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray
from ..lapack import dtbtrs
from .cholesky import Solve, cholesky, within_band


def in_two_blocks(band: FloatArray) -> Solve | None:
    """Block Cholesky factorisation: of the first half of the rows, then of what it leaves of the others."""
    size, height = band.shape
    row, cut = np.arange(size)[:, None], size // 2
    full = np.zeros((size, size + height))
    full[row, row + np.arange(height)] = band  # the upper triangle

    def as_band(square: FloatArray) -> FloatArray:
        own = row[: len(square)]
        rows: FloatArray = np.hstack([square, np.zeros_like(square)])[own, own + own.T]
        return rows

    first = cholesky(as_band(full[:cut, :cut]))
    if first is None:
        return None
    coupling = dtbtrs(first, full[:cut, cut:size], uplo="L")[0]
    second = within_band(as_band(full[cut:, cut:size] - coupling.T @ coupling))
    if second is None:
        return None

    def solution(right: FloatArray) -> FloatArray:
        before = dtbtrs(first, right[:cut], uplo="L")[0]
        after = second(right[cut:] - coupling.T @ before)
        return np.concatenate([dtbtrs(first, before - coupling @ after, uplo="L", trans="T")[0], after])

    return solution


def sparse(band: FloatArray) -> Solve | None:
    """LU factorisation without pivoting: the pivots are positive for positive definite matrices, and for no others."""
    import scipy

    size = len(band)
    column, below = np.nonzero(band)
    row, value = column + below, band[column, below]
    off = below > 0
    places = np.concatenate([row, column[off]]), np.concatenate([column, row[off]])
    matrix = scipy.sparse.csc_matrix((np.concatenate([value, value[off]]), places), shape=(size, size))
    try:
        factors = scipy.sparse.linalg.splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:  # a zero pivot
        return None
    unpivoted = bool((factors.perm_r == factors.perm_c).all())
    return factors.solve if unpivoted and bool((factors.U.diagonal() > 0.0).all()) else None
