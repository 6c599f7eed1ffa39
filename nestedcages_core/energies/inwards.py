"""Energies of inner cages, whose solid is the complement: the lost part of the fine mesh replaces the area."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from .area import Area, signed_area
from .base import CageEnergy
from .blocks import Blocks
from .weighted_sum import BoundSum


@dataclass(frozen=True)
class LostArea(Area):
    """The area between the fine mesh and a cage inside it, for cages with reversed loops; see `Area`.

    Derivatives are those of the area: the two differ by a constant, the area around the cage.
    """

    around: float
    """Area of the fine mesh."""

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """A length²; infinite where the cage would be larger than the fine mesh."""
        lost = self.around + signed_area(vertices, successor)
        return lost if lost >= 0.0 else float("inf")


@dataclass(frozen=True, eq=False)
class WalkedBack(CageEnergy):
    """An energy of a cage in the usual orientation, for cages with reversed loops."""

    energy: CageEnergy

    def after(self, cage: FloatArray) -> WalkedBack:
        """The energy of the next step."""
        return WalkedBack(self.energy.after(cage))

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """That of the cage in its usual orientation."""
        return self.energy.value(vertices, _inverse(successor))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        return self.energy.gradient(vertices, _inverse(successor))

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return self.energy.hessian(vertices, _inverse(successor))

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """That of the cage in its usual orientation."""
        return self.energy.projected_hessian(vertices, _inverse(successor))


def inwards(energy: CageEnergy, around: float) -> CageEnergy:
    """The energy of an inner cage with reversed loops; ``around`` is the area of the fine mesh.

    The lost area replaces the area of the cage, which is to grow. Other energies stay the same.
    """
    if isinstance(energy, Area):
        return LostArea(around)
    if isinstance(energy, BoundSum):
        return BoundSum(tuple((weight, inwards(term, around)) for weight, term in energy.terms))
    return WalkedBack(energy)


def _inverse(successor: IntArray) -> IntArray:
    predecessor = np.empty_like(successor)
    predecessor[successor] = np.arange(len(successor))
    return predecessor
