"""From a mesh to loops in an order that does not depend on the numbering of its vertices, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from .base import LEAST_PER_LOOP, Budget
from .outline import Outline

TIE = 1e-9
"""Lengths, in diagonals, that differ by less count as equal: far above round-off, far below what a user draws."""


@dataclass(frozen=True, eq=False)
class Unrolled:
    """A mesh as loops in an order, and from a start each, that do not depend on how its vertices are numbered.

    loop_order: (L,) for each loop of the outline its number in the mesh.
    """

    outline: Outline
    loop_order: IntArray

    def per_loop(self, budget: Budget) -> IntArray | None:
        """(L,) the numbers per loop of a budget in the order of the outline, or None if it has none."""
        return None if budget.per_loop is None else np.array(budget.per_loop)[self.loop_order]

    def minimum(self, budget: Budget) -> list[int]:
        """Vertices that each loop of a hull keeps: those it is to have, as far as it has them."""
        wanted = self.per_loop(budget)
        sizes = self.outline.sizes
        return [LEAST_PER_LOOP] * len(sizes) if wanted is None else np.minimum(wanted, sizes).tolist()

    def rolled_up(self, loops: Sequence[FloatArray]) -> Mesh:
        """A mesh from new loops (k, 2) in the order of the outline; its loop k stands for loop k of the mesh.

        Raises InvalidMeshError where they cross.
        """
        return Mesh.from_loops([loops[k] for k in np.argsort(self.loop_order)])


def unroll(fine: Mesh) -> Unrolled:
    """The loops of a mesh, largest first, each from the vertex farthest from its centre on."""
    tie, corner = TIE * fine.diagonal, fine.vertices.min(axis=0)
    rings, keys = [], []
    for loop, area in zip(fine.loops, fine.loop_areas, strict=True):
        points = fine.vertices[loop]
        lengths = fine.edge_lengths[loop]
        middles = 0.5 * (points + np.roll(points, -1, axis=0))
        offsets = points - (lengths[:, None] * (middles - points[0])).sum(axis=0) / lengths.sum() - points[0]
        distance = np.hypot(*offsets.T)
        farthest = np.flatnonzero(distance >= distance.max() - tie)
        cells = np.round(offsets[farthest] / tie)
        start = farthest[np.lexsort((cells[:, 1], cells[:, 0]))[0]]
        rings.append(np.roll(loop, -start))
        keys.append((-round(abs(area) / (tie * fine.diagonal)), *np.round((points[start] - corner) / tie)))
    order = np.array(sorted(range(len(rings)), key=keys.__getitem__), dtype=np.int64)
    ordered = tuple(rings[k] for k in order)
    places = np.concatenate([np.arange(len(ring)) for ring in ordered])
    outline = Outline(
        fine.vertices[np.concatenate(ordered)], tuple(len(ring) for ring in ordered), np.stack((places, places), axis=1)
    )
    return Unrolled(outline, order)
