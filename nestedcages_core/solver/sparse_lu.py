"""Symmetric systems whose band is too wide for Cholesky factorisation on a single thread."""

from __future__ import annotations

import numpy as np
import scipy

from ..geometry.arrays import FloatArray
from .cholesky import Solve


def by_sparse_lu(band: FloatArray) -> Solve | None:
    """LU factorisation without pivoting: the pivots are positive for positive definite matrices, and for no others."""
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
