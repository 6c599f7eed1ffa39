"""Backtracking line search that never accepts an invalid state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray
from .base import NewtonModel, Objective

SUFFICIENT_DECREASE = 1e-4
"""Armijo's constant: the fraction of the predicted decrease that a step must achieve (Nocedal & Wright 2006, section
3.1)."""

CONTRACTION = 0.5
"""Factor by which a refused step is shortened."""

MAX_HALVINGS = 40
"""Cap of the search: beyond it a step is below round-off."""


class Step(NamedTuple):
    """An accepted step, or ``fraction`` zero where none was found."""

    x: FloatArray
    fraction: float


def backtrack(objective: Objective, x: FloatArray, model: NewtonModel) -> Step:
    """Longest step along the model's direction, among halvings of the longest safe one, that lowers the objective
    enough."""
    slope = float((model.gradient * model.direction).sum())
    fraction = objective.largest_step(x, model.direction)
    for _ in range(MAX_HALVINGS):
        candidate = x + fraction * model.direction
        value = objective.value(candidate)
        if np.isfinite(value) and value <= model.value + SUFFICIENT_DECREASE * fraction * slope:
            return Step(candidate, fraction)
        fraction *= CONTRACTION
    return Step(x, 0.0)
