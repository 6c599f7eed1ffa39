"""The area that a cage inside loses."""

from __future__ import annotations

from dataclasses import dataclass

from ..geometry.arrays import FloatArray, IntArray
from .area import Area, signed_area
from .base import Blocks, CageEnergy


@dataclass(frozen=True)
class LostArea(CageEnergy):
    """The area of the fine mesh without that of a cage inside it."""

    around: float
    """Area of the fine mesh."""

    def with_area(self, measure: CageEnergy) -> CageEnergy:
        """The measure."""
        return measure

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """A length²; infinite where the cage would be larger than the fine mesh."""
        lost = self.around - signed_area(vertices, successor)
        return lost if lost >= 0.0 else float("inf")

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) that of the area, negative."""
        return -Area().on_edge(vertex, start, end)

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2) that of the area, negative."""
        return -Area().gradient(vertices, successor)

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Constant."""
        return Blocks.sum([(-1.0, Area().hessian(vertices, successor))])
