"""Descent of the penetration energy by smoothed Gauss-Newton steps until the fine mesh is certified inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._types import FloatArray
from .base import Obstacle
from .containment import Containment
from .penetration import Penetration, PenetrationEnergy
from .smoothing import StepSystem

SUFFICIENT_DECREASE = 1e-4
"""Share of the step length by which the energy must fall at least."""

HALVINGS = 7
"""Trials of the line search."""

STALL_GAIN = 0.02
"""A step that gains a smaller share of the energy counts as stalled; the next one is smoothed over half the length."""

STALLS = 4
"""Stalled steps in a row that end the descent."""

LEAST_SMOOTHING = 0.01
"""Smallest smoothing length as a share of the first."""

MARGIN_STEPS = 3
"""Steps after the first certified position that may still widen the margin."""


@dataclass(frozen=True, eq=False)
class Descent:
    """Outcome of one descent."""

    steps: list[FloatArray]
    """Positions (n, 2) after each accepted step; the start is not among them."""
    obstacle: Obstacle | None
    """None if the last position is certified inside, else what is in the way there."""
    iterations: int
    """Steps tried, rejected ones included."""


@dataclass(frozen=True, eq=False)
class EnergyFlow:
    """Descent of one energy; lengths in the units of the mesh."""

    energy: PenetrationEnergy
    containment: Containment
    system: StepSystem
    smoothing: float
    """First smoothing length."""
    longest_step: float
    """Cap on the motion of a coordinate per step."""

    def descend(self, start: FloatArray, limit: int) -> Descent:
        """At most ``limit`` steps from (n, 2) positions until certified inside and at a good distance.

        Positions that seem to be inside may be left for a few steps to gain distance; the last certified one counts.
        """
        vertices, penetration = start, self.energy.at(start)
        steps: list[FloatArray] = []
        seem_inside: list[int] = []
        smoothing, stalls, iterations = self.smoothing, 0, 0
        while True:
            inside = penetration.overlap < 0.0
            if inside:
                seem_inside.append(len(steps))
            content = penetration.comfortable or stalls > 0 or len(seem_inside) > MARGIN_STEPS
            if inside and content and self.containment.obstacle(vertices) is None:
                return Descent(steps, None, iterations)
            if iterations >= limit or stalls > STALLS or penetration.energy == 0.0:
                break
            iterations += 1
            found = self._step(vertices, penetration, smoothing)
            gain = 0.0
            if found is not None:
                gain = 1.0 - found[1].energy / penetration.energy
                vertices, penetration = found
                steps.append(vertices)
            stalls = 0 if gain >= STALL_GAIN else stalls + 1
            if stalls:
                smoothing = max(0.5 * smoothing, LEAST_SMOOTHING * self.smoothing)
        for count in reversed(seem_inside):
            if self.containment.obstacle(steps[count - 1] if count else start) is None:
                return Descent(steps[:count], None, iterations)
        return Descent(steps, self.containment.obstacle(vertices), iterations)

    def _step(
        self, vertices: FloatArray, penetration: Penetration, smoothing: float
    ) -> tuple[FloatArray, Penetration] | None:
        """Positions with less energy along the Gauss-Newton direction, or None."""
        direction = self.system.direction(penetration, smoothing)
        longest = float(np.abs(direction).max())
        length = min(1.0, self.longest_step / longest) if longest > 0.0 else 1.0
        for _ in range(HALVINGS):
            moved = vertices + length * direction
            after = self.energy.at(moved)
            if after.energy < (1.0 - SUFFICIENT_DECREASE * length) * penetration.energy:
                return moved, after
            length *= 0.5
        return None
