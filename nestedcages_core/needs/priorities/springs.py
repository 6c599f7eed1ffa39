"""Springs that hold some vertices of the cage in place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...energies.base import CageEnergy
from ...energies.blocks import Blocks
from ...geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Springs(CageEnergy):
    """½ k Σ |x - p|² over some vertices x with places p."""

    vertex: IntArray
    """(P,) indices of vertices."""
    place: FloatArray
    """(P, 2)."""
    stiffness: float
    """k, without unit."""

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """A length²."""
        return 0.5 * self.stiffness * float(((vertices[self.vertex] - self.place) ** 2).sum())

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) the springs of the edge's first vertex."""
        pull = start[:, None] - self.place[self.vertex == vertex][None]
        return np.asarray(0.5 * self.stiffness * (pull**2).sum(axis=(1, 2)))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        gradient = np.zeros_like(vertices)
        gradient[self.vertex] = self.stiffness * (vertices[self.vertex] - self.place)
        return gradient

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Constant."""
        count = len(self.vertex)
        return Blocks(self.vertex, self.vertex, np.broadcast_to(self.stiffness * np.eye(2), (count, 2, 2)))
