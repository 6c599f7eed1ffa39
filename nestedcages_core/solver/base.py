"""What a solver of minimisation problems needs and gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from ..geometry.arrays import FloatArray


class NewtonModel(NamedTuple):
    """The objective near a state: enough to take a step."""

    value: float
    gradient: FloatArray
    """Same shape as the state."""
    direction: FloatArray
    """Same shape as the state: minus the gradient times the inverse of a positive definite matrix."""


class Objective(Protocol):
    """Something to minimise over states x, arrays of positions (k, 2)."""

    def value(self, x: FloatArray) -> float:
        """The objective; infinite where the state is invalid."""
        ...

    def slope(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Value and gradient; the value may be infinite, the gradient may not."""
        ...

    def newton(self, x: FloatArray) -> NewtonModel:
        """Value, gradient and projected Newton direction at a valid state."""
        ...

    def largest_step(self, x: FloatArray, direction: FloatArray) -> float:
        """Largest fraction of ``direction``, at most 1, that keeps the state valid all the way."""
        ...

    def finished(self, x: FloatArray) -> bool:
        """Whether the purpose of the minimisation is reached, whatever the gradient says."""
        ...


@dataclass(frozen=True, eq=False)
class SolverResult:
    """Where a solver ended."""

    x: FloatArray
    iterations: int
    converged: bool
    """Finished, or stationary by the solver's own measure; otherwise a cap or a blocked step ended it."""


class Solver(Protocol):
    """Takes steps that lower an objective until there is nothing to gain."""

    def minimise(self, objective: Objective, x: FloatArray, on_step: Callable[[FloatArray], None]) -> SolverResult:
        """Minimise from the valid state x; ``on_step`` sees every accepted state and may raise to cancel."""
        ...
