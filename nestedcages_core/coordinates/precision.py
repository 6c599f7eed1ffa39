"""Linear precision to the last digits: small corrections such that W @ cage = points."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray

CHUNK_ENTRIES = 1_000_000
"""Entries of W computed or corrected together; bounds the memory to about 200 MB."""

CORRECTIONS = 2
"""Number of corrections: the first for the error of the method, the second for its own rounding."""

RANK_TOLERANCE = 1e-13
"""Eigenvalues of a row's moments below this fraction of the largest are not inverted: the corners look collinear."""


def corrected(weights: FloatArray, points: FloatArray, corners: FloatArray) -> FloatArray:
    """Weights (P, m), changed as little as possible so that rows sum to 1 and weights @ corners = points.

    points: (P, 2); corners: (m, 2). Row entries change by W_i (α + β·(c_i − p)), measured by |W_i|, so that zeros stay
    zeros and, as the change is tiny, signs stay signs.
    """
    size = float(np.abs(corners - corners.mean(axis=0)).max())
    for _ in range(CORRECTIONS):
        weights = weights / weights.sum(axis=1, keepdims=True)
        away_x = (corners[:, 0] - points[:, :1]) / size
        away_y = (corners[:, 1] - points[:, 1:]) / size
        measure = np.abs(weights)
        # normal equations of the least change: second moments of the corners seen from each point
        basis = (measure, measure * away_x, measure * away_y)
        moments = np.empty((len(points), 3, 3))
        for i, first in enumerate(basis):
            for j, second in enumerate((None, away_x, away_y)):
                moments[:, i, j] = (first if second is None else first * second).sum(axis=1)
        missed = -np.stack(((weights * away_x).sum(axis=1), (weights * away_y).sum(axis=1)), axis=1)
        change = np.zeros((len(points), 3))
        change[:, 1:] = missed
        solution = (np.linalg.pinv(moments, rcond=RANK_TOLERANCE, hermitian=True) @ change[:, :, None])[:, :, 0]
        weights = weights + sum(solution[:, k, None] * basis[k] for k in range(3))
    return np.asarray(weights)
