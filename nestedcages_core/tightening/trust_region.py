"""Trust region: a radius per vertex.

See docs/ablation.md: radius per vertex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import TINY, FloatArray
from ..solver.quadratic_program import QPSolution
from .trial import Trial

# The step of a vertex is good if it was taken in full and restoration changed it little, and bad if it was
# reduced or restoration undid most of it.

BAD_CORRECTION, GOOD_CORRECTION = 0.6, 0.3
"""Correction by restoration, relative to the step, above which the step is bad and below which it is good."""

NEGLIGIBLE_CORRECTION = 0.2
"""Correction, as a fraction of the clearance, below which a step is good in any case. One below the clearance is never
bad."""

GROWTH, GROWTH_USAGE = 2.5, 0.6
"""Radius after a good step, relative to the step; fraction of Δ that the step must have used."""

SHRINKAGE, SHRINKAGE_TO_STEP = 0.4, 0.5
"""Radius after a bad step, relative to the step or to Δ, whichever is shorter; lower bound, relative to the part of the
step that was taken."""

SHRINKAGE_USAGE, MILD_SHRINKAGE = 0.3, 0.7
"""Fraction of Δ that a bad step must have used; otherwise Δ shrinks by the second factor."""

REJECTED_SHRINKAGE = 0.3
"""Upper bound on all Δ after a rejected step, relative to its longest motion."""

LARGEST_OVER_STEP, LARGEST_OVER_FIRST = 4.0, 0.1
"""Upper bound on all Δ, relative to the longest motion of the last step or to the first Δ, whichever is larger: smaller
radii have fewer candidate contacts."""

SMALLEST_RADIUS, COLLAPSED_RADIUS = 1e-7, 1e-6
"""Lower bound on Δ, and Δ at which the region has collapsed, relative to the mean coarse edge length."""

RECOVERED_RADIUS = 1e-5
"""Lower bound on Δ after an accepted step, relative to the mean coarse edge length."""

FAIR_GAIN, POOR_GAIN = 0.5, 0.25
"""Gain, the actual decrease of the energy over the predicted one, above which radii may grow, and below which a full
step was too long."""

TOO_LONG_SHRINKAGE = 0.4
"""Upper bound on all Δ after a step that was too long, relative to its longest motion."""


@dataclass(eq=False)
class TrustRegion:
    """Radii, updated by every step."""

    radius: FloatArray
    """(m,) Δ."""
    first: float
    """First Δ."""
    largest: float
    """Largest Δ allowed."""
    unit: float
    """Mean coarse edge length."""

    @classmethod
    def start(cls, m: int, first: float, largest: float, unit: float) -> TrustRegion:
        """m vertices; first and largest Δ and the unit are lengths."""
        return cls(np.full(m, first), first, largest, unit)

    def reset(self) -> None:
        """Raise all radii to the first one at least."""
        self.radius = np.maximum(self.radius, self.first)

    @property
    def collapsed(self) -> bool:
        """Whether all radii are too small for any progress."""
        return float(self.radius.max()) < COLLAPSED_RADIUS * self.unit

    def update(self, solution: QPSolution, trial: Trial, value: float, clearance: float, cage: FloatArray) -> None:
        """Update after a trial; value, cage (m, 2): energy and positions before it; clearance: a length."""
        step = np.hypot(solution.step[:, 0], solution.step[:, 1])
        longest = float(step.max())
        if not trial.accepted:
            self.radius = np.maximum(np.minimum(self.radius, REJECTED_SHRINKAGE * longest), SMALLEST_RADIUS * self.unit)
            return
        gain = (value - trial.value) / max(solution.decrease, TINY)
        correction = trial.x[: len(cage)] - cage - trial.fraction[:, None] * solution.step
        corrected = np.hypot(correction[:, 0], correction[:, 1])
        whole = trial.fraction >= 1.0
        bad = ~whole | ((corrected > BAD_CORRECTION * step) & (corrected > clearance))
        small = (corrected < GOOD_CORRECTION * step) | (corrected < NEGLIGIBLE_CORRECTION * clearance)
        good = whole & small & (step > GROWTH_USAGE * self.radius)

        shrunk = np.maximum(SHRINKAGE * np.minimum(self.radius, step), SHRINKAGE_TO_STEP * trial.fraction * step)
        shrunk = np.where(step > SHRINKAGE_USAGE * self.radius, shrunk, MILD_SHRINKAGE * self.radius)
        radius = np.where(bad, shrunk, self.radius)
        if gain > FAIR_GAIN:
            grown = np.maximum(radius, np.minimum(GROWTH * step, self.largest))
            radius = np.where(good, grown, radius)
        if gain < POOR_GAIN and not bad.any():
            radius = np.minimum(radius, TOO_LONG_SHRINKAGE * longest)
        radius = np.minimum(radius, max(LARGEST_OVER_STEP * longest, LARGEST_OVER_FIRST * self.first))
        self.radius = np.maximum(radius, RECOVERED_RADIUS * self.unit)
