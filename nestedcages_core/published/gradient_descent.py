"""Gradient descent with backtracking, the solver of the paper (Gurditta & Jacobson 2022, section 3.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from ..parameters import check_count, check_flag, check_positive, check_reduction
from ..solver.newton import Objective, SolverResult


@dataclass(frozen=True)
class GradientDescent:
    """x ← x - t ∇E, a fixed number of times, with t reduced until E decreases enough.

    Backtracking after Boyd & Vandenberghe 2004, algorithm 9.2. t has no unit if the energy is a length²: the descent
    does not depend on scale.
    """

    steps: int = 100
    """Number of steps of one minimisation: the only stopping criterion of the paper."""
    first_step: float = 0.05
    """First t."""
    contraction: float = 0.5
    """β, the factor on a rejected t, between 0 and 1."""
    sufficient_decrease: float = 0.1
    """α, the required fraction of the predicted decrease, between 0 and 1."""
    smallest_step: float = 1e-15
    """Lower bound on t, at which the search ends."""
    refuse_infinite: bool = False
    """Repair: reject states of infinite energy, even from a state of infinite energy."""

    def __post_init__(self) -> None:
        check_count(self, "steps", least=0)
        check_positive(self, "first_step", "smallest_step")
        check_reduction(self, "contraction", "sufficient_decrease")
        check_flag(self, "refuse_infinite")

    def minimise(self, objective: Objective, x: FloatArray, on_step: Callable[[FloatArray], None]) -> SolverResult:
        """Minimise from x; see :class:`nestedcages_core.solver.newton.Solver`."""
        for iteration in range(self.steps):
            if objective.finished(x):
                return SolverResult(x, iteration, True)
            with np.errstate(over="ignore", invalid="ignore"):  # of meshes after a step from an infinite energy
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
            # as published: ∞ > ∞ is false, so from an infinite energy the first step is taken, wherever it leads
            refused = after > value - self.sufficient_decrease * t * predicted
            if not refused and (np.isfinite(after) or not self.refuse_infinite):
                return candidate
            t *= self.contraction
        return None
