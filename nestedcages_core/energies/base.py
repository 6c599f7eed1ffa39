"""What an energy of the cage must offer: value, gradient and Hessian together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Blocks:
    """A symmetric matrix of 2 × 2 blocks over vertices, as a sum: blocks that name the same place add up.

    Only one triangle is listed: a block with ``row != column`` stands for itself and its transpose at (column, row).
    """

    row: IntArray
    """(B,) vertex of the block's row."""
    column: IntArray
    """(B,) vertex of the block's column."""
    value: FloatArray
    """(B, 2, 2)."""

    @classmethod
    def sum(cls, terms: Iterable[tuple[float, Blocks]]) -> Blocks:
        """Σ w B over pairs of a weight and a matrix."""
        listed = list(terms)
        nothing = cls(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros((0, 2, 2)))
        return cls(
            np.concatenate([nothing.row, *(blocks.row for _, blocks in listed)]),
            np.concatenate([nothing.column, *(blocks.column for _, blocks in listed)]),
            np.concatenate([nothing.value, *(weight * blocks.value for weight, blocks in listed)]),
        )

    def dense(self, count: int) -> FloatArray:
        """The (2 count, 2 count) matrix."""
        values, (rows, columns) = self._entries()
        size = 2 * count
        entries: FloatArray = np.bincount(rows * size + columns, values, size * size).astype(np.float64, copy=False)
        return entries.reshape(size, size)

    def sparse(self, count: int) -> sp.csr_matrix:
        """The (2 count, 2 count) matrix in compressed rows."""
        return sp.csr_matrix(self._entries(), shape=(2 * count, 2 * count))

    def _entries(self) -> tuple[FloatArray, tuple[IntArray, IntArray]]:
        """All entries of both triangles: values, and their rows and columns."""
        axis = np.arange(2)
        rows = np.broadcast_to(2 * self.row[:, None, None] + axis[:, None], self.value.shape)
        columns = np.broadcast_to(2 * self.column[:, None, None] + axis, self.value.shape)
        other = self.row != self.column
        places = (
            np.concatenate([rows.ravel(), columns[other].ravel()]),
            np.concatenate([columns.ravel(), rows[other].ravel()]),
        )
        return np.concatenate([self.value.ravel(), self.value[other].ravel()]), places


class CageEnergy(Protocol):
    """An energy of the cage's vertices (m, 2), joined by edges from each vertex v to successor[v] (m,)."""

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """The energy; infinite where the state is invalid."""
        ...

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2) derivative of the energy."""
        ...

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact second derivative, which may be indefinite."""
        ...

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Positive semi-definite second derivative: each element's Hessian without its negative eigenvalues."""
        ...

    def after(self, cage: FloatArray) -> CageEnergy:
        """The energy of the next step, which starts with the cage's vertices (m, 2); itself if the past does not
        matter."""
        ...


class Energy(Protocol):
    """A choice of energy before the level is known that it is for. Unit of all energies: length², as the area's."""

    def at(self, coarse: Mesh) -> CageEnergy:
        """The energy of a cage that starts as the coarse mesh, its state of rest; itself if it needs none."""
        ...
