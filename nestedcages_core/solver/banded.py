"""The linear systems of the interior-point method, W + Jᵀ diag(h) J + diag(b) over the vertices of a cage, in a band.

W comes as 2 × 2 blocks over vertices and every constraint row touches at most three vertices, nearly always neighbours
on a loop. Numbered by reverse Cuthill-McKee, a loop becomes a band of two vertices on either side of the diagonal, and
Cholesky's factorisation stays within the band (Golub & Van Loan, Matrix Computations, section 4.3): some microseconds
for a hundred unknowns. Contacts between distant parts of the cage widen the band as far as need be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dpbtrf, dpbtrs
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from .._types import FloatArray, IntArray
from ..energies import Blocks


@dataclass(frozen=True, eq=False)
class Rows:
    """K constraint rows J: row k times D is Σ_j weight[k, j] direction[k] · D[vertex[k, j]]."""

    vertex: IntArray
    """(K, 3) indices of vertices; where the weight is zero, one that the row names elsewhere."""
    weight: FloatArray
    """(K, 3)."""
    direction: FloatArray
    """(K, 2)."""

    def __len__(self) -> int:
        return len(self.vertex)

    def entries(self) -> FloatArray:
        """(K, 6) the entries of the rows, vertex by vertex, x before y."""
        return (self.weight[:, :, None] * self.direction[:, None, :]).reshape(-1, 6)


@dataclass(frozen=True, eq=False)
class BandOrder:
    """A numbering of m vertices that keeps those close together that a matrix couples."""

    position: IntArray
    """(m,) place of every vertex."""
    spread: int
    """Largest difference of the places of two coupled vertices."""

    @classmethod
    def of(cls, count: int, row: IntArray, column: IntArray) -> BandOrder:
        """Reverse Cuthill-McKee order of the graph whose edges join row[k] and column[k]."""
        ends = np.concatenate([row, column]), np.concatenate([column, row])
        graph = csr_array((np.ones(2 * len(row)), ends), shape=(count, count))
        position = np.empty(count, np.int64)
        position[reverse_cuthill_mckee(graph, symmetric_mode=True)] = np.arange(count)
        return cls(position, int(np.abs(position[row] - position[column]).max(initial=0)))

    def including(self, hessian: Blocks, rows: Rows) -> BandOrder:
        """This order if its band holds the couplings of both, else one made for them."""
        position = self.position
        places = position[rows.vertex]
        apart = int(np.abs(position[hessian.row] - position[hessian.column]).max(initial=0))
        if len(rows):
            apart = max(apart, int((places.max(axis=1) - places.min(axis=1)).max()))
        if apart <= self.spread:
            return self
        p, a, b = rows.vertex.T
        return BandOrder.of(
            len(position), np.concatenate([hessian.row, p, a, p]), np.concatenate([hessian.column, a, b, b])
        )  # fmt: skip


class BandedSystem:
    """W and J over 2m unknowns, x before y within a vertex, the vertices in the band's order."""

    def __init__(self, order: BandOrder, hessian: Blocks, rows: Rows) -> None:
        size, K = 2 * len(order.position), len(rows)
        height = 2 * order.spread + 2  # diagonals stored: the main one and 2 spread + 1 below
        self._shape = size, height

        row = 2 * order.position[hessian.row][:, None, None] + _ROW_OF_BLOCK
        column = 2 * order.position[hessian.column][:, None, None] + _COLUMN_OF_BLOCK
        # a block above the diagonal is stored as its transpose; of one on the diagonal only the lower triangle counts
        place = _place(np.maximum(row, column), np.minimum(row, column), height)
        value = np.where((hessian.row == hessian.column)[:, None, None] & _UPPER_OF_BLOCK, 0.0, hessian.value)
        self._W = np.bincount(place.ravel(), value.ravel(), size * height)

        entries = rows.entries()
        unknown = (2 * order.position[rows.vertex][:, :, None] + np.arange(2)).reshape(-1, 6).astype(np.int32)
        pointer = np.arange(0, 6 * K + 1, 6, dtype=np.int32)
        self._J = csr_array((entries.ravel(), unknown.ravel(), pointer), shape=(K, size))
        self._J_transposed = csc_array((entries.ravel(), unknown.ravel(), pointer), shape=(size, K))
        # the products of the entries of each row, by which h is multiplied to give the band of Jᵀ diag(h) J
        i, j = unknown[:, _FIRST], unknown[:, _SECOND]
        products = entries[:, _FIRST] * entries[:, _SECOND]
        place = _place(np.maximum(i, j), np.minimum(i, j), height)
        pointer = np.arange(0, products.size + 1, products.shape[1], dtype=np.int32)
        self._products = csc_array((products.ravel(), place.ravel(), pointer), shape=(size * height, K))

    def rows_times(self, d: FloatArray) -> FloatArray:
        """J d, (K,)."""
        product: FloatArray = self._J @ d
        return product

    def transposed_times(self, z: FloatArray) -> FloatArray:
        """Jᵀ z, (2m,)."""
        product: FloatArray = self._J_transposed @ z
        return product

    def set_matrix(self, h: FloatArray, diagonal: FloatArray) -> None:
        """Assemble W + Jᵀ diag(h) J + diag(diagonal)."""
        band: FloatArray = self._products @ h
        band += self._W
        self._band = band.reshape(self._shape)
        self._diagonal = self._band[:, 0] + diagonal

    def factorise(self, shift: float) -> bool:
        """Factorise the matrix plus shift times the identity; whether it is positive definite."""
        self._band[:, 0] = self._diagonal + shift
        self._factor, failure = dpbtrf(self._band.T, lower=1)
        return bool(failure == 0)

    def solve(self, b: FloatArray) -> FloatArray:
        """Solution (2m,) of the factorised system."""
        x: FloatArray = dpbtrs(self._factor, b, lower=1)[0]
        return x


_ROW_OF_BLOCK = np.array([[0, 0], [1, 1]])
_COLUMN_OF_BLOCK = np.array([[0, 1], [0, 1]])
_UPPER_OF_BLOCK = np.array([[False, True], [False, False]])
_FIRST, _SECOND = np.triu_indices(6)


def _place(row: IntArray, column: IntArray, height: int) -> IntArray:
    """Index of an entry of the lower triangle in the band, which is stored column by column."""
    place: IntArray = column * (height - 1) + row
    return place
