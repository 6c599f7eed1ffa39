"""The radius within which the linear model of the contacts is trusted, one for every vertex, and the shift of the
quadratic model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .._types import FloatArray
from ..solver.quadratic_program import Solution
from .trial import Trial

if TYPE_CHECKING:
    from .tightening import Tightening

FIRST_SHIFT = 0.1
"""First δ."""

SMALLEST_SHIFT = 1e-4
"""δ below which it is dropped."""

SMALLEST_RADIUS = 1e-5
"""Smallest Δ after an accepted step, in units of the mean coarse edge length."""

COLLAPSED_RADIUS = 1e-6
"""Δ below which nothing can be gained, in the same units."""


TINY = float(np.finfo(float).tiny)
"""Guards divisions."""


@dataclass(eq=False)
class TrustRegion:
    """Radii and shift, changed by every step."""

    radius: FloatArray
    """(m,) Δ."""
    shift: float
    """δ."""
    first: float
    """First Δ."""
    largest: float
    """Largest Δ allowed."""
    unit: float
    """Mean coarse edge length."""

    @classmethod
    def start(cls, m: int, settings: Tightening, unit: float) -> TrustRegion:
        first = settings.first_radius * unit
        return cls(np.full(m, first), FIRST_SHIFT, first, settings.largest_radius * unit, unit)

    def reset(self) -> None:
        """All radii at least as large as at the start."""
        self.radius = np.maximum(self.radius, self.first)

    @property
    def collapsed(self) -> bool:
        """Whether all radii are too small to gain anything."""
        return float(self.radius.max()) < COLLAPSED_RADIUS * self.unit

    def update(self, solution: Solution, trial: Trial, value: float, clearance: float, cage: FloatArray) -> None:
        """Learn from a trial; value and cage (m, 2) are those before it."""
        longest = np.hypot(solution.step[:, 0], solution.step[:, 1])
        if not trial.accepted:
            self.radius = np.maximum(np.minimum(self.radius, 0.3 * longest.max()), 1e-7 * self.unit)
            self.shift = max(3.0 * self.shift, 1e-2)
            return
        gain = (value - trial.value) / max(solution.decrease, TINY)
        corrected = trial.x[: len(cage)] - cage - trial.fraction[:, None] * solution.step
        correction = np.hypot(corrected[:, 0], corrected[:, 1])
        share = correction / np.maximum(longest, TINY)
        whole = trial.fraction >= 1.0
        bad = ~whole | ((share > 0.6) & (correction > clearance))
        good = whole & ((share < 0.3) | (correction < 0.2 * clearance)) & (longest > 0.6 * self.radius)
        tighter = np.maximum(0.4 * np.minimum(self.radius, longest), 0.5 * trial.fraction * longest)
        self.radius = np.where(bad, np.where(longest > 0.3 * self.radius, tighter, 0.7 * self.radius), self.radius)
        if gain > 0.5:
            wider = np.maximum(self.radius, np.minimum(2.5 * longest, self.largest))
            self.radius = np.where(good, wider, self.radius)
        if gain > 0.7:
            self.shift = solution.shift / 3.0 if solution.shift > SMALLEST_SHIFT else 0.0
        elif gain < 0.25 and not bad.any():
            self.radius = np.maximum(np.minimum(self.radius, 0.4 * longest.max()), 1e-7 * self.unit)
            self.shift = max(2.0 * solution.shift, 1e-2)
        else:
            self.shift = solution.shift
        self.radius = np.maximum(self.radius, SMALLEST_RADIUS * self.unit)
