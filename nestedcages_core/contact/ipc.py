"""Incremental Potential Contact: minimise a barrier energy by collision-free steps, as in the paper."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..energies import Area, Energy
from ..energies.restoring import Restoring
from ..geometry.arrays import FloatArray
from ..geometry.precision import MOST_ROUNDS, PATIENCE, PROGRESS_RATIO
from ..parameters import check_not_negative, check_part, check_positive
from ..solver.newton import ProjectedNewton, Solver
from .barrier import BarrierRanges
from .base import ContactOutcome, OnStep, farthest_vertex, no_step
from .incremental_potential import IncrementalPotential, PotentialWeights
from .pairs import Bodies, CandidateList

__all__ = ["IPC"]

logger = logging.getLogger(__name__)

STIFFENING = 4.0
"""Factor on λ_R when the minimum of the energy leaves the fine mesh short of its target (docs/ablation.md: IPC:
stiffening)."""


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
    """d̂ as a fraction of the mean coarse edge length, where the local gap allows it."""
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
        m = bodies.m
        energy = self.energy.at(bodies.coarse)
        base = self.barrier_range * bodies.cage_edge_length
        ranges = BarrierRanges.local(bodies, x[:m], path[-1], base)
        candidates = CandidateList(bodies)
        iterations = 0
        for target in waypoints(x[m:], path, self.stride * bodies.cage_edge_length):
            stiffness, idle = self.restoring / base, 0
            least = _distances(x[m:], target)
            step_energy = energy.after(x[:m])
            for _ in range(1 + MOST_ROUNDS):
                objective = IncrementalPotential(
                    bodies,
                    step_energy,
                    Restoring(target, bodies.fine_weight),
                    PotentialWeights(stiffness, self.cages, self.barrier),
                    ranges,
                    candidates,
                )
                solution = self.solver.minimise(objective, x, on_step)
                x = solution.x
                iterations += solution.iterations
                logger.debug("IPC: %d iterations to a target, stiffness %.2e", solution.iterations, stiffness)
                if objective.finished(x):
                    x = np.concatenate([x[:m], target])
                    on_step(x)
                    break
                left = _distances(x[m:], target)
                idle = 0 if (left < PROGRESS_RATIO * least).any() else idle + 1
                least = np.minimum(least, left)
                if idle >= PATIENCE or not solution.converged:
                    return ContactOutcome(x, False, iterations, farthest_vertex(x[m:], target))
                stiffness *= STIFFENING
            else:
                return ContactOutcome(x, False, iterations, farthest_vertex(x[m:], target))
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


def _distances(fine: FloatArray, target: FloatArray) -> FloatArray:
    """(2,) distance to the target, summed over the vertices and at the farthest one."""
    length = np.hypot(*(target - fine).T)
    return np.array([length.sum(), length.max()])
