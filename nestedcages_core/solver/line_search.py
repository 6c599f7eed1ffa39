"""Backtracking line search over valid states."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.precision import INPUT_ROUND_OFF

if TYPE_CHECKING:
    from .base import NewtonModel, Objective

SUFFICIENT_DECREASE = 1e-4
"""Armijo's constant: fraction of the predicted decrease that a step must reach (Nocedal & Wright 2006, section 3.1)."""


class Step(NamedTuple):
    """An accepted step; ``fraction`` is 0 if there is none."""

    x: FloatArray
    fraction: float


def backtrack(objective: Objective, x: FloatArray, model: NewtonModel) -> Step:
    """First step with sufficient decrease among the longest safe one and its halvings."""
    slope = float((model.gradient * model.direction).sum())
    fraction = longest = objective.largest_step(x, model.direction)
    while fraction > INPUT_ROUND_OFF * longest:
        candidate = x + fraction * model.direction
        value = objective.value(candidate)
        if np.isfinite(value) and value <= model.value + SUFFICIENT_DECREASE * fraction * slope:
            return Step(candidate, fraction)
        fraction *= 0.5
    return Step(x, 0.0)
