"""Tightening by trust-region sequential quadratic programming.

In every iteration the energy and the distances are modelled at the current cage (m, 2), which is free of contact and
keeps all its distances:

    minimise   ∇E·D + ½ Dᵀ (∇²E - Σ z ∇²d) D
    subject to d - clearance + ∂d·D ≥ 0,   |D_i| ≤ Δ,

with the multipliers z of the iteration before and a radius Δ. The step is restored to the
wanted distances, checked over its whole length for collisions, and accepted if the energy falls. The model's predicted
decrease says how far the cage is from a local optimum.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..contact.base import OnStep, no_step
from ..contact.pairs import Bodies, CandidateList
from ..energies import CageEnergy, signed_area
from ..geometry.arrays import FloatArray
from ..geometry.precision import MOST_STEPS, NEGLIGIBLE
from ..parameters import check_count, check_not_negative, check_part, check_positive
from ..solver.negative_curvature import NegativeCurvature, negative_curvature
from ..solver.quadratic_program import InteriorPoint, QPSolution, QuadraticProgram
from .quadratic_model import EdgeLoads, model_at
from .reach_clearance import reach_clearance
from .trust_region import find_trial, next_radius

logger = logging.getLogger(__name__)

CLEARANCE_MARGIN = 1e-7
"""Relative margin added to the clearance to absorb later rounding."""

THINNEST_SKIN = 0.75
"""Lower bound on the skin of the list of candidate pairs, in units of the mean coarse edge length."""


ACTIVE_MULTIPLIER = 1e-5
"""Multipliers above this fraction of the largest mark constraints that are active at a saddle."""


class TighteningOutcome(NamedTuple):
    """What a tightening took."""

    iterations: int
    """Steps of the trust-region method."""
    quadratic_programs: int
    """Linear systems factorised within their quadratic programs."""


@dataclass(frozen=True)
class Tightening:
    """Brings a cage to a local optimum of its energy; lengths in units of the mean coarse edge length L."""

    iterations: int = MOST_STEPS
    """Cap on the steps."""
    first_radius: float = 0.05
    """First Δ."""
    largest_radius: float = 0.1
    """Largest Δ: steps of a whole L converge in fewer iterations, but to worse optima."""
    least_gain: float = 1e-3
    """Stop when a step gains less than this fraction of the area between cage and fine mesh."""
    solver: InteriorPoint = field(default_factory=InteriorPoint)
    """Solves the quadratic programs."""
    apart: float = 0.0
    """Distance that loops of the cage keep from each other, in clearances, for the cages around it."""

    def __post_init__(self) -> None:
        check_count(self, "iterations", least=0)
        check_positive(self, "first_radius", "largest_radius")
        check_not_negative(self, "least_gain", "apart")
        check_part(self, "solver", "solve", "InteriorPoint()")

    def run(
        self,
        bodies: Bodies,
        cage: FloatArray,
        fine: FloatArray,
        *,
        clearance: float,
        energy: CageEnergy,
        on_step: OnStep = no_step,
    ) -> TighteningOutcome:
        """Tighten ``cage`` (m, 2), which is free of contact with ``fine`` (n, 2), to the clearance (a length).

        on_step: called with the cage after every accepted step.
        """
        m, unit, successor, energy = bodies.m, bodies.cage_edge_length, bodies.coarse.successor, energy.after(cage)
        clearance *= 1.0 + CLEARANCE_MARGIN
        candidates = CandidateList(bodies, thinnest_skin=THINNEST_SKIN * unit)
        cleared = reach_clearance(
            bodies, np.concatenate([cage, fine]), clearance, candidates, self.apart * clearance, on_step
        )
        if cleared is None:
            return TighteningOutcome(0, 0)
        x, wanted = cleared
        if bodies.bounds:
            from .feasibility import feasible

            x = feasible(bodies, x, candidates, wanted, self.solver, on_step)
        fine_area = signed_area(fine, bodies.fine.successor)
        radius = first = self.first_radius * unit
        largest = self.largest_radius * unit
        value, order, loads = energy.value(x[:m], successor), bodies.order, EdgeLoads.none(m)
        slope = float(np.abs(energy.gradient(x[:m], successor)).sum())
        steps, systems, at_saddle = 0, 0, False
        while steps < self.iterations and radius >= NEGLIGIBLE * unit:
            area = signed_area(x[:m], bodies.cage.successor)
            negligible = NEGLIGIBLE * abs(area)
            little = max(negligible, self.least_gain * min(value, abs(area - fine_area)))
            if slope * largest <= little:
                break
            enough = negligible if at_saddle else little
            model = model_at(x, bodies, candidates, energy, wanted, radius, loads)
            solution = bodies.solved(self.solver, model.program, enough, order)
            systems, order, loads = systems + solution.iterations, solution.order, model.loads(solution)
            trial = find_trial(
                bodies, model.around, x, solution.step, value=value, decrease=solution.decrease, energy=energy
            )
            gain = value - trial.value
            logger.debug(
                "tightening %d: energy %.9g, predicted %.2e, actual %.2e, %d pairs, systems %d%s",
                steps, value, solution.decrease, gain, len(model.around.pairs),
                solution.iterations, "" if solution.converged else "!",
            )  # fmt: skip
            steps, x, value = steps + 1, trial.x, trial.value
            if trial.accepted:
                on_step(x[:m].copy())
            if not solution.converged or max(solution.decrease, gain) >= enough:
                radius = next_radius(radius, largest, solution, trial, gain)
                continue
            softest = soft_motion(bodies, model.program, solution)
            if softest is None or -0.5 * softest.curvature * unit**2 < little:
                break
            if at_saddle:
                radius, decrease = max(radius, first), -0.125 * softest.curvature * first**2
                around = model_at(x, bodies, candidates, energy, wanted, radius, loads).around
                for length in (0.5 * first, -0.5 * first):
                    motion = length * softest.direction
                    trial = find_trial(bodies, around, x, motion, value=value, decrease=decrease, energy=energy)
                    if trial.accepted:
                        break
                else:
                    break
                x, value = trial.x, trial.value
                on_step(x[:m].copy())
            at_saddle = not at_saddle
        return TighteningOutcome(steps, systems)


def soft_motion(bodies: Bodies, program: QuadraticProgram, solution: QPSolution) -> NegativeCurvature | None:
    """The motion that leads off a saddle, its longest row of length 1; None at a local minimum.

    See docs/numbers.md: escapes from saddles.
    """
    active = solution.multipliers > ACTIVE_MULTIPLIER * solution.multipliers.max(initial=0.0)
    if bodies.elimination is None:
        return negative_curvature(program, solution.order, active)
    softest = negative_curvature(bodies.elimination.program(program), solution.order, active)
    return softest and softest._replace(direction=bodies.elimination.motion(softest.direction))
