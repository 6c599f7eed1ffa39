"""Incremental Potential Contact: the paper's way to push the cage, by a solver on the barrier energy with collision-
free steps."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..energies import CageEnergy
from ..energies.restoring import Restoring
from ..geometry.arrays import FloatArray
from ..solver import Solver
from .barrier_ranges import BarrierRanges
from .base import ContactOutcome
from .incremental_potential import IncrementalPotential, PotentialWeights
from .pair_search import BroadPhase, UniformGrid
from .pairs import Bodies
from .step_filter import StepFilter, TimeOfImpact

logger = logging.getLogger(__name__)

STIFFER = 4.0
"""Factor on λ_R when the minimum of the energy leaves the fine mesh short of its target."""

MAX_STIFFENINGS = 12
"""Cap on those factors for one target: λ_R grows at most by 1.7e7."""

SHORTER_RANGE = 0.25
"""Factor on d̂ when a solve is blocked: two walls closer than the range hold each other up."""

MAX_SHORTENINGS = 4
"""Cap on those factors for one target."""

PROGRESS, PATIENCE = 0.98, 3
"""Each solve must leave less than this part of the way to the target, summed or at the farthest vertex, or so many in a
row mean that the way is blocked."""

CLEARANCE_RANGE = 4.0
"""The range d̂ is at least this multiple of the wanted clearance, so that the fine mesh comes home with room to
spare."""


@dataclass(frozen=True)
class IPC:
    """Minimise λ_R R + λ_cages E_cages + λ_B B for each target on the way home (Gurditta & Jacobson 2022, section 3.2).

    Lengths are relative to the mean coarse edge length, weights per length of boundary, so that no shape needs tuning.
    """

    barrier_range: float = 0.1
    """d̂ as a fraction of the mean coarse edge length, where the local gap allows it."""
    restoring: float = 100.0
    """λ_R · d̂: how much stronger the pull home is, one range away from it, than the pressure of the area."""
    cages: float = 1.0
    """λ_cages."""
    barrier: float = 1.0
    """λ_B · d̂."""
    stride: float = 0.5
    """Longest motion of a fine vertex to one target, as a fraction of the mean coarse edge length."""
    crowd: float = np.inf
    """Pairs per vertex within their ranges above which it leaves the way to the next contact: each costs its share of
    every iteration, and where much of the fine mesh is in reach of much of the cage, many iterations follow."""
    step_filter: StepFilter = field(default_factory=TimeOfImpact)
    """What bounds a step before the line search."""
    broad_phase: BroadPhase = field(default_factory=UniformGrid)
    """Which pairs are looked at."""

    def reinflate(
        self,
        bodies: Bodies,
        x: FloatArray,
        path: Sequence[FloatArray],
        *,
        clearance: float,
        energy: CageEnergy,
        solver: Solver,
        on_step: Callable[[FloatArray], None],
    ) -> ContactOutcome:
        """Bring the fine mesh home; see :class:`nestedcages_core.contact.base.Contact`."""
        m = bodies.m
        base = max(self.barrier_range * bodies.cage_edge_length, CLEARANCE_RANGE * clearance)
        home = path[-1]
        local = BarrierRanges.local(bodies, x[:m], home, base)
        candidates = self.broad_phase.candidates(bodies)
        iterations = 0
        for target in waypoints(x[m:], path, self.stride * bodies.cage_edge_length):
            stiffness, shortening = self.restoring / base, 1.0
            stiffenings = shortenings = idle = 0
            least = _left(x[m:], target)
            step_energy = energy.after(x[:m])
            while True:
                objective = IncrementalPotential(
                    bodies,
                    step_energy,
                    Restoring(target, bodies.fine_weight),
                    PotentialWeights(stiffness, self.cages, self.barrier),
                    local.scaled(shortening),
                    candidates,
                    self.step_filter,
                )
                if objective.pairs_in_range(x) > self.crowd * len(x):
                    return ContactOutcome(x, False, iterations, "too many pairs are in contact at once")
                solution = solver.minimise(objective, x, on_step)
                x = solution.x
                iterations += solution.iterations
                logger.debug(
                    "IPC: %d iterations towards a target, stiffness %.2e, ranges x %.2g%s", solution.iterations,
                    stiffness, shortening, "" if solution.converged else ", not converged",
                )  # fmt: skip
                if objective.finished(x):
                    x = np.concatenate([x[:m], target])
                    on_step(x)
                    break
                left = _left(x[m:], target)
                idle = 0 if (left < PROGRESS * least).any() else idle + 1
                least = np.minimum(least, left)
                if idle >= PATIENCE:
                    return ContactOutcome(x, False, iterations, _blocked(x[m:], target))
                if solution.converged and stiffenings < MAX_STIFFENINGS:
                    stiffness, stiffenings = STIFFER * stiffness, stiffenings + 1
                elif not solution.converged and shortenings < MAX_SHORTENINGS:
                    shortening, shortenings = SHORTER_RANGE * shortening, shortenings + 1
                else:
                    return ContactOutcome(x, False, iterations, _blocked(x[m:], target))
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


def _left(fine: FloatArray, target: FloatArray) -> FloatArray:
    """(2,) the way to the target, summed over the vertices and at the farthest one."""
    length = np.hypot(*(target - fine).T)
    return np.array([length.sum(), length.max()])


def _blocked(fine: FloatArray, target: FloatArray) -> str:
    """Which fine vertex is farthest from its target."""
    worst = int(np.hypot(*(target - fine).T).argmax())
    return f"the cage holds up fine vertex {worst}"
