"""Tightening by trust-region sequential quadratic programming.

In every iteration the energy and the distances are modelled at the current cage (m, 2), which is free of contact and
keeps all its distances:

    minimise   ∇E·D + ½ Dᵀ (∇²E - Σ z ∇²d + δ I) D
    subject to d - clearance + ∂d·D ≥ 0,   |D_i| ≤ Δ_i,

with the multipliers z of the iteration before and a radius Δ of its own for every vertex. The step is restored to the
wanted distances, checked over its whole length for collisions, and accepted if the energy falls. The model's predicted
decrease says how far the cage is from a local optimum.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .._types import FloatArray
from ..contact.linearisation import Contacts, constraint_rows, measure, resolve_corners
from ..contact.pairs import Bodies, CandidateList, Pairs
from ..contact.pruning import not_implied
from ..energies import Blocks, CageEnergy, signed_area
from ..solver.quadratic_program import InteriorPoint, QuadraticProgram, Solution
from .curvature import EdgeLoads, contact_curvature
from .trial import find_trial
from .trust_region import TrustRegion
from .widening import widen

logger = logging.getLogger(__name__)

INSIDE = 1e-7
"""The distance aimed at is larger than the clearance by this fraction, so that no later rounding eats it."""

THINNING = 0.02
"""Contacts whose constraints others imply up to this fraction of the clearance are left out; restoration makes up for
them."""

STILL = 1e-2
"""Fraction of the tolerance below which one predicted decrease is enough: further steps would not change the
outline."""

LONGEST_MOTION = 1.5
"""Longest motion of a vertex in one step with its restoration, in radii; √2 without it. Pairs are looked for so far."""

COMPLEMENTARITY = 0.1
"""Complementarity of a quadratic program that is small enough, as a fraction of the decrease at which tightening
stops."""


@dataclass(frozen=True, eq=False)
class TighteningOutcome:
    """Where a tightening ended."""

    cage: FloatArray
    """(m, 2) vertices of the cage."""
    iterations: int
    """Steps of the trust-region method."""
    quadratic_programs: int
    """Linear systems factorised within their quadratic programs."""
    converged: bool
    """Whether the predicted decrease fell below the tolerance."""
    reason: str
    """Why it stopped, in a sentence."""


@dataclass(frozen=True)
class Tightening:
    """Brings a cage to a local optimum of its energy; lengths in units of the mean coarse edge length L."""

    iterations: int = 100
    """Cap on the steps."""
    first_radius: float = 0.05
    """First Δ of every vertex."""
    largest_radius: float = 0.1
    """Largest Δ: steps of a whole L converge in fewer iterations, but to worse optima."""
    tolerance: float = 1e-6
    """Stop when the predicted decrease stays below this fraction of the cage's area ..."""
    share: float = 2e-4
    """... or below this fraction of all decrease so far."""
    patience: int = 3
    """... for so many iterations."""
    solver: InteriorPoint = field(default_factory=InteriorPoint)
    """Method for the quadratic programs."""

    def run(
        self,
        bodies: Bodies,
        cage: FloatArray,
        fine: FloatArray,
        *,
        clearance: float,
        energy: CageEnergy,
        on_step: Callable[[FloatArray], None],
    ) -> TighteningOutcome:
        """Tighten ``cage`` (m, 2), which is free of contact with ``fine`` (n, 2), to the clearance (a length).

        ``on_step`` gets the cage of every accepted step; the linear motion from the one before is free of collisions.
        It may raise to cancel.
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
        on_step: Callable[[FloatArray], None],
    ) -> None:
        self.settings, self.bodies, self.energy, self.on_step = settings, bodies, energy, on_step
        self.x = x
        self.clearance = clearance * (1.0 + INSIDE)
        self.own_clearance = self.clearance
        self.m = bodies.m
        self.candidates = CandidateList(bodies)
        self.systems = 0
        self.loads = EdgeLoads.none(bodies.m)

    def minimise(self) -> TighteningOutcome:
        widened = widen(
            self.bodies, self.x, self.clearance, self.candidates, self.settings.solver,
            lambda x: self.on_step(x[: self.m].copy()),
        )  # fmt: skip
        self.x, self.own_clearance = widened.x, widened.own
        self.systems += widened.systems
        if widened.closest >= 0:
            return self._outcome(0, False, f"There is no room for the clearance at {self._name(widened.closest)}.")
        settings, energy, successor = self.settings, self.energy, self.bodies.cage_successor
        region = TrustRegion.start(self.m, settings, self.bodies.cage_edge_length)
        value = first_value = energy.value(self.x[: self.m], successor)
        negligible = settings.tolerance * abs(signed_area(self.x[: self.m], successor))
        slope = float(np.abs(energy.gradient(self.x[: self.m], successor)).sum())
        if slope * region.largest <= negligible:
            return self._outcome(0, True, "The cage is at a minimum of its energy.")
        quiet = 0
        for iteration in range(1, settings.iterations + 1):
            threshold = max(negligible, settings.share * (first_value - value))
            longest = LONGEST_MOTION * float(region.radius.max())
            pairs = self.candidates.within(self.x, self.clearance + 2.0 * longest, 2.0 * longest)
            contacts = measure(pairs, self.x)
            solution = self._solve(pairs, contacts, region, COMPLEMENTARITY * negligible)
            trial = find_trial(
                self.bodies, pairs, contacts, self.x, solution.step,
                required=self._required(pairs), longest=longest, value=value, decrease=solution.decrease, energy=energy,
            )  # fmt: skip
            logger.debug(
                "tightening %d: energy %.9g, predicted %.2e, actual %.2e, %d pairs, systems %d%s, shift %.1e, "
                "radius %.1e, shortened %d",
                iteration, value, solution.decrease, value - trial.value if trial.accepted else 0.0, len(pairs),
                solution.iterations, "" if solution.converged else "!", solution.shift, float(np.median(region.radius)),
                int((trial.fraction < 1.0).sum()),
            )  # fmt: skip
            gain = value - trial.value
            quiet = quiet + 1 if solution.converged and max(solution.decrease, gain) < threshold else 0
            still = quiet > 0 and solution.decrease < STILL * threshold
            region.update(solution, trial, value, self.clearance, self.x[: self.m])
            if trial.accepted:
                self.x, value = trial.x, trial.value
                self.on_step(self.x[: self.m].copy())
            if still or quiet >= settings.patience:
                return self._outcome(iteration, True, "The predicted decrease of the energy is below the tolerance.")
            if region.collapsed:
                return self._outcome(iteration, False, "No step, however short, lowers the energy.")
        return self._outcome(settings.iterations, False, f"Stopped after {settings.iterations} iterations.")

    def _solve(self, pairs: Pairs, contacts: Contacts, region: TrustRegion, absolute: float) -> Solution:
        """The quadratic program at the current cage; keeps the loads of the edges for the next one."""
        cage, successor = self.x[: self.m], self.bodies.cage_successor
        reach = np.zeros(len(self.x))
        reach[: self.m] = region.radius * np.sqrt(2.0)
        approach = reach.take(pairs.point) + np.maximum(reach.take(pairs.start), reach.take(pairs.end))
        near = contacts.distance - self._required(pairs) < approach
        pairs, contacts = pairs.subset(near), contacts.where(near)
        pairs, contacts = resolve_corners(self.bodies, pairs, contacts, self.x, self.clearance)
        room = contacts.distance - self._required(pairs)
        keep = not_implied(pairs, contacts, room, THINNING * self.clearance)
        pairs, contacts, room = pairs.subset(keep), contacts.where(keep), room[keep]
        curvature = contact_curvature(self.bodies, cage, self.loads)
        program = QuadraticProgram(
            self.energy.gradient(cage, successor),
            Blocks.sum([(1.0, self.energy.hessian(cage, successor)), (1.0, curvature)]),
            constraint_rows(pairs, contacts),
            np.maximum(room, 0.0),
            region.radius,
            shift=region.shift,
            order=self.bodies.cage_order,
        )
        solution = self.settings.solver.solve(program, absolute)
        self.systems += solution.iterations
        self.loads = EdgeLoads.of(pairs, contacts, solution.multipliers, self.m)
        return solution

    def _required(self, pairs: Pairs) -> FloatArray:
        """(K,) distance that each pair must keep."""
        required = np.full(len(pairs), self.clearance)
        required[pairs.cage_cage] = self.own_clearance
        return required

    def _name(self, vertex: int) -> str:
        return f"cage vertex {vertex}" if vertex < self.m else f"fine vertex {vertex - self.m}"

    def _outcome(self, iterations: int, converged: bool, reason: str) -> TighteningOutcome:
        return TighteningOutcome(self.x[: self.m].copy(), iterations, self.systems, converged, reason)
