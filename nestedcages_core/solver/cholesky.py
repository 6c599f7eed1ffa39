"""Cholesky factorisation within a band (Golub & Van Loan, Matrix Computations, section 4.3)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..geometry.arrays import FloatArray
from ..lapack import dpbtrf, dpbtrs

Solve = Callable[[FloatArray], FloatArray]
"""From a right side (size,) to the solution (size,)."""


def within_band(band: FloatArray) -> Solve | None:
    """Solver of the system; None if the matrix is not positive definite."""
    factor, failure = dpbtrf(band.T, lower=1)
    if failure or not np.isfinite(factor[0]).all():  # LAPACK lets NaN pass
        return None
    return lambda right: np.asarray(dpbtrs(factor, right, lower=1)[0])
