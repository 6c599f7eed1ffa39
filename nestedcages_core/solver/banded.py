"""Banded linear systems W + Aᵀ diag(h) A over the vertices of a cage, for the interior-point method.

W has 2 × 2 blocks over vertices, and each constraint row touches at most three vertices, mostly neighbours on a loop.
In reverse Cuthill-McKee order a loop is a band of two vertices on either side of the diagonal, and Cholesky
factorisation stays within the band (Golub & Van Loan, Matrix Computations, section 4.3). Contacts between distant parts
of the cage widen it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from typing import NamedTuple, cast

import numpy as np

from ..energies import Blocks
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import position_in_group
from ..geometry.loops import Loops
from .cholesky import Solve, within_band

WIDEST_BAND = 64
"""Diagonals up to which Cholesky factorisation within the band stays on one thread: LAPACK takes no blocks."""


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
        return int(self.vertex.shape[1])

    @property
    def directions(self) -> FloatArray:
        """(K, w, 2), or (K, 1, 2) for a common one."""
        return np.moveaxis(self.direction if self.direction.ndim == 3 else self.direction[None], 2, 0)

    def dense(self, count: int) -> FloatArray:
        """(K, 2 count) the matrix."""
        matrix = np.zeros((self.count, count, 2))
        directions, row = self.directions, np.arange(self.count)
        for j, (vertex, weight) in enumerate(zip(self.vertex, self.weight, strict=True)):
            matrix[row, vertex] += weight[:, None] * directions[:, min(j, directions.shape[1] - 1)]
        return matrix.reshape(self.count, 2 * count)

    def coupled(self) -> Iterator[tuple[IntArray, IntArray]]:
        """All pairs of vertices (K,) in one row."""
        return combinations(self.vertex, 2)


class BandOrder(NamedTuple):
    """An order of m vertices that keeps vertices coupled by a matrix close together."""

    position: IntArray
    """(m,) position of each vertex in the order."""
    bandwidth: int
    """Largest distance in the order between two coupled vertices."""

    @classmethod
    def of(cls, count: int, row: IntArray, column: IntArray) -> BandOrder:
        """Reverse Cuthill-McKee order of the graph whose edges join row[k] and column[k]."""
        position = np.empty(count, np.int64)
        position[_cuthill_mckee(count, row, column)] = np.arange(count)[::-1]
        order = cls(position, 0)
        return cls(order.position, order.distance(row, column))

    @classmethod
    def along(cls, loops: Loops) -> BandOrder:
        """An order along both halves of each loop at once: neighbours are at most two apart."""
        place, size = position_in_group(loops.sizes), loops.sizes[loops.loop]
        position = np.empty_like(place)
        turn = np.where(2 * place <= size, np.maximum(2 * place - 1, 0), 2 * (size - place))
        position[loops.numbers] = loops.begins[loops.loop] + turn
        return cls(position, 2)

    def distance(self, row: IntArray, column: IntArray) -> int:
        """Largest distance in this order between row[k] and column[k]."""
        return int(np.abs(self.position[row] - self.position[column]).max(initial=0))

    def including(self, hessian: Blocks, rows: Sequence[Rows]) -> BandOrder:
        """This order if its band holds the couplings of both and is narrow, else a new one that holds them."""
        pairs = [pair for group in rows for pair in group.coupled()]
        row = np.concatenate([hessian.row, *(i for i, _ in pairs)])
        column = np.concatenate([hessian.column, *(j for _, j in pairs)])
        if self.distance(row, column) <= self.bandwidth < WIDEST_BAND // 2:
            return self
        return BandOrder.of(len(self.position), row, column)


def _cuthill_mckee(count: int, row: IntArray, column: IntArray) -> list[int]:
    """The vertices breadth first, each followed by its new neighbours by degree (Cuthill & McKee 1969).

    Each component starts where the degree is least. scipy's takes longer to import than most cages take to make.
    """
    start, end = np.divmod(np.unique(np.concatenate([row * count + column, column * count + row])), count)
    degree = np.bincount(start, minlength=count) + np.bincount(start[start == end], minlength=count)
    ends, degrees = end.tolist(), degree.tolist()
    first = np.searchsorted(start, np.arange(count + 1)).tolist()
    order: list[int] = []
    waiting = [True] * count
    for seed in np.argsort(degree.astype(np.int32)).tolist():
        component = [seed] if waiting[seed] else []
        for vertex in component:  # which grows
            waiting[vertex] = False
            new = [other for other in ends[first[vertex] : first[vertex + 1]] if waiting[other]]
            for other in new:
                waiting[other] = False
            component += sorted(new, key=degrees.__getitem__)
        order += component
    return order


class BandedSystem:
    """W and all constraints over 2m unknowns: the motion of each vertex along its two axes, in the order of the band.

    The N = K + 4m constraints are A = (J; I; -I): the rows J, then lower and upper bounds of the unknowns. ``axes``
    (m, 2, 2) are perpendicular unit vectors: vertex, axis, component. Arrays inside have their long axis last, where
    numpy is fastest.
    """

    solve: Solve
    """Solution (2m,) of the system that was factorised last."""

    def __init__(self, order: BandOrder, hessian: Blocks, rows: Sequence[Rows], axes: FloatArray) -> None:
        size, height = _shape(order)
        self._shape = size, height
        self._unknowns = np.stack([2 * order.position, 2 * order.position + 1])
        self._axes = np.ascontiguousarray(axes.reshape(-1, 4).T).reshape(2, 2, -1)
        before, after = self._axes.take(hessian.row, axis=2), self._axes.take(hessian.column, axis=2)
        value = hessian.value.reshape(-1, 4).T.reshape(2, 2, -1)
        value = before[:, 0, None] * value[0] + before[:, 1, None] * value[1]
        value = value[:, 0, None] * after[:, 0] + value[:, 1, None] * after[:, 1]
        self._W = _band(order, hessian.row, hessian.column, value)

        # entries of A, and products of the entries of each row for Aᵀ diag(h) A
        rows = [group for group in rows if group.count]
        count = sum(group.count for group in rows)
        unknown: IntArray = np.arange(size)
        bounds: IntArray = np.arange(count, count + 2 * size)
        ones = np.ones(size)
        entries: list[tuple[IntArray, IntArray, FloatArray]] = [
            (bounds[:size], unknown, ones),
            (bounds[size:], unknown, -ones),
        ]
        diagonal = _place(unknown, unknown, height)
        products: list[tuple[IntArray, IntArray, FloatArray]] = [
            (bounds[:size], diagonal, ones),
            (bounds[size:], diagonal, ones),
        ]
        first = 0
        for group in rows:
            number: IntArray = np.arange(first, first + group.count)[None]
            first += group.count
            axis = self._axes.take(group.vertex, axis=2)
            entry = group.weight * (axis[:, 0] * group.direction[..., 0, :] + axis[:, 1] * group.direction[..., 1, :])
            entry = entry.reshape(-1, group.count)
            unknown = self._unknowns.take(group.vertex, axis=1).reshape(entry.shape)
            entries.append((number.repeat(len(entry), axis=0), unknown, entry))
            i, j = _triangle(len(entry))
            place = _place(unknown.take(i, axis=0), unknown.take(j, axis=0), height)
            products.append((number.repeat(len(i), axis=0), place, entry.take(i, axis=0) * entry.take(j, axis=0)))
        self._A = _Matrix.of(entries, count + 2 * size, size)
        self._products = _Matrix.of(products, count + 2 * size, size * height)

    def along_axes(self, vectors: FloatArray) -> FloatArray:
        """Unknowns (2m,) from vectors (m, 2) of the vertices."""
        unknowns = np.empty(self._shape[0])
        unknowns[self._unknowns] = self._axes[:, 0] * vectors[:, 0] + self._axes[:, 1] * vectors[:, 1]
        return unknowns

    def of_vertices(self, unknowns: FloatArray) -> FloatArray:
        """Vectors (m, 2) of the vertices from unknowns (2m,)."""
        along, across = unknowns[self._unknowns]
        return np.ascontiguousarray((along * self._axes[0] + across * self._axes[1]).T)

    def per_unknown(self, lengths: FloatArray) -> FloatArray:
        """(2m,) a value of each vertex (m,), repeated for both its unknowns."""
        values = np.empty(self._shape[0])
        values[self._unknowns] = lengths
        return values

    def constraints(self, d: FloatArray) -> FloatArray:
        """A d, (N,)."""
        return self._A.times(d)

    def transposed(self, z: FloatArray) -> FloatArray:
        """Aᵀ z, (2m,)."""
        return self._A.transposed_times(z)

    def set_matrix(self, h: FloatArray) -> None:
        """Assemble W + Aᵀ diag(h) A."""
        band = self._products.transposed_times(h)
        band += self._W
        self._band = band.reshape(self._shape)

    def factorise(self, shift: float) -> bool:
        """Factorise the matrix plus shift times the identity; False if that is not positive definite."""
        band = self._band
        if shift:
            band = band.copy()
            band[:, 0] += shift
        solve = factorised(band)
        if solve is not None:
            self.solve = solve
        return solve is not None


class _Matrix(NamedTuple):
    """A sparse matrix of E entries. Products use `bincount`: building a matrix of scipy costs more than the few
    products with it."""

    row: IntArray
    """(E,)."""
    column: IntArray
    """(E,)."""
    value: FloatArray
    """(E,)."""
    rows: int
    columns: int

    @classmethod
    def of(cls, parts: Sequence[tuple[IntArray, IntArray, FloatArray]], rows: int, columns: int) -> _Matrix:
        """From rows, columns and values of any shape; at least one entry."""
        joined = [np.concatenate([array.ravel() for array in arrays]) for arrays in zip(*parts, strict=True)]
        return cls(joined[0], joined[1], joined[2], rows, columns)

    def times(self, x: FloatArray) -> FloatArray:
        """The matrix times x (columns,)."""
        return cast(FloatArray, np.bincount(self.row, self.value * x.take(self.column), self.rows))

    def transposed_times(self, y: FloatArray) -> FloatArray:
        """The transpose of the matrix times y (rows,)."""
        return cast(FloatArray, np.bincount(self.column, self.value * y.take(self.row), self.columns))


def banded_solver(matrix: Blocks, order: BandOrder) -> Solve | None:
    """Solver for right sides (m, 2) of a matrix over m vertices; None if it is not positive definite."""
    size, height = _shape(order)
    values = matrix.value.reshape(-1, 4).T.reshape(2, 2, -1).copy()
    solve = factorised(_band(order, matrix.row, matrix.column, values).reshape(size, height))
    if solve is None:
        return None
    place = (2 * order.position[:, None] + np.arange(2)).ravel()

    def solution(right: FloatArray) -> FloatArray:
        ordered = np.empty(size)
        ordered[place] = right.ravel()
        return np.asarray(solve(ordered)[place].reshape(-1, 2))

    return solution


def _shape(order: BandOrder) -> tuple[int, int]:
    """Unknowns of the vertices in an order, and diagonals of their band: the main one and those below it."""
    return 2 * len(order.position), 2 * order.bandwidth + 2


def _band(order: BandOrder, row: IntArray, column: IntArray, values: FloatArray) -> FloatArray:
    """The band, column by column, of a symmetric matrix with blocks (2, 2, B), which are changed.

    Blocks above the diagonal are stored transposed, blocks on it as their lower triangle.
    """
    size, height = _shape(order)
    values[0, 1, row == column] = 0.0
    axis = np.arange(2)[:, None]
    place = _place((2 * order.position[row] + axis)[:, None], 2 * order.position[column] + axis, height)
    return cast(FloatArray, np.bincount(place.ravel(), values.ravel(), size * height))


@cache
def _triangle(size: int) -> tuple[IntArray, IntArray]:
    """Rows and columns of the upper triangle of a matrix."""
    return np.triu_indices(size)


def _place(row: IntArray, column: IntArray, height: int) -> IntArray:
    """Index of an entry or its mirror image in the band, which stores the lower triangle column by column."""
    place: IntArray = np.minimum(row, column) * (height - 1) + np.maximum(row, column)
    return place


def factorised(band: FloatArray) -> Solve | None:
    """Solver of a symmetric system; None if the matrix is not positive definite.

    OpenBLAS uses several threads for larger matrices. Ours are too small to gain from that: it would take longer, and
    the last digits would depend on the number of threads. So only single-threaded methods are used: Cholesky
    factorisation within a narrow band, and sparse LU.

    band: (size, height), entry [j, i] stands at row j + i and column j of the lower triangle; 0 below the last row.
    """
    if band.shape[1] <= WIDEST_BAND:
        return within_band(band)
    from .sparse_lu import by_sparse_lu  # few cages need it

    return by_sparse_lu(band)
