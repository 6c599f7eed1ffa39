"""The linear systems of the interior-point method: W + Jᵀ diag(h) J + diag(b) over the vertices of a cage.

W comes as 2 × 2 blocks over vertices and every constraint row touches at most three vertices, so the matrix is nearly
that of a set of rings. Few unknowns are solved by a dense Cholesky factorisation. More are numbered by reverse
Cuthill-McKee, which turns a ring into a band of two vertices, and factorised within the band (Golub & Van Loan, Matrix
Computations, section 4.3).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.linalg.lapack import dpbtrf, dpbtrs, dpotrf, dpotrs
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from .._types import FloatArray, IntArray
from ..energies import Blocks

DENSE_VERTICES = 100
"""Number of vertices up to which the dense factorisation is faster than the banded one (measured)."""


@dataclass(frozen=True, eq=False)
class Rows:
    """K constraint rows J: row k times D is Σ_j weight[k, j] direction[k] · D[vertex[k, j]].

    The vertices of a row are distinct wherever their weight is not zero.
    """

    vertex: IntArray
    """(K, 3) indices of vertices; any index where the weight is zero."""
    weight: FloatArray
    """(K, 3)."""
    direction: FloatArray
    """(K, 2)."""

    def __len__(self) -> int:
        return len(self.vertex)

    def entries(self) -> FloatArray:
        """(K, 6) the entries of the rows, vertex by vertex, x before y."""
        return (self.weight[:, :, None] * self.direction[:, None, :]).reshape(-1, 6)

    def unknowns(self) -> IntArray:
        """(K, 6) the columns of the entries."""
        return (2 * self.vertex[:, :, None] + np.arange(2)).reshape(-1, 6)

    def dense(self, count: int) -> FloatArray:
        """The (K, 2 count) matrix J."""
        matrix = np.zeros((len(self), 2 * count))
        index = (np.arange(len(self)) * (2 * count))[:, None] + self.unknowns()
        entries = self.entries()
        flat = matrix.reshape(-1)
        for first in (0, 2, 4):  # within one vertex of each row no index repeats
            flat[index[:, first : first + 2]] += entries[:, first : first + 2]
        return matrix


class NormalEquations(Protocol):
    """W and J in a form that can be multiplied and factorised."""

    def hessian_times(self, d: FloatArray) -> FloatArray:
        """W d, (2m,)."""
        ...

    def rows_times(self, d: FloatArray) -> FloatArray:
        """J d, (K,)."""
        ...

    def transposed_times(self, z: FloatArray) -> FloatArray:
        """Jᵀ z, (2m,)."""
        ...

    def set_matrix(self, h: FloatArray, diagonal: FloatArray) -> None:
        """Assemble W + Jᵀ diag(h) J + diag(diagonal)."""
        ...

    def factorise(self, shift: float) -> bool:
        """Factorise the matrix plus shift times the identity; whether it is positive definite."""
        ...

    def solve(self, b: FloatArray) -> FloatArray:
        """Solution (2m,) of the factorised system."""
        ...


def normal_equations(hessian: Blocks, rows: Rows, count: int) -> NormalEquations:
    """The form that suits the number of vertices."""
    return DenseEquations(hessian, rows, count) if count <= DENSE_VERTICES else BandedEquations(hessian, rows, count)


class DenseEquations:
    """Full matrices."""

    def __init__(self, hessian: Blocks, rows: Rows, count: int) -> None:
        self._W = hessian.dense(count)
        self._J = rows.dense(count)
        self._M = self._W
        self._diagonal: FloatArray = np.zeros(2 * count)

    def hessian_times(self, d: FloatArray) -> FloatArray:
        return self._W @ d

    def rows_times(self, d: FloatArray) -> FloatArray:
        return self._J @ d

    def transposed_times(self, z: FloatArray) -> FloatArray:
        return z @ self._J

    def set_matrix(self, h: FloatArray, diagonal: FloatArray) -> None:
        scaled = self._J * np.sqrt(h)[:, None]
        self._M = scaled.T @ scaled
        self._M += self._W
        self._diagonal = self._M.ravel()[:: len(self._M) + 1] + diagonal

    def factorise(self, shift: float) -> bool:
        self._M.ravel()[:: len(self._M) + 1] = self._diagonal + shift
        self._factor, failure = dpotrf(self._M, lower=0, clean=0)
        return bool(failure == 0)

    def solve(self, b: FloatArray) -> FloatArray:
        x: FloatArray = dpotrs(self._factor, b, lower=0)[0]
        return x


class BandedEquations:
    """Matrices within a band, their vertices numbered by reverse Cuthill-McKee."""

    def __init__(self, hessian: Blocks, rows: Rows, count: int) -> None:
        self._size = 2 * count
        used = rows.weight != 0.0
        position = _band_order(hessian, rows.vertex, used, count)
        self._unknown = (2 * position[:, None] + np.arange(2)).ravel()  # place of every unknown in the band's order
        ends = np.where(used, position[rows.vertex], position[rows.vertex[:, :1]])
        spread = int(np.ptp(ends, axis=1).max()) if len(rows) else 0
        if len(hessian.row):
            spread = max(spread, int(np.abs(position[hessian.row] - position[hessian.column]).max()))
        self._height = 2 * spread + 2  # diagonals stored: the main one and 2 spread + 1 below

        # W in the band, and as a product
        row, column, value = self._hessian_entries(hessian)
        self._W = csr_array((value, (row, column)), shape=(self._size, self._size))
        low = row >= column
        place = self._place(row[low], column[low])
        self._W_band = np.bincount(place, value[low], self._size * self._height)

        # J, its transpose, and the map from h to the band of Jᵀ diag(h) J
        entries, K = rows.entries(), len(rows)
        unknowns = (2 * ends[:, :, None] + np.arange(2)).reshape(-1, 6)
        pointer = np.arange(0, 6 * K + 1, 6)
        self._J = csr_array((entries.ravel(), unknowns.ravel(), pointer), shape=(K, self._size))
        self._J_transposed = csc_array((entries.ravel(), unknowns.ravel(), pointer), shape=(self._size, K))
        first, second = np.triu_indices(6)
        i, j = unknowns[:, first], unknowns[:, second]
        products = entries[:, first] * entries[:, second]
        self._products = csc_array(
            (products.ravel(), self._place(np.maximum(i, j), np.minimum(i, j)).ravel(), np.arange(0, 21 * K + 1, 21)),
            shape=(self._size * self._height, K),
        )

    def _hessian_entries(self, hessian: Blocks) -> tuple[IntArray, IntArray, FloatArray]:
        """Row, column and value of all entries of W, both triangles, in the band's order."""
        row = self._unknown.reshape(-1, 2)[hessian.row][:, :, None] + np.zeros((1, 1, 2), np.int64)
        column = self._unknown.reshape(-1, 2)[hessian.column][:, None, :] + np.zeros((1, 2, 1), np.int64)
        other = hessian.row != hessian.column
        return (
            np.concatenate([row.ravel(), column[other].ravel()]),
            np.concatenate([column.ravel(), row[other].ravel()]),
            np.concatenate([hessian.value.ravel(), hessian.value[other].ravel()]),
        )

    def _place(self, row: IntArray, column: IntArray) -> IntArray:
        """Index of an entry of the lower triangle in the band, stored column by column."""
        place: IntArray = column * (self._height - 1) + row
        return place

    def hessian_times(self, d: FloatArray) -> FloatArray:
        return self._from_band(self._W @ self._to_band(d))

    def rows_times(self, d: FloatArray) -> FloatArray:
        product: FloatArray = self._J @ self._to_band(d)
        return product

    def transposed_times(self, z: FloatArray) -> FloatArray:
        return self._from_band(self._J_transposed @ z)

    def set_matrix(self, h: FloatArray, diagonal: FloatArray) -> None:
        self._M = (self._W_band + self._products @ h).reshape(self._size, self._height)
        self._diagonal = self._M[:, 0] + self._to_band(diagonal)

    def factorise(self, shift: float) -> bool:
        self._M[:, 0] = self._diagonal + shift
        self._factor, failure = dpbtrf(self._M.T, lower=1)
        return bool(failure == 0)

    def solve(self, b: FloatArray) -> FloatArray:
        return self._from_band(dpbtrs(self._factor, self._to_band(b), lower=1)[0])

    def _to_band(self, d: FloatArray) -> FloatArray:
        ordered = np.empty(self._size)
        ordered[self._unknown] = d
        return ordered

    def _from_band(self, ordered: FloatArray) -> FloatArray:
        return ordered.take(self._unknown)


def _band_order(hessian: Blocks, vertex: IntArray, used: np.ndarray, count: int) -> IntArray:  # type: ignore[type-arg]
    """(count,) position of every vertex in reverse Cuthill-McKee order of the graph that W and J draw."""
    chained = used[:, [0, 1]] & used[:, [1, 2]]
    outer = used[:, 0] & used[:, 2]
    row = np.concatenate([hessian.row, vertex[:, 0][chained[:, 0]], vertex[:, 1][chained[:, 1]], vertex[:, 0][outer]])
    column = np.concatenate(
        [hessian.column, vertex[:, 1][chained[:, 0]], vertex[:, 2][chained[:, 1]], vertex[:, 2][outer]]
    )
    graph = csr_array((np.ones(len(row)), (row, column)), shape=(count, count))
    order = reverse_cuthill_mckee((graph + graph.T).tocsr(), symmetric_mode=True)
    position = np.empty(count, np.int64)
    position[order] = np.arange(count)
    return position
