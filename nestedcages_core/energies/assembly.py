"""From elements of a few vertices to the whole cage: gradients add up, Hessians become blocks."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from .base import Blocks


def add_up(corners: IntArray, forces: FloatArray, count: int) -> FloatArray:
    """(count, 2) sums of the forces (E, k, 2) of E elements at their corners (E, k), by vertex."""
    vertex = corners.ravel()
    total = np.empty((count, 2))
    for axis in (0, 1):
        total[:, axis] = np.bincount(vertex, forces[:, :, axis].ravel(), count)
    return total


def blocks_of(corners: IntArray, hessians: FloatArray) -> Blocks:
    """The sum of symmetric element Hessians (E, 2k, 2k), whose unknowns are x, y of the first corner, then the second.

    A vertex may occur several times among the corners (E, k) of an element.
    """
    count, k = corners.shape
    i, j = np.triu_indices(k)
    pieces = hessians.reshape(count, k, 2, k, 2).transpose(0, 1, 3, 2, 4)[:, i, j].copy()
    row, column = corners[:, i], corners[:, j]
    met = (row == column) & (i != j)  # two corners in one place: the block below the diagonal falls there as well
    pieces[met] += pieces[met].transpose(0, 2, 1)
    return Blocks(row.ravel(), column.ravel(), pieces.reshape(-1, 2, 2))


def positive_part(hessians: FloatArray) -> FloatArray:
    """Symmetric matrices (E, k, k) without their negative eigenvalues."""
    values, vectors = np.linalg.eigh(hessians)
    part: FloatArray = (vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1)
    return part
