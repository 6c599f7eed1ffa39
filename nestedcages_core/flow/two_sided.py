"""The default flow: the fine mesh descends the energy of its penetration until it is certified inside the coarse one.

First with samples at the vertices of both meshes, then along both boundaries.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import TINY
from ..geometry.mesh import Mesh, Nesting
from ..geometry.precision import PATIENCE
from ..geometry.vectors import bounds
from ..parameters import check_count, check_positive
from ..progress import Tick, no_tick
from .base import FlowResult, stuck
from .containment import obstacle
from .matching import match_loops
from .penetration import PenetrationEnergy, Spacing
from .step_system import StepSystem

logger = logging.getLogger(__name__)

SLOW = 0.25
"""Part of the energy from which on that which a step leaves halves the smoothing of the next."""

HOPELESS = 0.5
"""Part of the energy from which on that which `PATIENCE` steps leave ends a descent."""


@dataclass(frozen=True)
class TwoSidedFlow:
    """Descent of the penetration measured from both boundaries, loop by loop; lengths in extents of the fine mesh."""

    margin: float = 3e-3
    """Distance to the coarse mesh that the descent aims at."""
    spacing: float = 1.0 / 300.0
    """Distance between samples along the boundaries."""
    smoothing: float = 0.01
    """Smoothing length of a step at first."""
    longest_step: float = 0.04
    """Maximum motion of a coordinate per step."""
    vertex_limit: int = 6
    """Maximum number of steps with samples at the vertices only (docs/numbers.md: flow: steps with samples at
    vertices)."""
    limit: int = 20
    """Maximum number of steps of every other descent."""

    def __post_init__(self) -> None:
        check_positive(self, "margin", "spacing", "smoothing", "longest_step")
        check_count(self, "vertex_limit", "limit")

    def run(self, fine: Mesh, coarse: Mesh, *, tick: Tick = no_tick) -> FlowResult:
        """All steps from the fine mesh to a certified position strictly inside the coarse one.

        tick: called with the fraction done.

        Raises: FlowError with the loop, the place and the cause, and the FlowResult so far as `partial`.
        """
        unit, matching = fine.extent, match_loops(fine, coarse)
        steps, iterations = [fine.vertices], 0
        (low, high), (fine_low, fine_high) = bounds(coarse.vertices), bounds(fine.vertices)
        tick(0.0)
        if (low < fine_low).all() and (fine_high < high).all() and Nesting(coarse, fine).encloses():
            return FlowResult(np.array(steps), 0, "inside")
        system = StepSystem(fine, self.spacing * unit)
        for stage, spacing, limit in (("vertices", np.inf, self.vertex_limit), ("boundary", self.spacing, self.limit)):
            density = Spacing(spacing * unit, self.spacing * unit)
            energy = PenetrationEnergy(fine, coarse, matching, self.margin * unit, density)
            here, smoothing = energy.at(steps[-1]), self.smoothing * unit
            energies = [here.energy]
            while not (here.overlap < 0.0 and obstacle(fine, coarse, steps[-1]) is None):
                taken = len(energies) - 1
                if taken == limit or (taken >= PATIENCE and here.energy >= HOPELESS * energies[-1 - PATIENCE]):
                    break
                tick((iterations + taken) / (self.vertex_limit + self.limit))
                direction = system.direction(here, smoothing)
                longest = max(float(np.abs(direction).max()), TINY)
                moved = steps[-1] + min(1.0, self.longest_step * unit / longest) * direction
                after = energy.at(moved)
                if after.energy > SLOW * here.energy:
                    smoothing *= 0.5
                if after.energy < here.energy:
                    steps.append(moved)
                    here = after
                energies.append(here.energy)
            iterations += len(energies) - 1
            result = FlowResult(np.array(steps), iterations, stage, obstacle(fine, coarse, steps[-1]))
            logger.debug("flow by %s: %d steps so far", stage, len(steps) - 1)
            if result.obstacle is None:
                return result
        raise stuck(result)
