"""Expansion (Sacht et al. 2015, section 5): the fine mesh goes back step by step while the cage lowers its energy.

The fine mesh has infinite mass and goes back by one step of the flow with a prescribed velocity; the desired velocity
of the cage descends the gradient of its energy. A filter replaces the velocity of the cage by one without penetration.
Then the fine mesh rests while the cage lowers its energy further by filtered steps: one that raises the energy is
undone and halved, one that lowers it makes the next longer by a tenth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...contact.pairs import Bodies
from ...energies import CageEnergy
from ...geometry.arrays import FloatArray
from ...tasks import Stage

DESCENT_REDUCTION, DESCENT_GROWTH = 0.5, 1.1
"""Factors on the descent step after the energy has increased or decreased."""


class Filtered(NamedTuple):
    """Result of filtering a desired motion."""

    states: list[FloatArray]
    """Positions (m + n, 2) during the motion, free of collisions between each other."""
    arrived: bool
    """Whether the fine mesh reached its target."""


Filter = Callable[[FloatArray, FloatArray, FloatArray], Filtered]
"""Positions x (m + n, 2), wished motion of the cage (m, 2) and target of the fine mesh (n, 2) -> what is possible."""


@dataclass(frozen=True)
class Descent:
    """Descent of the cage's energy; lengths in bounding-box diagonals of the fine mesh."""

    first_step: float
    """First step, relative to the gradient of the energy."""
    smallest_step: float
    """Step at which the descent ends."""
    still: float
    """Motion of the cage at which the descent ends."""
    iterations: int
    """Maximum number of steps per step of the flow."""


class Expansion:
    """State of one reinflation."""

    def __init__(self, descent: Descent, bodies: Bodies, x: FloatArray) -> None:
        self.descent, self.bodies, self.x = descent, bodies, x

    def step_to(self, target: FloatArray, energy: CageEnergy, allowed: Filter) -> Stage[FloatArray, bool]:
        """Go back one step of the flow, to ``target`` (n, 2), and let the cage descend; False if that is blocked."""
        descent, m, successor = self.descent, self.bodies.m, self.bodies.cage.successor
        energy = energy.after(self.x[:m])
        step = descent.first_step
        lowest = np.inf
        for iteration in range(descent.iterations):
            gradient = energy.gradient(self.x[:m], successor)
            states, arrived = allowed(self.x, -step * gradient, target)
            after = energy.value(states[-1][:m], successor) if states else lowest
            if iteration == 0 or after <= lowest:
                motion = float(np.abs(states[-1][:m] - self.x[:m]).max()) if states else 0.0
                for state in states:
                    yield state
                    self.x = state
                if not arrived:
                    return False
                lowest = after
                step *= DESCENT_GROWTH
                if not gradient.any() or (iteration > 0 and motion < descent.still):
                    break
            else:
                step *= DESCENT_REDUCTION
                if step < descent.smallest_step:
                    break
        return True

    def blocking_vertex(self, target: FloatArray) -> str:
        """Which fine vertex is farthest from its target, in words."""
        worst = int(np.hypot(*(target - self.x[self.bodies.m :]).T).argmax())
        return f"the filter finds no velocity that lets fine vertex {worst} pass"
