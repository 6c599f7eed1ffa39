"""The energy of reinflation, λ_R R + λ_cages E_cages + λ_B B, and its projected Newton direction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..energies import Blocks, CageEnergy
from ..geometry.arrays import FloatArray
from ..geometry.distance import PointEdge
from ..geometry.vectors import inner, norm
from ..solver.newton import NewtonModel
from .barrier import BarrierSum
from .ccd import impacts, largest_safe_step
from .pairs import Bodies, CandidateList, Pairs

CAGE_VERTEX_WEIGHT = 0.25
"""Boundary length of a cage vertex, as a fraction of the mean coarse edge length."""

DIRECT_STEP_MARGIN = 0.2
"""Fraction of its distance that each pair must keep when the fine mesh takes a step straight to its target."""


class PotentialWeights(NamedTuple):
    """The paper's λ, in units of the bounding-box diagonal and per boundary length."""

    restoring: float
    cages: float
    barrier: float


class IncrementalPotential:
    """λ_R R + λ_cages E_cages + λ_B B, the objective of a solver (Gurditta & Jacobson 2022, section 3.2).

    R is ½ Σ w |f - target|² with the boundary length w of each fine vertex. Containment is kept by construction: the
    start is contained, and continuous collision detection bounds every step so that no point meets an edge. The barrier
    makes the line search agree.
    """

    def __init__(
        self,
        bodies: Bodies,
        energy: CageEnergy,
        target: FloatArray,
        weights: PotentialWeights,
        d_hat: float,
        candidates: CandidateList,
    ) -> None:
        """energy: E_cages; target: (n, 2) positions that the fine vertices are pulled to; d_hat: range of B."""
        self.bodies, self.energy, self.target = bodies, energy, target
        self.weights, self.d_hat, self.candidates = weights, d_hat, candidates
        self.stiffness: FloatArray = weights.restoring * bodies.fine_weight
        """(n,) of the pull of each fine vertex."""
        self._last: tuple[FloatArray, Pairs, PointEdge] | None = None

    def value(self, x: FloatArray) -> float:
        """The energy at x (m + n, 2); infinite in contact and where the energy of the cage is."""
        cages = self.energy.value(x[: self.bodies.m], self.bodies.cage.successor)
        return self._sum(x, cages, self._barriers(x)) if np.isfinite(cages) else np.inf

    @np.errstate(invalid="ignore")  # distances near zero have infinite barriers: their steps are rejected by the value
    def slope(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Value and gradient at x."""
        return self._slope(x, self._barriers(x))

    @np.errstate(invalid="ignore")
    def newton(self, x: FloatArray) -> NewtonModel:
        """Value, gradient and projected Newton direction at x."""
        barriers = self._barriers(x)
        value, gradient = self._slope(x, barriers)
        hessian = self.energy.projected_hessian(x[: self.bodies.m], self.bodies.cage.successor)
        own = Blocks.sum([(self.weights.cages, hessian)])
        return NewtonModel(value, gradient, barriers.newton_direction(gradient, self.stiffness, own))

    def largest_step(self, x: FloatArray, direction: FloatArray) -> float:
        """Fraction of ``direction`` that is free of collisions."""
        length, m = norm(direction), self.bodies.m
        cage, fine = float(length[:m].max()), float(length[m:].max())
        pairs, pair = self._measure(x, self.d_hat + cage + max(cage, fine))
        return largest_safe_step(pairs, x, direction, pair.distance)

    def finished(self, x: FloatArray) -> bool:
        """Whether the fine mesh can go straight to its target and keep enough distance to the cage."""
        motion, m = np.zeros_like(x), self.bodies.m
        motion[m:] = self.target - x[m:]
        pairs, pair = self._measure(x, self.d_hat + float(norm(motion).max()))
        after = pairs.measure(x + motion).distance
        if (after <= DIRECT_STEP_MARGIN * np.minimum(pair.distance, self.d_hat)).any():
            return False
        return len(impacts(pairs, x, motion, pair.distance)[0]) == 0

    def _barriers(self, x: FloatArray) -> BarrierSum:
        """The barriers of the pairs within range.

        Weighted by λ_B · boundary length / d̂, their pressure is of order λ_B for every range.
        """
        pairs, pair = self._measure(x, self.d_hat)
        active = pair.distance < self.d_hat
        pairs, pair = pairs.take(active), pair.take(active)
        weight = np.full(len(pairs), CAGE_VERTEX_WEIGHT * self.bodies.cage_edge_length)
        weight[pairs.fine_cage] = self.bodies.fine_weight[pairs.point[pairs.fine_cage] - self.bodies.m]
        return BarrierSum.at(x, pairs, pair, weight=weight * self.weights.barrier / self.d_hat, d_hat=self.d_hat)

    def _sum(self, x: FloatArray, cages: float, barriers: BarrierSum) -> float:
        away = x[self.bodies.m :] - self.target
        restoring = 0.5 * inner(self.stiffness, (away * away).sum(axis=1))
        return restoring + self.weights.cages * cages + barriers.value

    def _slope(self, x: FloatArray, barriers: BarrierSum) -> tuple[float, FloatArray]:
        m, successor = self.bodies.m, self.bodies.cage.successor
        gradient = barriers.gradient()
        gradient[:m] += self.weights.cages * self.energy.gradient(x[:m], successor)
        gradient[m:] += self.stiffness[:, None] * (x[m:] - self.target)
        return self._sum(x, self.energy.value(x[:m], successor), barriers), gradient

    def _measure(self, x: FloatArray, reach: float) -> tuple[Pairs, PointEdge]:
        """The candidate pairs for a reach and their distances, kept for the last x."""
        pairs = self.candidates.within(x, reach, self.bodies.cage_edge_length)
        if self._last is None or self._last[0] is not x or self._last[1] is not pairs:
            self._last = x, pairs, pairs.measure(x)
        return pairs, self._last[2]
