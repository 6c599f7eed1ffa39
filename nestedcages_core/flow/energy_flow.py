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

RELATIVE_DECREASE = 1e-4
"""Smallest relative decrease of the energy, per step length."""

MAX_STEP_TRIALS = 7
"""Cap on the trials of the line search, each half as long."""

STALL_DECREASE = 0.02
"""Relative decrease of the energy below which a step has stalled."""

SLOW_DECREASE = 0.75
"""Relative decrease of the energy below which the next step is smoothed over half the length."""

MAX_SLOW_STEPS, SLOW_STEPS_LEAVE = 4, 0.5
"""The descent fails if this many steps leave more than this fraction of the energy."""

LEAST_SMOOTHING = 0.01
"""Smallest smoothing length, as a fraction of the first."""

MARGIN_STEPS = 3
"""Cap on further steps from the first position inside, to widen the margin."""


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
        """At most ``limit`` steps from (n, 2) positions until certified inside at a good distance.

        A generator: yields the fraction of the limit before every step and returns the outcome. Descent continues for
        a few steps inside to gain distance; the result is the last certified position.
        """
        vertices, penetration = start, self.energy.at(start)
        steps: list[FloatArray] = []
        seem_inside: list[int] = []
        energies = [penetration.energy]
        smoothing = self.smoothing
        while True:
            inside = penetration.overlap < 0.0
            if inside:
                seem_inside.append(len(steps))
            stalled = len(energies) > 1 and energies[-1] > (1.0 - STALL_DECREASE) * energies[-2]
            good_enough = penetration.comfortable or stalled or len(seem_inside) > MARGIN_STEPS
            if inside and good_enough and self.containment.obstacle(vertices) is None:
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
        for count in reversed(seem_inside):
            if self.containment.obstacle(steps[count - 1] if count else start) is None:
                return Descent(start, steps[:count], None, len(energies) - 1)
        return Descent(start, steps, self.containment.obstacle(vertices), len(energies) - 1)

    def _step(
        self, vertices: FloatArray, penetration: Penetration, smoothing: float
    ) -> tuple[FloatArray, Penetration] | None:
        """Positions of lower energy along the Gauss-Newton direction, or None."""
        direction = self.system.direction(penetration, smoothing)
        longest = float(np.abs(direction).max())
        length = min(1.0, self.longest_step / longest) if longest > 0.0 else 1.0
        for _ in range(MAX_STEP_TRIALS):
            moved = vertices + length * direction
            after = self.energy.at(moved)
            if after.energy < (1.0 - RELATIVE_DECREASE * length) * penetration.energy:
                return moved, after
            length *= 0.5
        return None
