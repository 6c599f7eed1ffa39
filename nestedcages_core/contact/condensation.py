"""Static condensation: the Newton system in all positions (C; F), reduced to the cage.

The fine vertices are eliminated, since only pairs with a fine edge couple them to each other. That coupling is lumped
onto the diagonal blocks, an upper bound by (u + w)² ≤ 2 u² + 2 w², so the matrix stays positive definite and the result
is a descent direction. What remains is a Schur complement in the 2 m unknowns of the cage.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.lib.stride_tricks import sliding_window_view

from ..energies import Blocks
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.precision import INPUT_ROUND_OFF, NEGLIGIBLE
from ..solver.banded import BandOrder, factorised
from ..solver.cholesky import Solve


def newton_direction(
    corners: IntArray, factors: FloatArray, restoring: FloatArray, cage: Blocks, gradient: FloatArray
) -> FloatArray:
    """-H⁻¹ gradient, (m + n, 2), for H = Σ Uᵀ U over the pairs + restoring diagonal + blocks of the cage.

    corners: (K, 3) indices of the vertices of each pair into (C; F); factors: (K, 3, 6) U of each pair; restoring: (n,)
    stiffness > 0 of each fine vertex; cage: positive semi-definite Hessian over the m cage vertices; gradient:
    (m + n, 2).
    """
    n = len(restoring)
    m = len(gradient) - n
    motion = np.empty_like(gradient)
    # fine vertices without a pair are decoupled
    touched = np.unique(corners[corners >= m])
    local = np.zeros(m + n, np.int64)
    local[touched] = m + np.arange(len(touched))
    local[:m] = np.arange(m)
    places = local[corners]

    entries = np.matmul(factors.transpose(0, 2, 1), factors)
    dof = (2 * places[:, :, None] + np.arange(2)).reshape(-1, 6)
    row = np.broadcast_to(dof[:, :, None], entries.shape)
    column = np.broadcast_to(dof[:, None, :], entries.shape)
    in_cage = column < 2 * m
    own = in_cage & (row < 2 * m)
    mixed = in_cage & (row >= 2 * m)

    inverse = _inverse_2x2(_fine_blocks(entries, places, m, restoring[touched - m]))
    # a dense product of this length would depend on the number of threads of the BLAS
    coupling = scipy.sparse.csr_matrix(
        (entries[mixed], (row[mixed] - 2 * m, column[mixed])), shape=(2 * len(touched), 2 * m)
    )
    weighted = _block_diagonal(inverse) @ coupling
    pull = gradient[touched].ravel()
    right = weighted.T @ pull - gradient[:m].ravel()
    condensed = (coupling.T @ weighted).tocoo()
    energy, (energy_row, energy_column) = cage.entries()
    solve = _cage_solver(
        m,
        np.concatenate([entries[own], energy, -condensed.data]),
        np.concatenate([row[own], energy_row, condensed.row]),
        np.concatenate([column[own], energy_column, condensed.col]),
    )
    motion[:m] = solve(right).reshape(m, 2)

    motion[m:] = -gradient[m:] / restoring[:, None]
    rest = (pull + coupling @ motion[:m].ravel()).reshape(-1, 2, 1)
    motion[touched] = -np.matmul(inverse, rest)[:, :, 0]
    return motion


def _fine_blocks(entries: FloatArray, places: IntArray, m: int, restoring: FloatArray) -> FloatArray:
    """(k, 2, 2) diagonal blocks of the fine vertices with pairs, couplings between them lumped."""
    count = len(restoring)
    blocks = np.zeros((count, 2, 2))
    blocks[:, 0, 0] = blocks[:, 1, 1] = restoring
    for corner, share in ((0, 1.0), (1, 2.0), (2, 2.0)):
        fine = np.flatnonzero(places[:, corner] >= m)
        vertex = places[fine, corner] - m
        for i, j in ((0, 0), (0, 1), (1, 1)):
            values = entries[fine, 2 * corner + i, 2 * corner + j]
            blocks[:, i, j] += share * np.bincount(vertex, values, count)
    blocks[:, 1, 0] = blocks[:, 0, 1]
    return blocks


def _block_diagonal(blocks: FloatArray) -> scipy.sparse.bsr_matrix:
    """The block-diagonal matrix of blocks (k, 2, 2)."""
    count = len(blocks)
    return scipy.sparse.bsr_matrix((blocks, np.arange(count), np.arange(count + 1)), shape=(2 * count, 2 * count))


def _cage_solver(m: int, entries: FloatArray, row: IntArray, column: IntArray) -> Solve:
    """Solver for the symmetric matrix (2 m, 2 m) with these entries; those at the same place add up."""
    coupled = (row > column) & (row % 2 == 0) & (column % 2 == 0)
    order = BandOrder.of(m, row[coupled] // 2, column[coupled] // 2)
    place = (2 * order.position[:, None] + np.arange(2)).ravel()
    row, column = place[row], place[column]
    lower = row >= column
    size, height = 2 * m, 2 * order.bandwidth + 2
    sums = np.bincount((column * height + row - column)[lower], entries[lower], size * height)
    band: FloatArray = sums.astype(np.float64, copy=False).reshape(size, height)  # integers where there are no entries
    band[:, 0] += NEGLIGIBLE
    scale = _equal_diagonals(band[:, 0])
    beyond = np.concatenate([scale, np.zeros(height)])  # the band has places below the last row
    band *= scale[:, None] * sliding_window_view(beyond, height)[:size]
    # where rounding made it indefinite, the unit diagonal gives a descent direction
    solve = factorised(band) or np.copy

    def solution(right: FloatArray) -> FloatArray:
        ordered = np.empty(size)
        ordered[place] = right
        return np.asarray((scale * solve(scale * ordered))[place])

    return solution


def _equal_diagonals(diagonal: FloatArray) -> FloatArray:
    """Scaling to a unit diagonal: barrier stiffness across a gap of 1e-6 is 1e12 times that of the area."""
    scale: FloatArray = 1.0 / np.sqrt(np.maximum(diagonal, INPUT_ROUND_OFF * diagonal.max()))
    return scale


def _inverse_2x2(blocks: FloatArray) -> FloatArray:
    """Inverses of positive definite matrices (k, 2, 2), with determinants bounded away from 0 against cancellation."""
    a, b, c, d = blocks[:, 0, 0], blocks[:, 0, 1], blocks[:, 1, 0], blocks[:, 1, 1]
    inverse = np.empty_like(blocks)
    inverse[:, 0, 0], inverse[:, 0, 1], inverse[:, 1, 0], inverse[:, 1, 1] = d, -b, -c, a
    inverse /= np.maximum(a * d - b * c, INPUT_ROUND_OFF * a * d)[:, None, None]
    return inverse
