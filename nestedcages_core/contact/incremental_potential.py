"""The energy of reinflation, λ_R R + λ_cages E_cages + λ_B B, and its projected Newton direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..energies import Blocks, CageEnergy
from ..energies.restoring import Restoring
from ..geometry.arrays import FloatArray
from ..geometry.distance import PointEdge
from ..solver.newton import NewtonModel
from .barrier import BarrierRanges, BarrierSum
from .ccd import impacts, largest_safe_step
from .pairs import Bodies, CandidateList, Pairs

CAGE_VERTEX_WEIGHT = 0.25
"""Boundary length of a cage vertex, as a fraction of the mean coarse edge length."""

DIRECT_STEP_MARGIN = 0.2
"""Fraction of its distance that each pair must keep when the fine mesh takes a step straight to its target."""


@dataclass(frozen=True)
class PotentialWeights:
    """The paper's λ, in units of the bounding-box diagonal and per boundary length."""

    restoring: float
    cages: float
    barrier: float


class IncrementalPotential:
    """λ_R R + λ_cages E_cages + λ_B B, the objective of a solver.

    Containment is kept by construction: the start is contained, and continuous collision detection bounds every step
    so that no point meets an edge. The barrier makes the line search agree.
    """

    def __init__(
        self,
        bodies: Bodies,
        energy: CageEnergy,
        restoring: Restoring,
        weights: PotentialWeights,
        ranges: BarrierRanges,
        candidates: CandidateList,
    ) -> None:
        self.bodies = bodies
        self.energy = energy
        self.restoring = restoring
        self.weights = weights
        self.ranges = ranges
        self.candidates = candidates
        self._x: FloatArray | None = None
        self._pairs: Pairs | None = None
        self._measured: PointEdge | None = None

    def value(self, x: FloatArray) -> float:
        """The energy at x (m + n, 2); infinite in contact and where the energy of the cage is."""
        m = self.bodies.m
        cages = self.energy.value(x[:m], self.bodies.cage.successor)
        if not np.isfinite(cages):
            return np.inf
        contact = self._barriers(x).value
        return self.weights.restoring * self.restoring.value(x[m:]) + self.weights.cages * cages + contact

    @np.errstate(invalid="ignore")
    def slope(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Value and gradient at x."""
        return self._slope(x, self._barriers(x))

    @np.errstate(invalid="ignore")  # distances near zero have infinite barriers: their steps are rejected by the value
    def newton(self, x: FloatArray) -> NewtonModel:
        """Value, gradient and projected Newton direction at x."""
        barriers = self._barriers(x)
        value, gradient = self._slope(x, barriers)
        hessian = self.energy.projected_hessian(x[: self.bodies.m], self.bodies.cage.successor)
        own = Blocks.sum([(self.weights.cages, hessian)])
        stiffness = self.weights.restoring * self.restoring.weight
        return NewtonModel(value, gradient, barriers.newton_direction(gradient, stiffness, own))

    def largest_step(self, x: FloatArray, direction: FloatArray) -> float:
        """Fraction of ``direction`` that is free of collisions."""
        squared = direction[:, 0] ** 2 + direction[:, 1] ** 2
        m = self.bodies.m
        cage, fine = float(np.sqrt(squared[:m].max())), float(np.sqrt(squared[m:].max()))
        pairs, pair = self._measure(x, self.ranges.largest + cage + max(cage, fine))
        return largest_safe_step(pairs, x, direction, pair.distance)

    def finished(self, x: FloatArray) -> bool:
        """Whether the fine mesh can go straight to its target and keep enough distance to the cage."""
        motion = np.zeros_like(x)
        m = self.bodies.m
        motion[m:] = self.restoring.target - x[m:]
        length = float(np.sqrt((motion * motion).sum(axis=1).max()))
        pairs, pair = self._measure(x, self.ranges.largest + length)
        after = pairs.measure(x + motion).distance
        if (after <= DIRECT_STEP_MARGIN * np.minimum(pair.distance, self.ranges.largest)).any():
            return False
        return len(impacts(pairs, x, motion, pair.distance)[0]) == 0

    def _barriers(self, x: FloatArray) -> BarrierSum:
        """The barriers of the pairs within range."""
        pairs, pair, d_hat = self._active(x)
        return BarrierSum.at(x, pairs, pair, weight=self._pair_weight(pairs, d_hat), d_hat=d_hat)

    def _slope(self, x: FloatArray, barriers: BarrierSum) -> tuple[float, FloatArray]:
        m, successor = self.bodies.m, self.bodies.cage.successor
        cage, fine = x[:m], x[m:]
        value = (
            self.weights.restoring * self.restoring.value(fine)
            + self.weights.cages * self.energy.value(cage, successor)
            + barriers.value
        )
        gradient = barriers.gradient()
        gradient[:m] += self.weights.cages * self.energy.gradient(cage, successor)
        gradient[m:] += self.weights.restoring * self.restoring.gradient(fine)
        return value, gradient

    def _measure(self, x: FloatArray, reach: float) -> tuple[Pairs, PointEdge]:
        """The candidate pairs for a reach and their distances, cached for the last x."""
        pairs = self.candidates.within(x, reach, self.bodies.cage_edge_length)
        if self._x is not x or self._pairs is not pairs or self._measured is None:
            self._x, self._pairs, self._measured = x, pairs, pairs.measure(x)
        return pairs, self._measured

    def _active(self, x: FloatArray) -> tuple[Pairs, PointEdge, FloatArray]:
        """The pairs within range, their distances and ranges."""
        pairs, pair = self._measure(x, self.ranges.largest)
        d_hat = self.ranges.of(self.bodies, pairs)
        active = pair.distance < d_hat
        return pairs.take(active), pair.take(active), d_hat[active]

    def _pair_weight(self, pairs: Pairs, d_hat: FloatArray) -> FloatArray:
        """(K,) λ_B · boundary length / d̂: the pressure is then of order λ_B for every range."""
        weight = np.full(len(pairs), CAGE_VERTEX_WEIGHT * self.bodies.cage_edge_length)
        weight[pairs.fine_cage] = self.bodies.fine_weight[pairs.point[pairs.fine_cage] - self.bodies.m]
        weight *= self.weights.barrier / d_hat
        return weight
