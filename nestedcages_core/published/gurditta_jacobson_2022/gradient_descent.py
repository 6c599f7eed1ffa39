"""Gradient descent with backtracking: the paper's solver, as written (Gurditta & Jacobson 2022, section 3.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray
from ...solver.base import Objective, SolverResult


@dataclass(frozen=True)
class GradientDescent:
    """x ← x - t ∇E, a fixed number of times, with t halved until E has fallen enough (Boyd & Vandenberghe 2004,
    algorithm 9.2).

    Steps have no unit where the energy is a length²: the same descent at any size of the drawing.
    """

    steps: int = 100
    """Descent steps of one minimisation; the paper has no other way to end it."""
    first_step: float = 0.05
    """The first t tried."""
    contraction: float = 0.5
    """β, the factor on a t that was refused."""
    sufficient_decrease: float = 0.1
    """α, the fraction of the decrease that the gradient predicts."""
    smallest_step: float = 1e-15
    """t below which the search ends."""
    refuse_infinite: bool = False
    """Repair: an infinite energy is no decrease, even when it was infinite before."""

    def minimise(self, objective: Objective, x: FloatArray, on_step: Callable[[FloatArray], None]) -> SolverResult:
        """Minimise from x; see :class:`nestedcages_core.solver.base.Solver`."""
        for iteration in range(self.steps):
            if objective.finished(x):
                return SolverResult(x, iteration, True)
            with np.errstate(over="ignore", invalid="ignore"):  # of meshes thrown by an infinite energy
                step = self._step(objective, x)
            if step is None:
                return SolverResult(x, iteration + 1, False)
            x = step
            on_step(x)
        return SolverResult(x, self.steps, objective.finished(x))

    def _step(self, objective: Objective, x: FloatArray) -> FloatArray | None:
        """The state after one step; None when no step lowers the energy."""
        value, gradient = objective.slope(x)
        predicted = float((gradient * gradient).sum())
        if not np.isfinite(predicted):
            return None
        t = self.first_step * objective.largest_step(x, -self.first_step * gradient)
        while t > self.smallest_step:
            candidate = x - t * gradient
            after = objective.value(candidate)
            # E = ∞ refuses nothing: ∞ > ∞ is false, and the first step is taken, wherever it leads
            refused = after > value - self.sufficient_decrease * t * predicted
            if not refused and (np.isfinite(after) or not self.refuse_infinite):
                return candidate
            t *= self.contraction
        return None
