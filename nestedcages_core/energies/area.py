"""Area by Green's theorem: E_cages, which keeps a cage tight (Gurditta & Jacobson 2022, section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.vectors import cross, rotated_left
from .base import Blocks, CageEnergy


@dataclass(frozen=True)
class Area(CageEnergy):
    """½ Σ (x_a y_b - x_b y_a) over the edges a → b; infinite where negative.

    Holes run clockwise, so their area counts negatively: the sum is the area of the solid.
    """

    def with_area(self, measure: CageEnergy) -> CageEnergy:
        """The measure."""
        return measure

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """The enclosed area, a length²; infinite where negative."""
        area = signed_area(vertices, successor)
        return area if area >= 0.0 else float("inf")

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) areas between the edge and the origin."""
        return 0.5 * cross(start, end)

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2) half the chord from the previous to the next vertex, rotated clockwise by 90°."""
        following = vertices[successor]
        gradient = np.empty_like(vertices)
        gradient[:, 0], gradient[:, 1] = 0.5 * following[:, 1], -0.5 * following[:, 0]
        back = np.empty_like(vertices)
        back[successor, 0], back[successor, 1] = -0.5 * vertices[:, 1], 0.5 * vertices[:, 0]
        gradient += back
        return gradient

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Constant: the block ½ (0 1; -1 0) for each edge a → b, since u × w = uᵀ (0 1; -1 0) w."""
        m = len(successor)
        return Blocks(np.arange(m), successor, np.broadcast_to(0.5 * rotated_left(np.eye(2)), (m, 2, 2)))


def signed_area(vertices: FloatArray, successor: IntArray) -> float:
    """½ Σ x_a × x_b over the edges, a length². Taken about the first vertex, to lose no digits far from the origin."""
    centred = vertices - vertices[0]
    following = centred[successor]
    return 0.5 * float(cross(centred, following).sum())
