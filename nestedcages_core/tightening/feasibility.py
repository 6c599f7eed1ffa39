"""Feasibility phase: small steps of a cage that keeps its distances until it keeps its bounds too.

Each step is the smallest motion that keeps the rows of the bounds, restored and checked as in the tightening.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..constraints.base import Bound, short_of
from ..contact.base import OnStep
from ..contact.pairs import Bodies, CandidateList, WantedDistances
from ..energies import Blocks, CageEnergy
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.precision import MOST_STEPS, NEGLIGIBLE
from ..solver.quadratic_program import InteriorPoint
from .quadratic_model import EdgeLoads, model_at
from .trust_region import STEP_REDUCTION, find_trial

LONGEST_STEP, LAST_STEP = 0.1, 1e-3
"""First and last longest motions of a vertex in one step, in mean edges of the cage."""

MISSED_COMPLIANCE = 1e-4
"""ε of rows that are missed: violation per unit of force, where the force D moves the cage by D."""

LEAST_GAIN = 1e-2
"""Fraction of what is lacking that a step must gain; slower ones end at cages that miss it."""


@dataclass(frozen=True)
class Lack(CageEnergy):
    """What a cage lacks, as a sum of lengths; its model is the squared length of the motion."""

    bounds: tuple[Bound, ...]

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """A length."""
        return float(short_of(self.bounds, vertices).sum())

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2) zeros."""
        return np.zeros_like(vertices)

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """The identity."""
        still = np.arange(len(vertices))
        return Blocks(still, still, np.broadcast_to(np.eye(2), (len(vertices), 2, 2)))


def feasible(
    bodies: Bodies,
    x: FloatArray,
    candidates: CandidateList,
    wanted: WantedDistances,
    solver: InteriorPoint,
    on_step: OnStep,
) -> FloatArray:
    """Positions (m + n, 2) at which the cage keeps its bounds, or as many as small steps reach, and its distances.

    on_step: called with every cage on the way.
    """
    m, unit, lack, still = bodies.m, bodies.cage_edge_length, Lack(bodies.bounds), EdgeLoads.none(bodies.m)
    lacking, radius = lack.value(x[:m], bodies.coarse.successor), LONGEST_STEP * unit
    for _ in range(MOST_STEPS):
        if lacking == 0.0 or radius < LAST_STEP * unit:
            break
        model = model_at(x, bodies, candidates, lack, wanted, radius, still, MISSED_COMPLIANCE)
        program = replace(model.program, scale=radius)
        step = bodies.solved(solver, program, NEGLIGIBLE * radius**2, bodies.order).step
        trial = find_trial(bodies, model.around, x, step, value=lacking, decrease=0.0, energy=lack)
        if trial.accepted:
            x = trial.x
            on_step(x[:m].copy())
        if trial.value > (1.0 - LEAST_GAIN) * lacking:
            radius *= STEP_REDUCTION
        lacking = trial.value
    return x
