"""Banded linear systems W + Aᵀ diag(h) A over the vertices of a cage, for the interior-point method.

W has 2 × 2 blocks over vertices, and each constraint row touches at most three vertices, mostly neighbours on a loop.
In reverse Cuthill-McKee order a loop is a band of two vertices on either side of the diagonal, and Cholesky
factorisation stays within the band (Golub & Van Loan, Matrix Computations, section 4.3). Contacts between distant parts
of the cage widen it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
import scipy

from ..energies import Blocks
from ..geometry.arrays import FloatArray, IntArray
from .definite import Solve, factorised


@dataclass(frozen=True, eq=False)
class Rows:
    """K constraint rows over w vertices each: row k times D is Σ_j weight[j, k] direction[:, k] · D[vertex[j, k]].

    With a direction (w, 2, K) for each vertex, it takes the place of the common one.
    """

    vertex: IntArray
    """(w, K) indices of vertices, distinct within a row unless all but the first of them have the direction 0."""
    weight: FloatArray
    """(w, K)."""
    direction: FloatArray
    """(2, K), or (w, 2, K)."""

    @property
    def count(self) -> int:
        """Number of rows."""
        return self.vertex.shape[1]

    @property
    def directions(self) -> FloatArray:
        """(K, w, 2), or (K, 1, 2) for a common one."""
        return np.moveaxis(self.direction if self.direction.ndim == 3 else self.direction[None], 2, 0)

    def coupled(self) -> tuple[IntArray, IntArray]:
        """Pairs of vertices in one row: the first with each of the others."""
        return np.tile(self.vertex[0], len(self.vertex) - 1), self.vertex[1:].ravel()


@dataclass(frozen=True, eq=False)
class BandOrder:
    """An order of m vertices that keeps vertices coupled by a matrix close together."""

    position: IntArray
    """(m,) position of each vertex in the order."""
    bandwidth: int
    """Largest distance in the order between two coupled vertices."""

    @classmethod
    def of(cls, count: int, row: IntArray, column: IntArray) -> BandOrder:
        """Reverse Cuthill-McKee order of the graph whose edges join row[k] and column[k]."""
        ends = np.concatenate([row, column]), np.concatenate([column, row])
        graph = scipy.sparse.csr_array((np.ones(2 * len(row)), ends), shape=(count, count))
        position = np.empty(count, np.int32)
        position[scipy.sparse.csgraph.reverse_cuthill_mckee(graph, symmetric_mode=True)] = np.arange(count)
        order = cls(position.astype(np.int64), 0)
        return cls(order.position, order.distance(row, column))

    def distance(self, row: IntArray, column: IntArray) -> int:
        """Largest distance in this order between row[k] and column[k]."""
        return int(np.abs(self.position[row] - self.position[column]).max(initial=0))

    def including(self, hessian: Blocks, rows: Sequence[Rows]) -> BandOrder:
        """This order if its band holds the couplings of both, else a new one that does."""
        couplings = [(hessian.row, hessian.column), *(group.coupled() for group in rows)]
        if all(self.distance(*pair) <= self.bandwidth for pair in couplings):
            return self
        # the first of three vertices with the other two, and these with each other
        couplings += [(group.vertex[1], group.vertex[2]) for group in rows if len(group.vertex) > 2]
        row, column = (np.concatenate(side) for side in zip(*couplings, strict=True))
        return BandOrder.of(len(self.position), row, column)


class BandedSystem:
    """W and all constraints over 2m unknowns: the motion of each vertex along its two axes, in the order of the band.

    The constraints are A = (J; I; -I): the rows J, then lower and upper bounds of the unknowns. ``axes`` (m, 2, 2) are
    perpendicular unit vectors: vertex, axis, component. Products with A use `bincount`, since building a sparse matrix
    costs more than the few products with it.
    """

    solve: Solve
    """Solution (2m,) of the system that was factorised last."""

    def __init__(self, order: BandOrder, hessian: Blocks, rows: Sequence[Rows], axes: FloatArray) -> None:
        size = 2 * len(order.position)
        height = 2 * order.bandwidth + 2  # diagonals stored: the main one and 2 bandwidth + 1 below
        self._shape = size, height
        self._axes = axes
        self._unknowns = 2 * order.position[:, None] + _AXES

        turned = axes.take(hessian.column, axis=0).transpose(0, 2, 1)
        value = np.matmul(np.matmul(axes.take(hessian.row, axis=0), hessian.value), turned)
        row = self._unknowns.take(hessian.row, axis=0)[:, :, None]
        column = self._unknowns.take(hessian.column, axis=0)[:, None, :]
        # blocks above the diagonal are stored transposed, blocks on it as their lower triangle
        value[hessian.row == hessian.column, 0, 1] = 0.0
        self._W = np.bincount(_place(row, column, height).ravel(), value.ravel(), size * height)

        # entries of J, and products of the entries of each row for Jᵀ diag(h) J
        self._count = sum(group.count for group in rows)
        numbers = np.arange(self._count)
        entries, products = [_Entries.none()], [_Entries.none()]
        first = 0
        for group in rows:
            number = numbers[first : first + group.count, None]
            first += group.count
            along = np.matmul(axes.take(group.vertex.T, axis=0), group.directions[..., None])[..., 0]
            entry = (group.weight.T[:, :, None] * along).reshape(group.count, 2 * len(group.vertex))
            unknown = self._unknowns.take(group.vertex.T, axis=0).reshape(entry.shape)
            entries.append(_Entries.of(number, unknown, entry))
            one, other = _triangle(entry.shape[1])
            place = _place(unknown[:, one], unknown[:, other], height)
            products.append(_Entries.of(number, place, entry[:, one] * entry[:, other]))
        self._J, self._products = _Entries.joined(entries), _Entries.joined(products)

    def along_axes(self, vectors: FloatArray) -> FloatArray:
        """Unknowns (2m,) from vectors (m, 2) of the vertices."""
        unknowns = np.empty(self._shape[0])
        unknowns[self._unknowns] = np.matmul(self._axes, vectors[:, :, None])[:, :, 0]
        return unknowns

    def of_vertices(self, unknowns: FloatArray) -> FloatArray:
        """Vectors (m, 2) of the vertices from unknowns (2m,)."""
        vectors: FloatArray = np.matmul(unknowns[self._unknowns][:, None, :], self._axes)[:, 0]
        return vectors

    def per_unknown(self, lengths: FloatArray) -> FloatArray:
        """(2m,) a value of each vertex (m,), repeated for both its unknowns."""
        values = np.empty(self._shape[0])
        values[self._unknowns] = lengths[:, None]
        return values

    def constraints(self, d: FloatArray) -> FloatArray:
        """A d, (K + 4m,)."""
        return np.concatenate([self._J.rows(d, self._count), d, -d])

    def transposed(self, z: FloatArray) -> FloatArray:
        """Aᵀ z, (2m,)."""
        count, size = self._count, self._shape[0]
        product: FloatArray = self._J.columns(z, size)
        product += z[count : count + size]
        product -= z[count + size :]
        return product

    def set_matrix(self, h: FloatArray) -> None:
        """Assemble W + Aᵀ diag(h) A."""
        count, (size, height) = self._count, self._shape
        band = self._products.columns(h, size * height)
        band += self._W
        self._band = band.reshape(self._shape)
        self._diagonal = self._band[:, 0] + h[count : count + size]
        self._diagonal += h[count + size :]

    def factorise(self, shift: float) -> bool:
        """Factorise the matrix plus shift times the identity; False if that is not positive definite."""
        self._band[:, 0] = self._diagonal + shift
        solve = factorised(self._band)
        if solve is not None:
            self.solve = solve
        return solve is not None


_AXES = np.array([0, 1])
"""Both unknowns of a vertex."""


class _Entries(NamedTuple):
    """E entries of a sparse matrix."""

    row: IntArray
    """(E,)."""
    column: IntArray
    """(E,)."""
    value: FloatArray
    """(E,)."""

    @classmethod
    def none(cls) -> _Entries:
        return cls(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))

    @classmethod
    def of(cls, row: IntArray, column: IntArray, value: FloatArray) -> _Entries:
        """From entries (K, w), all those of a line in the same row (K, 1)."""
        return cls(np.repeat(row, value.shape[1]), column.ravel(), value.ravel())

    @classmethod
    def joined(cls, parts: Sequence[_Entries]) -> _Entries:
        """All entries."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))

    def rows(self, x: FloatArray, count: int) -> FloatArray:
        """The matrix of ``count`` rows times x."""
        sums = np.bincount(self.row, self.value * x.take(self.column), count)
        return sums.astype(np.float64, copy=False)  # integers where there are no entries

    def columns(self, y: FloatArray, count: int) -> FloatArray:
        """The transpose of the matrix of ``count`` columns times y."""
        sums = np.bincount(self.column, self.value * y.take(self.row), count)
        return sums.astype(np.float64, copy=False)  # integers where there are no entries


@cache
def _triangle(size: int) -> tuple[IntArray, IntArray]:
    """Rows and columns of the upper triangle of a matrix."""
    return np.triu_indices(size)


def _place(row: IntArray, column: IntArray, height: int) -> IntArray:
    """Index of an entry or its mirror image in the band, which stores the lower triangle column by column."""
    place: IntArray = np.minimum(row, column) * (height - 1) + np.maximum(row, column)
    return place
