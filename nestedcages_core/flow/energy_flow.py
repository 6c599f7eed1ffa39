"""Descent of the penetration energy by smoothed Gauss-Newton steps, until the fine mesh is certified inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from ..tasks import Stage
from .base import Obstacle
from .containment import Containment
from .penetration import Penetration, PenetrationEnergy
from .smoothing import StepSystem

SLOW_DECREASE = 0.75
"""Relative decrease of the energy below which the next step is smoothed over half the length."""

MAX_SLOW_STEPS, SLOW_STEPS_LEAVE = 4, 0.5
"""The descent fails if this many steps leave more than this fraction of the energy."""

LEAST_SMOOTHING = 0.01
"""Smallest smoothing length, as a fraction of the first."""


@dataclass(frozen=True, eq=False)
class Descent:
    """Outcome of one descent."""

    start: FloatArray
    """(n, 2) positions before the first step."""
    steps: list[FloatArray]
    """Positions (n, 2) after each accepted step."""
    obstacle: Obstacle | None
    """None if the last position is certified inside, else the obstacle."""
    iterations: int
    """Number of steps, rejected ones included."""


@dataclass(frozen=True, eq=False)
class EnergyFlow:
    """Descent of one energy; lengths in the units of the mesh."""

    energy: PenetrationEnergy
    containment: Containment
    system: StepSystem
    smoothing: float
    """First smoothing length."""
    longest_step: float
    """Cap on the change of a coordinate per step."""

    def descend(self, start: FloatArray, limit: int) -> Stage[float, Descent]:
        """At most ``limit`` steps from (n, 2) positions until certified inside.

        A generator: yields the fraction of the limit before every step and returns the outcome.
        """
        vertices, penetration = start, self.energy.at(start)
        steps: list[FloatArray] = []
        energies = [penetration.energy]
        smoothing = self.smoothing
        while True:
            if penetration.overlap < 0.0 and self.containment.obstacle(vertices) is None:
                return Descent(start, steps, None, len(energies) - 1)
            hopeless = (
                len(energies) > MAX_SLOW_STEPS and energies[-1] > SLOW_STEPS_LEAVE * energies[-1 - MAX_SLOW_STEPS]
            )
            if len(energies) > limit or hopeless or penetration.energy == 0.0:
                break
            yield (len(energies) - 1) / limit
            found = self._step(vertices, penetration, smoothing)
            if found is not None:
                vertices, penetration = found
                steps.append(vertices)
            energies.append(penetration.energy)
            if energies[-1] > (1.0 - SLOW_DECREASE) * energies[-2]:
                smoothing = max(0.5 * smoothing, LEAST_SMOOTHING * self.smoothing)
        return Descent(start, steps, self.containment.obstacle(vertices), len(energies) - 1)

    def _step(
        self, vertices: FloatArray, penetration: Penetration, smoothing: float
    ) -> tuple[FloatArray, Penetration] | None:
        """Positions of lower energy along the Gauss-Newton direction, or None."""
        direction = self.system.direction(penetration, smoothing)
        longest = float(np.abs(direction).max())
        length = min(1.0, self.longest_step / longest) if longest > 0.0 else 1.0
        moved = vertices + length * direction
        after = self.energy.at(moved)
        return (moved, after) if after.energy < penetration.energy else None
