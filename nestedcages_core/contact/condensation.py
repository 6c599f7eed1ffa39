"""Static condensation: the Newton system in all positions (C; F), reduced to the cage.

The fine vertices are eliminated, since only pairs with a fine edge couple them to each other. That coupling is lumped
onto the diagonal blocks, an upper bound by (u + w)² ≤ 2 u² + 2 w², so the matrix stays positive definite and the result
is a descent direction. What remains is a Schur complement in the 2 m unknowns of the cage.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg.lapack
import scipy.sparse as sp
import scipy.sparse.linalg

from ..energies import Blocks
from ..geometry.arrays import FloatArray, IntArray

DENSE_CAGE_VERTICES = 150
"""Number of cage vertices up to which a dense Cholesky factorisation is faster than a sparse LU (measured)."""

DENSE_COUPLING_ENTRIES = 1_000_000
"""Number of entries up to which a dense matrix for the coupling of fine mesh and cage is faster (measured)."""

REGULARISATION = 1e-6
"""Added to the cage's diagonal, for energies that leave a motion free. The Hessian of the area is of order 1."""

ROUNDING_SHIFT = 1e-14
"""First shift of the unit diagonal of a system that rounding has made indefinite; also the smallest relative pivot."""

ROUNDING_SHIFT_GROWTH = 100.0
"""Factor to the next shift."""

MAX_FACTORISATIONS = 10
"""Cap on the shifts: the last one is 1e2 times the diagonal."""

Solve = Callable[[FloatArray], FloatArray]


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
    coupling = _matrix(row[mixed] - 2 * m, column[mixed], entries[mixed], (2 * len(touched), 2 * m))
    weighted = _block_product(inverse, coupling)
    pull = gradient[touched].ravel()
    right = weighted.T @ pull - gradient[:m].ravel()
    motion[:m] = _cage_solver(row[own], column[own], entries[own], cage, m, coupling, weighted)(right).reshape(m, 2)

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


def _matrix(row: IntArray, column: IntArray, values: FloatArray, shape: tuple[int, int]) -> FloatArray | sp.csr_matrix:
    """The matrix with these entries, duplicates summed; dense if small."""
    if shape[0] * shape[1] <= DENSE_COUPLING_ENTRIES:
        return np.bincount(row * shape[1] + column, values, shape[0] * shape[1]).reshape(shape)
    return sp.csr_matrix((values, (row, column)), shape=shape)


def _block_product(blocks: FloatArray, matrix: FloatArray | sp.csr_matrix) -> FloatArray | sp.csr_matrix:
    """Block-diagonal matrix of blocks (k, 2, 2) times a matrix (2 k, c)."""
    count = len(blocks)
    if isinstance(matrix, np.ndarray):
        return np.matmul(blocks, matrix.reshape(count, 2, matrix.shape[1])).reshape(matrix.shape)
    diagonal = sp.bsr_matrix((blocks, np.arange(count), np.arange(count + 1)), shape=(2 * count, 2 * count))
    return (diagonal @ matrix).tocsr()


def _cage_solver(
    row: IntArray,
    column: IntArray,
    values: FloatArray,
    cage: Blocks,
    m: int,
    coupling: FloatArray | sp.csr_matrix,
    weighted: FloatArray | sp.csr_matrix,
) -> Solve:
    """Solver for the Schur complement plus the blocks of the cage."""
    size = 2 * m
    condensed = coupling.T @ weighted
    if m <= DENSE_CAGE_VERTICES:
        matrix = np.bincount(row * size + column, values, size * size).reshape(size, size) + cage.dense(m)
        matrix -= condensed if isinstance(condensed, np.ndarray) else condensed.toarray()
        matrix.flat[:: size + 1] += REGULARISATION
        scale = _equal_diagonals(matrix.diagonal())
        solve = _dense_solver(scale[:, None] * matrix * scale)
    else:
        sparse = sp.csc_matrix((values, (row, column)), shape=(size, size)) + cage.sparse(m) - condensed
        sparse = sp.csc_matrix(sparse + REGULARISATION * sp.identity(size))
        scale = _equal_diagonals(sparse.diagonal())
        solve = _sparse_solver((sp.diags(scale) @ sparse @ sp.diags(scale)).tocsc())
    return lambda right: scale * solve(scale * right)


def _equal_diagonals(diagonal: FloatArray) -> FloatArray:
    """Scaling to a unit diagonal: barrier stiffness across a gap of 1e-6 is 1e12 times that of the area."""
    scale: FloatArray = 1.0 / np.sqrt(np.maximum(diagonal, ROUNDING_SHIFT * diagonal.max()))
    return scale


def _dense_solver(matrix: FloatArray) -> Solve:
    """Solver by Cholesky factorisation of a matrix with unit diagonal, shifted until it succeeds."""
    shift = 0.0
    for _ in range(MAX_FACTORISATIONS):
        factor, failed = scipy.linalg.lapack.dpotrf(matrix, lower=1)
        if not failed:
            return lambda right: np.asarray(scipy.linalg.lapack.dpotrs(factor, right, lower=1)[0])
        grown = max(ROUNDING_SHIFT_GROWTH * shift, ROUNDING_SHIFT)
        matrix.flat[:: len(matrix) + 1] += grown - shift
        shift = grown
    return np.copy  # the unit diagonal alone still gives a descent direction


def _sparse_solver(matrix: sp.csc_matrix) -> Solve:
    """Solver by LU factorisation of a sparse matrix with unit diagonal; the shift avoids zero pivots."""
    definite = matrix + ROUNDING_SHIFT * sp.identity(matrix.shape[0], format="csc")
    factor = scipy.sparse.linalg.splu(
        definite, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return lambda right: np.asarray(factor.solve(right))


def _inverse_2x2(blocks: FloatArray) -> FloatArray:
    """Inverses of positive definite matrices (k, 2, 2), with determinants bounded away from 0 against cancellation."""
    a, b, c, d = blocks[:, 0, 0], blocks[:, 0, 1], blocks[:, 1, 0], blocks[:, 1, 1]
    inverse = np.empty_like(blocks)
    inverse[:, 0, 0], inverse[:, 0, 1], inverse[:, 1, 0], inverse[:, 1, 1] = d, -b, -c, a
    inverse /= np.maximum(a * d - b * c, ROUNDING_SHIFT * a * d)[:, None, None]
    return inverse
