"""Incremental Potential Contact: minimise a barrier energy by collision-free steps, as in the paper."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..energies import Area, Energy
from ..geometry.arrays import FloatArray
from ..geometry.precision import MOST_ROUNDS
from ..parameters import check_not_negative, check_part, check_positive
from ..solver.newton import ProjectedNewton, Solver
from .base import ContactOutcome, OnStep, farthest_vertex, no_step
from .incremental_potential import IncrementalPotential, PotentialWeights
from .pairs import Bodies, CandidateList

__all__ = ["IPC"]

logger = logging.getLogger(__name__)


STIFFENING = 4.0
"""Factor on λ_R where the minimum of the energy leaves the fine mesh short of its target."""


@dataclass(frozen=True)
class IPC:
    """Minimise λ_R R + λ_cages E_cages + λ_B B for each target of the path (Gurditta & Jacobson 2022, section 3.2).

    Lengths are relative to the mean coarse edge length, weights per length of boundary, so that no shape needs tuning.
    """

    solver: Solver = field(default_factory=ProjectedNewton)
    """Minimises the sum."""
    energy: Energy = field(default_factory=Area)
    """E_cages."""
    barrier_range: float = 0.1
    """d̂ as a fraction of the mean coarse edge length."""
    restoring: float = 100.0
    """λ_R · d̂: pull towards the target at the distance d̂, relative to the pressure of the area."""
    cages: float = 1.0
    """λ_cages."""
    barrier: float = 1.0
    """λ_B · d̂."""
    stride: float = 0.5
    """Maximum motion of a fine vertex to one target, as a fraction of the mean coarse edge length."""

    def __post_init__(self) -> None:
        check_positive(self, "barrier_range", "restoring", "barrier", "stride")
        check_not_negative(self, "cages")
        check_part(self, "solver", "minimise", "ProjectedNewton()")
        check_part(self, "energy", "at", "Area()")

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float, on_step: OnStep = no_step
    ) -> ContactOutcome:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`."""
        m, energy, candidates, iterations = bodies.m, self.energy.at(bodies.coarse), CandidateList(bodies), 0
        d_hat = self.barrier_range * bodies.cage_edge_length
        for target in waypoints(x[m:], path, self.stride * bodies.cage_edge_length):
            step_energy = energy.after(x[:m])
            for k in range(MOST_ROUNDS):
                weights = PotentialWeights(STIFFENING**k * self.restoring / d_hat, self.cages, self.barrier)
                objective = IncrementalPotential(bodies, step_energy, target, weights, d_hat, candidates)
                solution = self.solver.minimise(objective, x, on_step)
                x, iterations = solution.x, iterations + solution.iterations
                logger.debug("IPC: %d iterations to a target, stiffened %d times", solution.iterations, k)
                reached = objective.finished(x)
                if reached or not solution.converged:
                    break
            if not reached:
                return ContactOutcome(x, False, iterations, farthest_vertex(x[m:], target))
            x = np.concatenate([x[:m], target])
            on_step(x)
        return ContactOutcome(x, True, iterations)


def waypoints(start: FloatArray, path: Sequence[FloatArray], stride: float) -> Iterator[FloatArray]:
    """The targets of the path, with evenly spaced ones between where a vertex would move farther than ``stride``."""
    for target in path:
        motion = target - start
        longest = float(np.sqrt((motion * motion).sum(axis=1).max()))
        pieces = max(1, int(np.ceil(longest / stride)))
        for k in range(1, pieces):
            yield start + (k / pieces) * motion
        yield target
        start = target
