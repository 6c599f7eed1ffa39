"""The radius within which the model is trusted, one for every vertex, and the shift of its Hessian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from ..solver.quadratic_program import QPSolution
from .trial import Trial

# How radii change with a step. A step was good where it was whole and restoration hardly changed it, and bad where it
# was shortened or restoration undid most of it.

LARGE_CORRECTION, SMALL_CORRECTION = 0.6, 0.3
"""Corrections by restoration that make a step bad and good, relative to it, ..."""

NEGLIGIBLE_CORRECTION = 0.2
"""... unless they are smaller than the clearance, for bad ones, and than this fraction of it, for good ones."""

WIDEN, USED = 2.5, 0.6
"""A good step that used more than this fraction of Δ raises it to so many times the step."""

NARROW, NARROW_TO_STEP, LITTLE_USED = 0.4, 0.5, 0.3
"""A bad step lowers Δ to this fraction of itself or of Δ, but not below the second fraction of what was kept of it. If
it used less than the third fraction of Δ ..."""

NARROW_SLIGHTLY = 0.7
"""... Δ is lowered to this fraction."""

REJECTED = 0.3
"""A step that was rejected lowers all Δ to this fraction of the longest motion."""

SLACK, FLOOR = 4.0, 0.1
"""After a step no Δ is larger than so many times the longest motion, unless it is smaller than this fraction of the
first Δ: the fewer contacts come into question."""

SMALLEST_RADIUS, COLLAPSED_RADIUS = 1e-7, 1e-6
"""Smallest Δ, and the Δ below which nothing can be gained, in units of the mean coarse edge length."""

RECOVERED_RADIUS = 1e-5
"""Smallest Δ after a step that was accepted, in the same units."""

# How the shift and the radii change with the gain, the actual decrease of the energy over the predicted one.

FAIR_GAIN, GOOD_GAIN, POOR_GAIN = 0.5, 0.7, 0.25
"""Gains above which radii may grow and the shift falls, and below which a whole step counts as too long."""

TOO_LONG = 0.4
"""A step that was too long lowers all Δ to this fraction of the longest motion."""

FIRST_SHIFT, SMALLEST_SHIFT = 0.1, 1e-4
"""First δ, and the δ below which it is dropped; the Hessian of the area is of size 1."""

LESS_SHIFT, MORE_SHIFT, REJECTED_SHIFT, RAISED_SHIFT = 1.0 / 3.0, 2.0, 3.0, 1e-2
"""Factors of δ after a good gain, a poor one and a rejection; what it is at least after the last two."""

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
    def start(cls, m: int, first: float, largest: float, unit: float) -> TrustRegion:
        """m vertices; first and largest Δ and the unit are lengths."""
        return cls(np.full(m, first), FIRST_SHIFT, first, largest, unit)

    def reset(self) -> None:
        """All radii at least as large as at the start."""
        self.radius = np.maximum(self.radius, self.first)

    @property
    def collapsed(self) -> bool:
        """Whether all radii are too small to gain anything."""
        return float(self.radius.max()) < COLLAPSED_RADIUS * self.unit

    def update(self, solution: QPSolution, trial: Trial, value: float, clearance: float, cage: FloatArray) -> None:
        """Learn from a trial; value and cage (m, 2) are those before it."""
        step = np.hypot(solution.step[:, 0], solution.step[:, 1])
        longest = float(step.max())
        if not trial.accepted:
            self.radius = np.maximum(np.minimum(self.radius, REJECTED * longest), SMALLEST_RADIUS * self.unit)
            self.shift = max(REJECTED_SHIFT * self.shift, RAISED_SHIFT)
            return
        gain = (value - trial.value) / max(solution.decrease, TINY)
        correction = trial.x[: len(cage)] - cage - trial.fraction[:, None] * solution.step
        corrected = np.hypot(correction[:, 0], correction[:, 1])
        whole = trial.fraction >= 1.0
        bad = ~whole | ((corrected > LARGE_CORRECTION * step) & (corrected > clearance))
        small = (corrected < SMALL_CORRECTION * step) | (corrected < NEGLIGIBLE_CORRECTION * clearance)
        good = whole & small & (step > USED * self.radius)

        narrow = np.maximum(NARROW * np.minimum(self.radius, step), NARROW_TO_STEP * trial.fraction * step)
        narrow = np.where(step > LITTLE_USED * self.radius, narrow, NARROW_SLIGHTLY * self.radius)
        radius = np.where(bad, narrow, self.radius)
        if gain > FAIR_GAIN:
            wide = np.maximum(radius, np.minimum(WIDEN * step, self.largest))
            radius = np.where(good, wide, radius)
        if gain > GOOD_GAIN:
            self.shift = LESS_SHIFT * self.shift if self.shift > SMALLEST_SHIFT else 0.0
        elif gain < POOR_GAIN and not bad.any():
            radius = np.minimum(radius, TOO_LONG * longest)
            self.shift = max(MORE_SHIFT * self.shift, RAISED_SHIFT)
        radius = np.minimum(radius, max(SLACK * longest, FLOOR * self.first))
        self.radius = np.maximum(radius, RECOVERED_RADIUS * self.unit)
