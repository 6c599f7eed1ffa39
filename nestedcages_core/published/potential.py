"""The energy of reinflation, with the weights of the paper's program (Gurditta & Jacobson 2022, section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..contact.barrier import BarrierSum
from ..contact.ccd import impacts
from ..contact.incremental_potential import DIRECT_STEP_MARGIN
from ..contact.pairs import Bodies, Pairs, find_pairs
from ..energies import Blocks, CageEnergy
from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from ..parameters import check_not_negative
from ..solver.newton import NewtonModel
from .ray_parity import contained_by_parity

SMALLEST_DISTANCE = 1e-15
"""Distance in bounding-box diagonals below which the program has no barrier, to skip a vertex and its own edges."""

MAX_PAIRS = 20_000_000
"""Maximum number of pairs stored: more would not fit into the memory of a small machine."""


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

    target: FloatArray
    """(n, 2) where R draws the fine mesh to."""
    ends_at_target: bool
    """Whether the minimisation ends where the fine mesh can go straight to its target; False as published."""

    def __init__(self, bodies: Bodies, energy: CageEnergy, weights: PaperWeights, d_hat: float, *, exact: bool) -> None:
        """exact: whether E_cont is decided by exact predicates, not by parity."""
        self.bodies, self.energy, self.weights, self.d_hat = bodies, energy, weights, d_hat
        self.target, self.ends_at_target = bodies.fine.vertices, False
        self._ceiling = np.inf
        self._exact = exact

    @cached_property
    def _all_pairs(self) -> Pairs:
        count = self.bodies.m * (2 * self.bodies.n + self.bodies.m)
        if count > MAX_PAIRS:
            raise invalid_setting(f"The paper's method cannot hold {count} pairs; use IPC() for meshes of this size.")
        return find_pairs(self.bodies, np.zeros((self.bodies.m + self.bodies.n, 2)), np.inf)

    def near(self, x: FloatArray, motion: float = 0.0) -> Pairs:
        """All pairs that may come closer than d̂ when no vertex moves farther than a length: every one."""
        return self._all_pairs

    def value(self, x: FloatArray) -> float:
        """E at x (m + n, 2)."""
        return self._value(x, self.barriers(x))

    def slope(self, x: FloatArray) -> tuple[float, FloatArray]:
        """E and the gradient of its finite terms."""
        return self._slope(x, self.barriers(x))

    def newton(self, x: FloatArray) -> NewtonModel:
        """E, its gradient and its projected Newton direction, named as further work by the paper."""
        barriers = self.barriers(x)
        value, gradient = self._slope(x, barriers)
        hessian = self.energy.projected_hessian(x[: self.bodies.m], self.bodies.cage.successor)
        stiffness = np.full(self.bodies.n, self.weights.restoring)
        own = Blocks.sum([(self.weights.cages, hessian)])
        return NewtonModel(value, gradient, barriers.newton_direction(gradient, stiffness, own))

    def largest_step(self, x: FloatArray, direction: FloatArray) -> float:
        """1: only the infinite energy of a crossing rejects a step afterwards."""
        return 1.0

    def finished(self, x: FloatArray) -> bool:
        """Whether the fine mesh can go straight to its target, if it ends there."""
        if not self.ends_at_target:
            return False
        motion = np.zeros_like(x)
        motion[self.bodies.m :] = self.target - x[self.bodies.m :]
        pairs = self.near(x, float(np.sqrt((motion * motion).sum(axis=1).max())))
        distance = pairs.measure(x).distance
        if len(impacts(pairs, x, motion, distance)[0]):
            return False
        after = pairs.measure(x + motion).distance
        return bool((after > DIRECT_STEP_MARGIN * np.minimum(distance, self.d_hat)).all())

    def barriers(self, x: FloatArray) -> BarrierSum:
        """The barriers of the pairs within range."""
        pairs = self.near(x)
        pair = pairs.measure(x)
        active = (pair.distance < self.d_hat) & (pair.distance >= SMALLEST_DISTANCE)
        pairs, pair = pairs.take(active), pair.take(active)
        return BarrierSum.at(x, pairs, pair, weight=self.weights.barrier, d_hat=self.d_hat)

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
        """Whether E_cont is 0."""
        if self._exact:
            return self.bodies.first_contact(x) is None
        m = self.bodies.m
        return contained_by_parity(x[:m], self.bodies.cage.successor, x[m:], self.bodies.fine.successor)
