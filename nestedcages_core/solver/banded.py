"""The linear systems of the interior-point method, W + Aᵀ diag(h) A over the vertices of a cage, in a band.

W comes as 2 × 2 blocks over vertices and every constraint row touches at most three vertices, nearly always neighbours
on a loop. Numbered by reverse Cuthill-McKee, a loop becomes a band of two vertices on either side of the diagonal, and
Cholesky's factorisation stays within the band (Golub & Van Loan, Matrix Computations, section 4.3): some microseconds
for a hundred unknowns. Contacts between distant parts of the cage widen the band as far as need be.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.linalg.lapack import dpbtrf, dpbtrs
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from .._types import FloatArray, IntArray
from ..energies import Blocks


@dataclass(frozen=True, eq=False)
class Rows:
    """K constraint rows over w vertices each: row k times D is Σ_j weight[j, k] direction[:, k] · D[vertex[j, k]]."""

    vertex: IntArray
    """(w, K) indices of vertices, distinct within a row."""
    weight: FloatArray
    """(w, K)."""
    direction: FloatArray
    """(2, K)."""

    @property
    def count(self) -> int:
        """Number of rows."""
        return self.vertex.shape[1]

    def entries(self) -> FloatArray:
        """(2w, K) the entries of the rows, vertex by vertex, x before y."""
        return (self.weight[:, None, :] * self.direction[None, :, :]).reshape(2 * len(self.vertex), self.count)

    def coupled(self) -> tuple[IntArray, IntArray]:
        """Pairs of vertices that one row names, the first with each other."""
        return np.tile(self.vertex[0], len(self.vertex) - 1), self.vertex[1:].ravel()


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
        position = np.empty(count, np.int32)
        position[reverse_cuthill_mckee(graph, symmetric_mode=True)] = np.arange(count)
        order = cls(position.astype(np.int64), 0)
        return cls(order.position, order.distance(row, column))

    def distance(self, row: IntArray, column: IntArray) -> int:
        """Largest distance in this order between row[k] and column[k]."""
        return int(np.abs(self.position[row] - self.position[column]).max(initial=0))

    def including(self, hessian: Blocks, rows: Sequence[Rows]) -> BandOrder:
        """This order if its band holds the couplings of both, else one made for them."""
        couplings = [(hessian.row, hessian.column), *(group.coupled() for group in rows)]
        if all(self.distance(*pair) <= self.spread for pair in couplings):
            return self
        # the first of three vertices with the other two, and these with each other
        couplings += [(group.vertex[1], group.vertex[2]) for group in rows if len(group.vertex) > 2]
        row, column = (np.concatenate(side) for side in zip(*couplings, strict=True))
        return BandOrder.of(len(self.position), row, column)


class BandedSystem:
    """W and all constraints over 2m unknowns, x before y within a vertex, the vertices in the band's order.

    The constraints are A = (J; R; -R): the rows J, then lower and upper bounds of the motion of every vertex along two
    axes of its own, given as ``axes`` (m, 2, 2): vertex, axis, component.
    """

    def __init__(self, order: BandOrder, hessian: Blocks, rows: Sequence[Rows], axes: FloatArray) -> None:
        size = 2 * len(order.position)
        height = 2 * order.spread + 2  # diagonals stored: the main one and 2 spread + 1 below
        self._shape = size, height

        row = 2 * order.position[hessian.row][:, None, None] + _AXES[:, None]
        column = 2 * order.position[hessian.column][:, None, None] + _AXES
        # a block above the diagonal is stored as its transpose; of one on the diagonal only the lower triangle counts
        value = hessian.value.copy()
        value[hessian.row == hessian.column, 0, 1] = 0.0
        self._W = np.bincount(_place(row, column, height).ravel(), value.ravel(), size * height)

        # the entries of A, and the products of the entries of each row, by which h is multiplied for Aᵀ diag(h) A
        matrix, products = _SparseRows(), _SparseRows()
        for group in rows:
            unknown = (2 * order.position[group.vertex][:, None, :] + _AXES[:, None]).reshape(2 * len(group.vertex), -1)
            matrix.add(unknown, group.entries())
            products.add(*_products(unknown, group.entries(), height))
        turned = np.empty((size // 2, 2, 2))
        turned[order.position] = axes
        entries = turned.reshape(size, 2).T
        unknown = np.repeat(np.arange(0, size, 2), 2) + _AXES[:, None]
        for sign in (1.0, -1.0):
            matrix.add(unknown, sign * entries)
            products.add(*_products(unknown, entries, height))
        self._A = csr_array(matrix.parts(), shape=(matrix.count, size))
        self._A_transposed = csc_array(matrix.parts(), shape=(size, matrix.count))
        self._products = csc_array(products.parts(), shape=(size * height, matrix.count))

    def constraints(self, d: FloatArray) -> FloatArray:
        """A d, (K + 4m,)."""
        product: FloatArray = self._A @ d
        return product

    def transposed(self, z: FloatArray) -> FloatArray:
        """Aᵀ z, (2m,)."""
        product: FloatArray = self._A_transposed @ z
        return product

    def set_matrix(self, h: FloatArray) -> None:
        """Assemble W + Aᵀ diag(h) A."""
        band: FloatArray = self._products @ h
        band += self._W
        self._band = band.reshape(self._shape)
        self._diagonal = self._band[:, 0].copy()

    def factorise(self, shift: float) -> bool:
        """Factorise the matrix plus shift times the identity; whether it is positive definite."""
        self._band[:, 0] = self._diagonal + shift
        self._factor, failure = dpbtrf(self._band.T, lower=1)
        return bool(failure == 0)

    def solve(self, b: FloatArray) -> FloatArray:
        """Solution (2m,) of the factorised system."""
        x: FloatArray = dpbtrs(self._factor, b, lower=1)[0]
        return x


_AXES = np.array([0, 1])


class _SparseRows:
    """Compressed sparse rows, put together from groups of rows that have equally many entries."""

    def __init__(self) -> None:
        self.count = 0
        self._filled = 0
        self._data: list[FloatArray] = []
        self._indices: list[IntArray] = []
        self._ends: list[IntArray] = [np.zeros(1, np.int64)]

    def add(self, indices: IntArray, data: FloatArray) -> None:
        """Add rows with the entries (length, K) at the columns ``indices``."""
        length, count = indices.shape
        self._data.append(data.T.ravel())
        self._indices.append(indices.T.ravel())
        self._ends.append(self._filled + length * np.arange(1, count + 1))
        self.count += count
        self._filled += length * count

    def parts(self) -> tuple[FloatArray, IntArray, IntArray]:
        """Entries, their columns, and where the rows begin."""
        indices, ends = np.concatenate(self._indices), np.concatenate(self._ends)
        return np.concatenate(self._data), indices.astype(np.int32), ends.astype(np.int32)


@cache
def _triangle(size: int) -> tuple[IntArray, IntArray]:
    """Rows and columns of the upper triangle of a matrix."""
    return np.triu_indices(size)


def _products(unknown: IntArray, entries: FloatArray, height: int) -> tuple[IntArray, FloatArray]:
    """Places in the band and values of the products of the entries (length, K) of each row at the unknowns named."""
    first, second = _triangle(len(entries))
    return _place(unknown[first], unknown[second], height), entries[first] * entries[second]


def _place(row: IntArray, column: IntArray, height: int) -> IntArray:
    """Index of an entry, or of its mirror image, in the band, which stores the lower triangle column by column."""
    place: IntArray = np.minimum(row, column) * (height - 1) + np.maximum(row, column)
    return place
