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
from ..geometry.arrays import TINY, FloatArray
from ..geometry.precision import MOST_STEPS, NEGLIGIBLE, PATIENCE
from ..parameters import check_count, check_not_negative, check_part, check_positive
from ..solver.negative_curvature import negative_curvature
from ..solver.quadratic_program import InteriorPoint, QPSolution
from .quadratic_model import EdgeLoads, QuadraticModel, model_at
from .reach_clearance import widen
from .trust_region import Trial, TrustRegion, find_trial

logger = logging.getLogger(__name__)

CLEARANCE_MARGIN = 1e-7
"""Relative margin added to the clearance to absorb later rounding."""

THINNEST_SKIN = 0.75
"""Lower bound on the skin of the list of candidate pairs, in units of the mean coarse edge length."""

ACTIVE_MULTIPLIER = 1e-3
"""Multipliers above this fraction of the largest mark constraints that are active at a saddle."""

ESCAPE_LENGTH = 0.5
"""Length of the step off a saddle, in first radii."""


class TighteningOutcome(NamedTuple):
    """Where a tightening ended."""

    cage: FloatArray
    """(m, 2) vertices of the cage."""
    iterations: int
    """Steps of the trust-region method."""
    quadratic_programs: int
    """Linear systems factorised within their quadratic programs."""
    reason: str
    """Why it stopped, in a sentence."""


@dataclass(frozen=True)
class Tightening:
    """Brings a cage to a local optimum of its energy; lengths in units of the mean coarse edge length L."""

    iterations: int = MOST_STEPS
    """Cap on the steps."""
    first_radius: float = 0.05
    """First Δ."""
    largest_radius: float = 0.1
    """Largest Δ: steps of a whole L converge in fewer iterations, but to worse optima."""
    tolerance: float = NEGLIGIBLE
    """Stop when the predicted decrease stays below this fraction of the cage's area ..."""
    share: float = 2e-4
    """... or below this fraction of all decrease so far."""
    patience: int = PATIENCE
    """... for this many iterations (docs/ablation.md: patience)."""
    solver: InteriorPoint = field(default_factory=InteriorPoint)
    """Solves the quadratic programs."""
    apart: float = 0.0
    """Distance that loops of the cage keep from each other, in clearances, for the cages around it."""

    def __post_init__(self) -> None:
        check_count(self, "iterations", least=0)
        check_count(self, "patience")
        check_positive(self, "first_radius", "largest_radius")
        check_not_negative(self, "tolerance", "share", "apart")
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
        return _Run(self, bodies, np.concatenate([cage, fine]), clearance, energy.after(cage), on_step).minimise()


class _Run:
    """State of one tightening."""

    def __init__(
        self,
        settings: Tightening,
        bodies: Bodies,
        x: FloatArray,
        clearance: float,
        energy: CageEnergy,
        on_step: OnStep,
    ) -> None:
        self.settings, self.bodies, self.energy, self.on_step = settings, bodies, energy, on_step
        self.x = x
        self.clearance = clearance * (1.0 + CLEARANCE_MARGIN)
        self.m = bodies.m
        self.candidates = CandidateList(bodies, thinnest_skin=THINNEST_SKIN * bodies.cage_edge_length)
        self.order = bodies.order
        self.systems = 0

    def minimise(self) -> TighteningOutcome:
        apart = self.settings.apart * self.clearance
        solver = self.settings.solver
        widened = widen(self.bodies, self.x, self.clearance, self.candidates, solver, self._moved, apart)
        self.x, self.wanted = widened.x, widened.wanted
        self.systems += widened.systems
        if widened.closest >= 0:
            return self._outcome(0, f"There is no room for the clearance at {self._name(widened.closest)}.")
        if self.bodies.bounds:
            from .feasibility import feasible

            self.x = feasible(self.bodies, self.x, self.candidates, self.wanted, solver, self._moved)
        settings, energy, successor = self.settings, self.energy, self.bodies.coarse.successor
        unit = self.bodies.cage_edge_length
        first = settings.first_radius * unit
        region = TrustRegion(first, first, settings.largest_radius * unit, unit)
        value = first_value = energy.value(self.x[: self.m], successor)
        negligible = settings.tolerance * abs(signed_area(self.x[: self.m], successor))
        slope = float(np.abs(energy.gradient(self.x[: self.m], successor)).sum())
        if slope * region.largest <= negligible:
            return self._outcome(0, "The cage is at a minimum of its energy.")
        loads = EdgeLoads.none(self.m)
        quiet = 0
        previous = 0.0
        for iteration in range(1, settings.iterations + 1):
            threshold = max(negligible, settings.share * (first_value - value))
            model = model_at(self.x, self.bodies, self.candidates, energy, self.wanted, region.radius, loads)
            solved = settings.solver.complementarity * negligible
            solution = self.bodies.solved(settings.solver, model.program, solved, self.order)
            self.order = solution.order
            self.systems += solution.iterations
            loads = model.loads(solution)
            trial = self._try(model, solution.step, value, solution.decrease)
            logger.debug(
                "tightening %d: energy %.9g, predicted %.2e, actual %.2e, %d pairs, systems %d%s",
                iteration, value, solution.decrease, value - trial.value, len(model.around.pairs),
                solution.iterations, "" if solution.converged else "!",
            )  # fmt: skip
            gain = value - trial.value
            quiet = quiet + 1 if solution.converged and max(solution.decrease, gain) < threshold else 0
            further = solution.decrease**2 / max(previous - solution.decrease, TINY)  # if all steps gain less alike
            still = quiet > 0 and trial.accepted and further < settings.solver.complementarity * threshold
            previous = solution.decrease
            region.update(solution, trial, value)
            value = self._accept(trial)
            if still or quiet >= settings.patience:
                escape = self._escape(model, solution, value)
                if escape is None or value - escape.value < negligible:
                    return self._outcome(iteration, "The model predicts no further decrease of the energy.")
                logger.debug("tightening %d: off a saddle, actual %.2e", iteration, value - escape.value)
                value = self._accept(escape)
                region.reset()
                quiet = 0
            elif region.collapsed:
                return self._outcome(iteration, "No step, however short, lowers the energy.")
        return self._outcome(settings.iterations, f"Stopped after {settings.iterations} iterations.")

    def _try(self, model: QuadraticModel, step: FloatArray, value: float, decrease: float) -> Trial:
        return find_trial(self.bodies, model.around, self.x, step, value=value, decrease=decrease, energy=self.energy)

    def _accept(self, trial: Trial) -> float:
        """Move to the result of the trial, if it was accepted; returns the energy there."""
        if trial.accepted:
            self.x = trial.x
            self._moved(self.x)
        return trial.value

    def _moved(self, x: FloatArray) -> None:
        self.on_step(x[: self.m].copy())

    def _escape(self, model: QuadraticModel, solution: QPSolution, value: float) -> Trial | None:
        """A step off a saddle that lowers the energy; None at a local minimum (docs/ablation.md: escapes from saddles).

        The model is that of the step before, which was short; its contacts are measured again.
        """
        multipliers = solution.multipliers
        active = multipliers > ACTIVE_MULTIPLIER * multipliers.max(initial=0.0)
        elimination = self.bodies.elimination
        program = model.program if elimination is None else elimination.program(model.program)
        softest = negative_curvature(program, self.order, active)
        if softest is None:
            return None
        direction = softest.direction if elimination is None else elimination.motion(softest.direction)
        length = ESCAPE_LENGTH * self.settings.first_radius * self.bodies.cage_edge_length
        decrease = -0.5 * softest.curvature * length**2
        model = model.measured_at(self.x)
        trials = [self._try(model, sign * length * direction, value, decrease) for sign in (1.0, -1.0)]
        best = min(trials, key=lambda trial: trial.value)
        return best if best.accepted else None

    def _name(self, vertex: int) -> str:
        return f"cage vertex {vertex}" if vertex < self.m else f"fine vertex {vertex - self.m}"

    def _outcome(self, iterations: int, reason: str) -> TighteningOutcome:
        logger.debug("tightening ended after %d iterations, %d systems: %s", iterations, self.systems, reason)
        return TighteningOutcome(self.x[: self.m].copy(), iterations, self.systems, reason)
