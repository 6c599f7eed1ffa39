"""Springs between vertices and places."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.vectors import inner
from .base import Blocks, CageEnergy


@dataclass(frozen=True, eq=False)
class Springs(CageEnergy):
    """½ Σ k |x - p|² over some vertices x with places p: a quadratic energy with a diagonal Hessian."""

    vertex: IntArray
    """(P,) indices of vertices, each at most once."""
    place: FloatArray
    """(P, 2)."""
    stiffness: FloatArray
    """(P,) k, without unit."""

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """A length²."""
        away = vertices[self.vertex] - self.place
        return 0.5 * inner(self.stiffness, (away * away).sum(axis=1))

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) the springs of the edge's first vertex."""
        own = self.vertex == vertex
        pull = start[:, None] - self.place[own]
        return np.asarray(0.5 * ((pull**2).sum(axis=2) @ self.stiffness[own]))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        gradient = np.zeros_like(vertices)
        gradient[self.vertex] = self.stiffness[:, None] * (vertices[self.vertex] - self.place)
        return gradient

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Constant: k on the diagonal."""
        return Blocks(self.vertex, self.vertex, self.stiffness[:, None, None] * np.eye(2))
