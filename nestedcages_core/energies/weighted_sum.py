"""Several energies at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from .base import Blocks, CageEnergy, Energy


@dataclass(frozen=True)
class WeightedSum:
    """Σ w E over pairs (w, E) with weights w ≥ 0."""

    terms: tuple[tuple[float, Energy], ...]

    def at(self, coarse: Mesh) -> BoundSum:
        """The sum for a cage that starts as the coarse mesh."""
        return BoundSum(tuple((weight, energy.at(coarse)) for weight, energy in self.terms))


@dataclass(frozen=True, eq=False)
class BoundSum:
    """A weighted sum for a given cage; see :class:`nestedcages_core.energies.base.CageEnergy`."""

    terms: tuple[tuple[float, CageEnergy], ...]

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Infinite where one of the energies is."""
        return float(sum(weight * energy.value(vertices, successor) for weight, energy in self.terms))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        total = np.zeros_like(vertices)
        for weight, energy in self.terms:
            total += weight * energy.gradient(vertices, successor)
        return total

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return self._blocks(lambda energy: energy.hessian(vertices, successor))

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """The sum of the projected Hessians."""
        return self._blocks(lambda energy: energy.projected_hessian(vertices, successor))

    def after(self, cage: FloatArray) -> BoundSum:
        """The sum for the next step."""
        return BoundSum(tuple((weight, energy.after(cage)) for weight, energy in self.terms))

    def _blocks(self, part: Callable[[CageEnergy], Blocks]) -> Blocks:
        return Blocks.sum((weight, part(energy)) for weight, energy in self.terms)
