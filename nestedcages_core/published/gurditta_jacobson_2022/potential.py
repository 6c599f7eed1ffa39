"""The energy of reinflation, with the weights of the paper's program (Gurditta & Jacobson 2022, section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...contact.barrier import BarrierSum
from ...contact.ccd import impacts
from ...contact.incremental_potential import DIRECT_STEP_MARGIN
from ...contact.pairs import Bodies, Pairs
from ...energies import Blocks, CageEnergy
from ...energies.containment_energy import ContainmentEnergy
from ...geometry.arrays import FloatArray
from ...geometry.distance import PointEdge
from ...parameters import check_not_negative
from ...solver.newton import NewtonModel
from .pair_search import PairSource
from .ray_parity import contained_by_parity
from .step_filter import StepFilter

SMALLEST_DISTANCE = 1e-15
"""Distance in bounding-box diagonals below which the program has no barrier, to skip a vertex and its own edges."""


@dataclass(frozen=True)
class PaperWeights:
    """Weights of the program, which hold at any scale: every term of the energy is a length²."""

    restoring: float = 1e4
    """λ_R."""
    cages: float = 10.0
    """λ_cages."""
    barrier: float = 10.0
    """λ_B."""

    def __post_init__(self) -> None:
        check_not_negative(self, "restoring", "cages", "barrier")


class PaperPotential:
    """E = λ_R R + λ_cages E_cages + λ_B (B_FC + B_CF + B_CC) + E_cont over x = (C; F).

    R = ½ Σ |f - target|²; B = Σ -(d - d̂)² log(d / d̂) over all pairs closer than d̂; E_cont = 0 or ∞, which has no
    gradient and acts through the line search only.
    """

    def __init__(
        self,
        bodies: Bodies,
        energy: CageEnergy,
        target: FloatArray,
        weights: PaperWeights,
        d_hat: float,
        *,
        candidates: PairSource,
        step_filter: StepFilter,
        exact_containment: bool,
        ends_at_target: bool = False,
        arrival: float | None = None,
    ) -> None:
        self.bodies, self.energy, self.target = bodies, energy, target
        self.weights, self.d_hat = weights, d_hat
        self.candidates, self.step_filter = candidates, step_filter
        self.ends_at_target, self.arrival = ends_at_target, arrival
        self._ceiling = np.inf
        self._exact = ContainmentEnergy(bodies.cage.successor, bodies.fine.successor) if exact_containment else None

    def value(self, x: FloatArray) -> float:
        """E at x (m + n, 2)."""
        return self._value(x, self._barriers(x))

    def slope(self, x: FloatArray) -> tuple[float, FloatArray]:
        """E and the gradient of its finite terms."""
        return self._slope(x, self._barriers(x))

    def newton(self, x: FloatArray) -> NewtonModel:
        """E, its gradient and its projected Newton direction, named as further work by the paper."""
        barriers = self._barriers(x)
        value, gradient = self._slope(x, barriers)
        hessian = self.energy.projected_hessian(x[: self.bodies.m], self.bodies.cage.successor)
        own = Blocks.sum([(self.weights.cages, hessian)])
        stiffness = np.full(self.bodies.n, self.weights.restoring)
        return NewtonModel(value, gradient, barriers.newton_direction(gradient, stiffness, own))

    def largest_step(self, x: FloatArray, direction: FloatArray) -> float:
        """Fraction of ``direction`` that the step filter allows."""
        pairs, pair = self._near(x, direction)
        return self.step_filter.fraction(pairs, x, direction, pair.distance)

    def finished(self, x: FloatArray) -> bool:
        """Whether the fine mesh can go straight to its target, if ``ends_at_target``; else whether it has arrived.

        Always False as published.
        """
        if not self.ends_at_target:
            far = np.hypot(*(x[self.bodies.m :] - self.target).T).max()
            return self.arrival is not None and bool(far <= self.arrival)
        motion = np.zeros_like(x)
        motion[self.bodies.m :] = self.target - x[self.bodies.m :]
        pairs, pair = self._near(x, motion)
        if len(impacts(pairs, x, motion, pair.distance)[0]):
            return False
        after = pairs.measure(x + motion).distance
        return bool((after > DIRECT_STEP_MARGIN * np.minimum(pair.distance, self.d_hat)).all())

    def _slope(self, x: FloatArray, barriers: BarrierSum) -> tuple[float, FloatArray]:
        self._ceiling = np.inf
        self._ceiling = self._value(x, barriers)
        m, successor = self.bodies.m, self.bodies.cage.successor
        gradient = barriers.gradient()
        gradient[:m] += self.weights.cages * self.energy.gradient(x[:m], successor)
        gradient[m:] += self.weights.restoring * (x[m:] - self.target)
        return self._ceiling, gradient

    def _value(self, x: FloatArray, barriers: BarrierSum) -> float:
        """E; without E_cont, the costly term, where the others already exceed E at the last slope and the line search
        rejects the state anyway."""
        m = self.bodies.m
        cages = self.energy.value(x[:m], self.bodies.cage.successor)
        if not np.isfinite(cages):
            return np.inf
        away = x[m:] - self.target
        restoring = 0.5 * float((away * away).sum())
        finite = self.weights.restoring * restoring + self.weights.cages * cages + barriers.value
        if finite > self._ceiling or self._contained(x):
            return finite
        return np.inf

    def _contained(self, x: FloatArray) -> bool:
        """Whether E_cont is 0, by parity as published or by exact predicates."""
        if self._exact is not None:
            return self._exact.value(x) == 0.0
        m = self.bodies.m
        return contained_by_parity(x[:m], self.bodies.cage.successor, x[m:], self.bodies.fine.successor)

    def _barriers(self, x: FloatArray) -> BarrierSum:
        """The barriers of the pairs within range."""
        pairs = self.candidates.within(x, self.d_hat, self.d_hat)
        pair = pairs.measure(x)
        active = (pair.distance < self.d_hat) & (pair.distance >= SMALLEST_DISTANCE)
        pairs, pair = pairs.take(active), pair.take(active)
        return BarrierSum.at(x, pairs, pair, weight=self.weights.barrier, d_hat=self.d_hat)

    def _near(self, x: FloatArray, motion: FloatArray) -> tuple[Pairs, PointEdge]:
        """A superset of the pairs that can meet in a motion."""
        longest = float(np.sqrt((motion * motion).sum(axis=1).max()))
        pairs = self.candidates.within(x, self.d_hat + 2.0 * longest, self.d_hat)
        return pairs, pairs.measure(x)
