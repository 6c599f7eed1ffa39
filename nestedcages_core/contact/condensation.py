"""Static condensation: a system in all positions (C; F) reduced to one in the cage alone.

Fine vertices are coupled to the cage but hardly to each other, so they are eliminated. Their block of the Hessian is
made block-diagonal from above (for a pair with two fine vertices, (u + w)² ≤ 2 u² + 2 w²), so the matrix stays positive
definite and the direction a descent direction. What is left is a Schur complement in the 2 m unknowns of the cage.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg.lapack
import scipy.sparse as sp
import scipy.sparse.linalg

from ..energies import Blocks
from ..geometry.arrays import FloatArray, IntArray

DENSE_LIMIT = 150
"""Number of cage vertices up to which a dense Cholesky factorisation is faster than a sparse one (measured)."""

DENSE_COUPLING = 1_000_000
"""Number of entries up to which the coupling of fine vertices and cage is kept as a dense array (measured)."""

REGULARISATION = 1e-6
"""Added to the cage's diagonal: keeps the system definite when an energy leaves a motion free (that of area is 1)."""

SMALLEST_SHIFT = 1e-14
"""First shift of a system's unit diagonal that rounding has made indefinite."""

SHIFT_GROWTH = 100.0
"""Factor on a shift that was too small."""

MAX_SHIFTS = 10
"""Cap on the shifts tried: the last is 1e4 times the diagonal."""

Solve = Callable[[FloatArray], FloatArray]


def newton_direction(
    corners: IntArray, factors: FloatArray, restoring: FloatArray, cage: Blocks, gradient: FloatArray
) -> FloatArray:
    """-H⁻¹ gradient, an array (m + n, 2), for H = Σ Uᵀ U over the pairs + the restoring diagonal + the cage's blocks.

    corners: (K, 3) indices of each pair's vertices into (C; F); factors: (K, 3, 6) the pairs' U; restoring: (n,)
    stiffness of the pull on each fine vertex, > 0; cage: positive semi-definite blocks over the cage's m vertices;
    gradient: (m + n, 2).
    """
    n = len(restoring)
    m = len(gradient) - n
    motion = np.empty_like(gradient)
    # fine vertices without a pair feel only their pull
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
    """(k, 2, 2) diagonal blocks of the fine vertices with pairs, lumped as the module's docstring says."""
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
    """The matrix with these entries, which add up where they meet: dense while that is small."""
    if shape[0] * shape[1] <= DENSE_COUPLING:
        return np.bincount(row * shape[1] + column, values, shape[0] * shape[1]).reshape(shape)
    return sp.csr_matrix((values, (row, column)), shape=shape)


def _block_product(blocks: FloatArray, matrix: FloatArray | sp.csr_matrix) -> FloatArray | sp.csr_matrix:
    """The block-diagonal matrix of (k, 2, 2) blocks times a matrix (2 k, c)."""
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
    """Solver of the Schur complement with the cage's own blocks added."""
    size = 2 * m
    condensed = coupling.T @ weighted
    if m <= DENSE_LIMIT:
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
    """Scaling to a unit diagonal: pressures across a gap of 1e-6 are 1e12 times those of the area, and both matter."""
    scale: FloatArray = 1.0 / np.sqrt(np.maximum(diagonal, SMALLEST_SHIFT * diagonal.max()))
    return scale


def _dense_solver(matrix: FloatArray) -> Solve:
    """Solver of a system with a unit diagonal by Cholesky factorisation, shifted until rounding leaves it definite."""
    shift = 0.0
    for _ in range(MAX_SHIFTS):
        factor, failed = scipy.linalg.lapack.dpotrf(matrix, lower=1)
        if not failed:
            return lambda right: np.asarray(scipy.linalg.lapack.dpotrs(factor, right, lower=1)[0])
        grown = max(SHIFT_GROWTH * shift, SMALLEST_SHIFT)
        matrix.flat[:: len(matrix) + 1] += grown - shift
        shift = grown
    return np.copy  # the diagonal alone: a descent direction whatever the rest is


def _sparse_solver(matrix: sp.csc_matrix) -> Solve:
    """The same for a sparse matrix, by LU factorisation, which needs the shift only to stay away from zero pivots."""
    definite = matrix + SMALLEST_SHIFT * sp.identity(matrix.shape[0], format="csc")
    factor = scipy.sparse.linalg.splu(
        definite, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return lambda right: np.asarray(factor.solve(right))


def _inverse_2x2(blocks: FloatArray) -> FloatArray:
    """Inverses of (k, 2, 2) positive definite matrices; where rounding cancelled a determinant, of ones close by."""
    a, b, c, d = blocks[:, 0, 0], blocks[:, 0, 1], blocks[:, 1, 0], blocks[:, 1, 1]
    inverse = np.empty_like(blocks)
    inverse[:, 0, 0], inverse[:, 0, 1], inverse[:, 1, 0], inverse[:, 1, 1] = d, -b, -c, a
    inverse /= np.maximum(a * d - b * c, SMALLEST_SHIFT * a * d)[:, None, None]
    return inverse
