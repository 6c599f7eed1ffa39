"""A weighted sum of energies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from .base import Blocks, CageEnergy, Energy

__all__ = ["BoundSum", "WeightedSum"]


@dataclass(frozen=True)
class WeightedSum:
    """Σ w E over pairs (w, E) with finite weights w ≥ 0."""

    terms: tuple[tuple[float, Energy], ...]

    def __post_init__(self) -> None:
        for weight, energy in self.terms:
            if not 0.0 <= weight < np.inf:
                raise invalid_setting(f"WeightedSum: weights must be finite and at least 0, not {weight!r}.")
            if isinstance(energy, type) or not callable(getattr(energy, "at", None)):
                raise invalid_setting(f"WeightedSum: a term must be an energy such as Area(), not {energy!r}.")

    def at(self, coarse: Mesh) -> BoundSum:
        """The sum for a cage whose rest shape is the coarse mesh."""
        return BoundSum(tuple((weight, energy.at(coarse)) for weight, energy in self.terms))


@dataclass(frozen=True, eq=False)
class BoundSum(CageEnergy):
    """A weighted sum for one cage."""

    terms: tuple[tuple[float, CageEnergy], ...]

    def after(self, cage: FloatArray) -> BoundSum:
        """The sum for the next step."""
        return BoundSum(tuple((weight, energy.after(cage)) for weight, energy in self.terms))

    def with_area(self, measure: CageEnergy) -> BoundSum:
        """The sum with another measure in the place of the area."""
        return BoundSum(tuple((weight, energy.with_area(measure)) for weight, energy in self.terms))

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Infinite where one of the energies is."""
        return float(sum(weight * energy.value(vertices, successor) for weight, energy in self.terms))

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,)."""
        return np.asarray(sum(weight * energy.on_edge(vertex, start, end) for weight, energy in self.terms))

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
        """Sum of the projected Hessians."""
        return self._blocks(lambda energy: energy.projected_hessian(vertices, successor))

    def _blocks(self, part: Callable[[CageEnergy], Blocks]) -> Blocks:
        return Blocks.sum((weight, part(energy)) for weight, energy in self.terms)
