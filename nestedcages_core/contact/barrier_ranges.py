"""Ranges d̂ of the barrier, shorter where walls face each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from .facing_gaps import facing_gaps
from .pairs import Bodies, Pairs


@dataclass(frozen=True, eq=False)
class BarrierRanges:
    """Range d̂ of each vertex and edge; lengths."""

    cage_vertex: FloatArray
    """(m,) against the cage itself."""
    cage_edge: FloatArray
    """(m,) by start vertex, against the cage itself."""
    fine_vertex: FloatArray
    """(n,) against cage edges."""
    fine_edge: FloatArray
    """(n,) by start vertex, against cage vertices."""

    @classmethod
    def local(cls, bodies: Bodies, cage: FloatArray, home: FloatArray, base: float) -> BarrierRanges:
        """``base`` (a length), or half the gap between walls that face each other where that is less.

        home, cage: final positions (n, 2) of the fine mesh and positions (m, 2) of the cage, where gaps are measured.
        """
        fine_gap = facing_gaps(home, bodies.fine.successor, bodies.fine.predecessor, 2.0 * base)
        cage_gap = facing_gaps(cage, bodies.cage.successor, bodies.cage.predecessor, 2.0 * base)
        fine = np.minimum(base, 0.5 * fine_gap)
        own = np.minimum(base, 0.5 * cage_gap)  # cage against cage
        return cls(
            own,
            np.minimum(own, own[bodies.cage.successor]),
            fine,
            np.minimum(fine, fine[bodies.fine.successor]),
        )

    def scaled(self, factor: float) -> BarrierRanges:
        """All ranges times a factor."""
        return BarrierRanges(
            factor * self.cage_vertex, factor * self.cage_edge, factor * self.fine_vertex, factor * self.fine_edge
        )

    def of(self, bodies: Bodies, pairs: Pairs) -> FloatArray:
        """(K,) d̂ of each pair; of a vertex and an edge of the cage, the smaller one."""
        m = bodies.m
        d_hat = np.empty(len(pairs))
        d_hat[pairs.fine_cage] = self.fine_vertex[pairs.point[pairs.fine_cage] - m]
        d_hat[pairs.cage_fine] = self.fine_edge[pairs.start[pairs.cage_fine] - m]
        own = pairs.cage_cage
        d_hat[own] = np.minimum(self.cage_vertex[pairs.point[own]], self.cage_edge[pairs.start[own]])
        return d_hat

    @property
    def largest(self) -> float:
        """Distance beyond which no pair has a barrier."""
        return float(max(self.cage_vertex.max(), self.fine_vertex.max()))
