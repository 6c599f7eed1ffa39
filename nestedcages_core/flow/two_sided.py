"""The default flow: from the fine mesh into the coarse one in few steps, by the cheapest method that succeeds.

In this order: inside (nothing to do); vertices (descent with samples at the vertices of both meshes); boundary (descent
with samples along both boundaries).
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import partial

import numpy as np

from ..geometry.mesh import Mesh, Nesting
from ..geometry.vectors import bounds
from ..parameters import check_count, check_positive
from ..progress import Tick, no_tick
from .base import FlowResult, stuck
from .containment import Containment
from .energy_flow import EnergyFlow, StepSystem
from .loop_matching import match_loops
from .penetration import PenetrationEnergy, Spacing

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class TwoSidedFlow:
    """Descent of the penetration measured from both boundaries, loop by loop; lengths in extents of the fine mesh."""

    margin: float = 3e-3
    """Distance to the coarse mesh that the descent aims at."""
    spacing: float = 1.0 / 300.0
    """Distance between samples along the boundaries."""
    smoothing: float = 0.01
    """Initial smoothing length of a step."""
    longest_step: float = 0.04
    """Maximum motion of a coordinate per step."""
    vertex_limit: int = 6
    """Maximum number of steps with samples at the vertices only (docs/ablation.md: flow: steps with samples at
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
        matching, unit = match_loops(fine, coarse), fine.extent
        containment, system = Containment(matching), StepSystem(fine, self.spacing * unit)
        steps, iterations = [fine.vertices], 0
        (low, high), (fine_low, fine_high) = bounds(coarse.vertices), bounds(fine.vertices)
        tick(0.0)
        if (low < fine_low).all() and (fine_high < high).all() and Nesting(coarse, fine).encloses():
            return FlowResult(np.array(steps), 0, "inside")
        stages = ("vertices", np.inf, self.vertex_limit), ("boundary", self.spacing, self.limit)
        for tried, (stage, spacing, limit) in enumerate(stages):
            density = Spacing(spacing * unit, self.spacing * unit)
            energy = PenetrationEnergy(matching, self.margin * unit, density)
            _show(tick, tried, 0.0)  # many loops take long
            flow = EnergyFlow(energy, containment, system, self.smoothing * unit, self.longest_step * unit)
            descent = flow.descend(steps[-1], limit, partial(_show, tick, tried))
            steps, iterations = steps + descent.steps, iterations + descent.iterations
            logger.debug("flow by %s: %d steps, %d iterations so far", stage, len(steps) - 1, iterations)
            if descent.obstacle is None:
                break
        result = FlowResult(np.array(steps), iterations, stage, descent.obstacle)
        if result.obstacle is not None:
            raise stuck(result)
        return result


def _show(tick: Tick, tried: int, done: float) -> None:
    """Call with the fraction of the flow that is done, if every further stage takes half of the rest."""
    tick(1.0 - 0.5**tried * (1.0 - 0.5 * done))
