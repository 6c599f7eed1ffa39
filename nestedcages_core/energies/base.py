"""The interface of energies, and a base class from which a new one needs its value, gradient and Hessian only.

>>> import numpy as np
>>> from dataclasses import dataclass
>>> from nestedcages_core.energies import Blocks, CageEnergy
>>> @dataclass(frozen=True)
... class Springs(CageEnergy):
...     "½ k Σ |b - a|² over the edges a → b."
...     k: float = 1.0
...     def value(self, vertices, successor):
...         return 0.5 * self.k * float(((vertices[successor] - vertices) ** 2).sum())
...     def gradient(self, vertices, successor):
...         pull = self.k * (vertices - vertices[successor])
...         gradient = pull.copy()
...         gradient[successor] -= pull
...         return gradient
...     def hessian(self, vertices, successor):
...         vertex, eye = np.arange(len(successor)), np.broadcast_to(np.eye(2), (len(successor), 2, 2))
...         return Blocks.sum([(2.0 * self.k, Blocks(vertex, vertex, eye)), (-self.k, Blocks(vertex, successor, eye))])
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh

EdgeCost: TypeAlias = Callable[[int, FloatArray, FloatArray], FloatArray]
"""(K,) what an edge adds to an energy, in squared input units: its first vertex, and places (K, 2) of both ends."""


class Energy(Protocol):
    """A choice of energy, made before the cage is known. Unit: length², as of an area."""

    def at(self, coarse: Mesh) -> CageEnergy:
        """The energy of a cage whose rest shape is the coarse mesh."""


class CageEnergy(ABC):
    """An energy of the cage's vertices (m, 2), joined by edges from each vertex v to successor[v] (m,).

    Energies without a rest shape are their own choice; those without memory of the steps are their own successors.
    """

    def at(self, coarse: Mesh) -> CageEnergy:
        """The energy of a cage whose rest shape is the coarse mesh."""
        return self

    def after(self, cage: FloatArray) -> CageEnergy:
        """The energy of the next step, which starts with the cage's vertices (m, 2)."""
        return self

    def with_area(self, measure: CageEnergy) -> CageEnergy:
        """The energy with another measure in the place of the area of the cage, if that is a part of it."""
        return self

    @abstractmethod
    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """The energy; infinite where the cage is invalid.

        Parameters
        ----------
        vertices : (m, 2) array
            Vertices of the cage.
        successor : (m,) array
            Index of the vertex after each vertex on its loop.

        Returns
        -------
        float
            In squared units of length, as an area.
        """

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) the terms that belong to one edge, or to its first vertex, for places (K, 2) of its two ends."""
        return np.zeros(len(start))

    @abstractmethod
    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """First derivative, (m, 2), for the parameters of `value`."""

    @abstractmethod
    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact second derivative for the parameters of `value`; it may be indefinite."""

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """A positive semi-definite matrix no less than the Hessian: its blocks without their negative eigenvalues."""
        return self.hessian(vertices, successor).projected()


class Blocks(NamedTuple):
    """A symmetric matrix over the coordinates of m vertices, in 2 × 2 blocks; blocks at the same place add up.

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

    def projected(self) -> Blocks:
        """A positive semi-definite matrix B⁺ with B⁺ - B positive semi-definite, block by block.

        Each block loses its negative eigenvalues, one off the diagonal together with its mirror image: for A = U σ Vᵀ
        the eigenvalues of (0 A; Aᵀ 0) are ±σ, and its positive part is ½ (U σ Uᵀ, A; Aᵀ, V σ Vᵀ).
        """
        diagonal = self.row == self.column
        off = ~diagonal
        own = assembled_hessian(self.row[diagonal][:, None], positive_part(self.value[diagonal]))
        u, sigma, vt = np.linalg.svd(self.value[off])
        row, column = self.row[off], self.column[off]
        at_row = 0.5 * (u * sigma[:, None, :]) @ u.transpose(0, 2, 1)
        at_column = 0.5 * (vt.transpose(0, 2, 1) * sigma[:, None, :]) @ vt
        mixed = 0.5 * self.value[off]
        both = Blocks(
            np.concatenate([row, column, row]),
            np.concatenate([row, column, column]),
            np.concatenate([at_row, at_column, mixed]),
        )
        return Blocks.sum([(1.0, own), (1.0, both)])

    def dense(self, count: int) -> FloatArray:
        """The (2 count, 2 count) matrix."""
        values, (rows, columns) = self.entries()
        size = 2 * count
        entries: FloatArray = np.bincount(rows * size + columns, values, size * size).astype(np.float64, copy=False)
        return entries.reshape(size, size)

    def sparse(self, count: int) -> Any:
        """The (2 count, 2 count) matrix in compressed rows, of scipy."""
        import scipy

        return scipy.sparse.csr_matrix(self.entries(), shape=(2 * count, 2 * count))

    def entries(self) -> tuple[FloatArray, tuple[IntArray, IntArray]]:
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


def assembled_gradient(corners: IntArray, gradients: FloatArray, count: int) -> FloatArray:
    """(count, 2) sum, vertex by vertex, of the gradients (E, k, 2) of E elements with corners (E, k)."""
    vertex = corners.ravel()
    total = np.empty((count, 2))
    for axis in (0, 1):
        total[:, axis] = np.bincount(vertex, gradients[:, :, axis].ravel(), count)
    return total


def assembled_hessian(corners: IntArray, hessians: FloatArray) -> Blocks:
    """Sum of symmetric element Hessians (E, 2k, 2k), unknowns ordered x, y of the first corner, x, y of the second, …

    A vertex may occur several times among the corners (E, k) of an element.
    """
    count, k = corners.shape
    i, j = np.triu_indices(k)
    pieces = hessians.reshape(count, k, 2, k, 2).transpose(0, 1, 3, 2, 4)[:, i, j].copy()
    row, column = corners[:, i], corners[:, j]
    same = (row == column) & (i != j)  # one vertex at two corners: the mirror image falls on the diagonal too
    pieces[same] += pieces[same].transpose(0, 2, 1)
    return Blocks(row.ravel(), column.ravel(), pieces.reshape(-1, 2, 2))


def positive_part(hessians: FloatArray) -> FloatArray:
    """Symmetric matrices (E, k, k) without their negative eigenvalues."""
    values, vectors = np.linalg.eigh(hessians)
    part: FloatArray = (vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1)
    return part
