"""The interface of solvers, and projected Newton: the positive semi-definite part of every element's Hessian."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.precision import BACKTRACKING, INPUT_ROUND_OFF, MOST_STEPS, SUFFICIENT_DECREASE
from ..parameters import check_count, check_not_negative

__all__ = ["ProjectedNewton"]

STALLED_AFTER = 12
"""Number of steps that must together gain more than the tolerance of one step; otherwise contact blocks them."""


@dataclass(frozen=True)
class ProjectedNewton:
    """Newton steps with backtracking until the predicted decrease is small.

    Named as further work by Gurditta & Jacobson 2022.
    """

    tolerance: float = 1e-3
    """Stop when the predicted decrease is below this fraction of the first one."""
    max_iterations: int = MOST_STEPS
    """Cap on the steps."""

    def __post_init__(self) -> None:
        check_not_negative(self, "tolerance")
        check_count(self, "max_iterations", least=0)

    def minimise(self, objective: Objective, x: FloatArray, on_step: Callable[[FloatArray], None]) -> SolverResult:
        """Minimise from x; see :class:`nestedcages_core.solver.newton.Solver`."""
        first_decrement = 0.0
        values: list[float] = []
        for iteration in range(self.max_iterations):
            if objective.finished(x):
                return SolverResult(x, iteration, True)
            model = objective.newton(x)
            decrement = -float((model.gradient * model.direction).sum())
            first_decrement = max(first_decrement, decrement)
            if decrement <= self.tolerance * first_decrement:
                return SolverResult(x, iteration, True)
            values.append(model.value)
            gain = values[-1 - STALLED_AFTER] - model.value if iteration >= STALLED_AFTER else np.inf
            if gain <= self.tolerance * first_decrement:
                return SolverResult(x, iteration, False)
            after = backtrack(objective, x, model)
            if after is None:
                return SolverResult(x, iteration + 1, False)
            x = after
            on_step(x)
        return SolverResult(x, self.max_iterations, objective.finished(x))


class NewtonModel(NamedTuple):
    """Value, gradient and Newton direction at a state."""

    value: float
    gradient: FloatArray
    """Same shape as the state."""
    direction: FloatArray
    """Same shape as the state: -H⁻¹ gradient for a positive definite H."""


class Objective(Protocol):
    """A function to minimise over states x, arrays of positions (k, 2)."""

    def value(self, x: FloatArray) -> float:
        """The objective; infinite where the state is invalid."""

    def slope(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Value, which may be infinite, and gradient, which is finite."""

    def newton(self, x: FloatArray) -> NewtonModel:
        """Value, gradient and projected Newton direction at a valid state."""

    def largest_step(self, x: FloatArray, direction: FloatArray) -> float:
        """Largest fraction of ``direction``, at most 1, along which all states are valid."""

    def finished(self, x: FloatArray) -> bool:
        """Whether to stop regardless of the gradient, as the goal of the minimisation is reached."""


@dataclass(frozen=True, eq=False)
class SolverResult:
    """Where a solver ended."""

    x: FloatArray
    iterations: int
    converged: bool
    """Whether the objective is finished or stationary; otherwise a cap or a blocked step ended the minimisation."""


class Solver(Protocol):
    """Lowers an objective step by step."""

    def minimise(self, objective: Objective, x: FloatArray, on_step: Callable[[FloatArray], None]) -> SolverResult:
        """Minimise from the valid state x; on_step: called with every accepted state."""


def backtrack(objective: Objective, x: FloatArray, model: NewtonModel) -> FloatArray | None:
    """The first state with sufficient decrease among the longest safe step and its halvings; None if there is none."""
    slope = float((model.gradient * model.direction).sum())
    fraction = longest = objective.largest_step(x, model.direction)
    while fraction > INPUT_ROUND_OFF * longest:
        candidate = x + fraction * model.direction
        value = objective.value(candidate)
        if np.isfinite(value) and value <= model.value + SUFFICIENT_DECREASE * fraction * slope:
            return candidate
        fraction *= BACKTRACKING
    return None
