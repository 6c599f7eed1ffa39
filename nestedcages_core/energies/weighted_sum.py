"""A weighted sum of energies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..parameters import has_method
from .base import Blocks, CageEnergy, Energy


@dataclass(frozen=True)
class WeightedSum(CageEnergy):
    """Σ w E over pairs (w, E) with finite weights w ≥ 0."""

    terms: tuple[tuple[float, Energy], ...]

    def __post_init__(self) -> None:
        for weight, energy in self.terms:
            if not 0.0 <= weight < np.inf:
                raise invalid_setting(f"WeightedSum: weights must be finite and at least 0, not {weight!r}.")
            if not has_method(energy, "at"):
                raise invalid_setting(f"WeightedSum: a term must be an energy such as Area(), not {energy!r}.")

    def at(self, coarse: Mesh) -> WeightedSum:
        """The sum for a cage whose rest shape is the coarse mesh."""
        return WeightedSum(tuple((weight, energy.at(coarse)) for weight, energy in self.terms))

    def after(self, cage: FloatArray) -> WeightedSum:
        """The sum for the next step."""
        return self._of_each(lambda energy: energy.after(cage))

    def with_area(self, measure: CageEnergy) -> WeightedSum:
        """The sum with another measure in the place of the area."""
        return self._of_each(lambda energy: energy.with_area(measure))

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Infinite where one of the energies is."""
        return float(sum(weight * energy.value(vertices, successor) for weight, energy in self._bound))

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,)."""
        return np.asarray(sum(weight * energy.on_edge(vertex, start, end) for weight, energy in self._bound))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        total = np.zeros_like(vertices)
        for weight, energy in self._bound:
            total += weight * energy.gradient(vertices, successor)
        return total

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return Blocks.sum((weight, energy.hessian(vertices, successor)) for weight, energy in self._bound)

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Sum of the projected Hessians."""
        return Blocks.sum((weight, energy.projected_hessian(vertices, successor)) for weight, energy in self._bound)

    @property
    def _bound(self) -> tuple[tuple[float, CageEnergy], ...]:
        """The terms, once they are those of a cage."""
        return cast("tuple[tuple[float, CageEnergy], ...]", self.terms)

    def _of_each(self, change: Callable[[CageEnergy], CageEnergy]) -> WeightedSum:
        return WeightedSum(tuple((weight, change(energy)) for weight, energy in self._bound))
