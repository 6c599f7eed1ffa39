"""Thinning: a mesh with some of its vertices, such as those that tell most."""

from __future__ import annotations

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray
from .mesh import Mesh
from .precision import NEGLIGIBLE


def tolerance_for(significance: FloatArray, points: int, diagonal: float) -> float:
    """The significance above which about so many vertices have more; not less than a negligible one."""
    return max(float(np.partition(significance, -points)[-points]), NEGLIGIBLE * diagonal)


def thinned(fine: Mesh, kept: BoolArray) -> Mesh:
    """The mesh of some vertices, (n,) by place, numbered in this order. Raises InvalidMeshError."""
    order = fine.loop_order
    sizes = np.add.reduceat(kept, order.begins, dtype=np.int64)
    return Mesh.from_loops(np.split(order.vertices[kept], np.cumsum(sizes)[:-1]))


def stretches(fine: Mesh, kept: BoolArray) -> IntArray:
    """(n,) for each place the edge of the thinned mesh that stands for it, by the number of its first vertex."""
    order = fine.loop_order
    before = np.cumsum(kept) - 1
    last = np.append(before[order.begins[1:] - 1], before[-1])
    none = before < np.append(0, last[:-1] + 1)[order.loop]  # before the first one of the loop
    return np.where(none, last[order.loop], before)
