"""Adaptive barrier stiffness κ (Li et al. 2020, supplement, section 1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nestedcages_core.contact.barrier import barrier
from nestedcages_core.geometry.arrays import FloatArray

REFERENCE_DISTANCE = 1e-8
"""Distance, in bounding-box diagonals, at which the least stiffness is measured."""

STIFFNESS_RANGE = 100.0
"""Largest κ over the least one."""

STIFFENING = 2.0
"""Factor on κ while pairs that are very close come closer still."""

VERY_CLOSE = 1e-9
"""Distance, in bounding-box diagonals, below which a pair is very close."""


@dataclass(frozen=True)
class StiffnessBounds:
    """Bounds on κ for one range d̂; lengths in bounding-box diagonals, masses of 1."""

    least: float
    largest: float

    @classmethod
    def of(cls, d_hat: float, stiffness: float) -> StiffnessBounds:
        """κ that gives the barrier the curvature ``stiffness`` at the reference distance, and a hundred times that."""
        squared = REFERENCE_DISTANCE**2
        curvature = float(barrier(np.array([squared]), np.array([d_hat**2])).second[0])
        least = stiffness / (4.0 * squared * curvature)
        return cls(least, STIFFNESS_RANGE * least)

    def first(self, energy: FloatArray, contact: FloatArray) -> float:
        """κ that balances the gradients of the energy and of the barriers where both act, within the bounds."""
        squared = float((contact * contact).sum())
        balancing = -float((contact * energy).sum()) / squared if squared > 0.0 else 0.0
        return min(max(balancing, self.least), self.largest)

    def raised(self, kappa: float, before: dict[int, float], now: dict[int, float]) -> float:
        """κ after a step: doubled if a pair that was very close has not moved apart."""
        closer = any(now.get(pair, np.inf) <= distance for pair, distance in before.items())
        return min(STIFFENING * kappa, self.largest) if closer else kappa
