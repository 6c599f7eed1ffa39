"""Trust region: how far vertices may move in a step (Conn, Gould & Toint 2000, algorithm 6.1.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import TINY, FloatArray
from ..geometry.precision import NEGLIGIBLE
from ..solver.quadratic_program import QPSolution
from .trial import STEP_REDUCTION, Trial

FAIR_GAIN, POOR_GAIN = 0.5, 0.25
"""Gain, the actual decrease of the energy over the predicted one, above which the radius may grow and below which it
shrinks."""

GROWTH = 2.5
"""Factor on the longest motion of a good step, for the radius after it."""


@dataclass(eq=False)
class TrustRegion:
    """The radius Δ, updated by every step; lengths."""

    largest_step: float
    """Δ."""
    first: float
    """First Δ."""
    largest: float
    """Largest Δ allowed."""
    unit: float
    """Mean coarse edge length."""
    m: int
    """Number of vertices."""

    @property
    def radius(self) -> FloatArray:
        """(m,) Δ of each vertex."""
        return np.full(self.m, self.largest_step)

    def reset(self) -> None:
        """Raise the radius to the first one at least."""
        self.largest_step = max(self.largest_step, self.first)

    @property
    def collapsed(self) -> bool:
        """Whether the radius is too small for any progress."""
        return self.largest_step < NEGLIGIBLE * self.unit

    def update(self, solution: QPSolution, trial: Trial, value: float) -> None:
        """Update after a trial; value: the energy before it."""
        longest = float(np.hypot(solution.step[:, 0], solution.step[:, 1]).max())
        gain = (value - trial.value) / max(solution.decrease, TINY)
        if not trial.accepted or gain < POOR_GAIN:
            self.largest_step = min(self.largest_step, STEP_REDUCTION * longest)
        elif gain > FAIR_GAIN:
            self.largest_step = max(self.largest_step, min(GROWTH * longest, self.largest))
