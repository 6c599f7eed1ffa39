"""Incremental Potential Contact as published (Li et al. 2020), with the fine mesh as a moving boundary.

Every step of the flow is a time step of a quasi-static body, the cage: its incremental potential is E_cages + κ B, and
the Hessian of E_cages, of order 1, stands for the mass. The fine mesh is prescribed. Where it cannot go straight to its
target, an augmented Lagrangian pulls it there (supplement, section 2), ρ/2 Σ |f - target|² - Σ λ · (f - target), with ρ
doubled while the fine mesh is far from its target and λ updated from then on.

B is the sum of b(D, D̂) = -(D - D̂)² log(D / D̂), D = d², D̂ = d̂², over all point-edge pairs closer than d̂ (equation 6, of
squared distances as in their program); pairs of neighbouring edges that share their closest vertex both count. Newton
steps in all positions at once, with the full sparse Hessian, each pair's part projected by clamping eigenvalues, are
bounded by continuous collision detection, and halved while they raise the potential. Our only addition: once the fine
mesh can move straight to its target, it is placed there exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from nestedcages_core import Area
from nestedcages_core.contact import ContactOutcome
from nestedcages_core.contact.barrier import BarrierTerms, barrier
from nestedcages_core.contact.base import OnStep
from nestedcages_core.contact.ccd import impacts
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs
from nestedcages_core.geometry.distance import (
    PointEdge,
    bending,
    coefficients,
    distance_gradient,
    interior,
    tangents,
)

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class SquaredBarrier:
    """Σ b(d², d̂²) over K pairs at positions x (m + n, 2)."""

    x: Array
    pairs: Pairs
    measured: PointEdge
    d_hat: float

    @classmethod
    def at(cls, x: Array, pairs: Pairs, d_hat: float) -> SquaredBarrier:
        """The sum over those of the pairs that are closer than d̂."""
        measured = pairs.measure(x)
        active = measured.distance < d_hat
        return cls(x, pairs.take(active), measured.take(active), d_hat)

    @cached_property
    def terms(self) -> BarrierTerms:
        """b and its derivatives with respect to the squared distance."""
        squared = self.measured.distance**2
        return barrier(squared, self.d_hat**2)

    @cached_property
    def slope(self) -> Array:
        """(K, 6) gradient of the squared distance, 2 d ∂d."""
        gradient: Array = 2.0 * self.measured.distance[:, None] * distance_gradient(self.measured)
        return gradient

    @property
    def value(self) -> float:
        """The sum; infinite in contact."""
        return float(self.terms.value.sum())

    def gradient(self) -> Array:
        """(m + n, 2)."""
        push, total = (self.terms.first[:, None] * self.slope).reshape(-1, 2), np.zeros_like(self.x)
        np.add.at(total, self.pairs.corners.ravel(), push)
        return total

    def hessians(self) -> Array:
        """(K, 6, 6) exact Hessian of each pair, b'' ∂D ∂Dᵀ + b' ∂²D."""
        starts, ends = self.x[self.pairs.start], self.x[self.pairs.end]
        first = distance_gradient(self.measured)
        second = distance_hessian(self.measured, starts, ends)
        curvature = 2.0 * (first[:, :, None] * first[:, None, :] + self.measured.distance[:, None, None] * second)
        along = self.slope[:, :, None] * self.slope[:, None, :]
        hessians: Array = self.terms.second[:, None, None] * along + self.terms.first[:, None, None] * curvature
        return hessians

    def hessian(self, *, projected: bool) -> sp.csr_matrix:
        """(2 (m + n), 2 (m + n)); projected: every pair's without its negative eigenvalues (section 4.3)."""
        blocks = self.hessians()
        if projected:
            values, vectors = np.linalg.eigh(blocks)
            blocks = (vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1)
        dof = (2 * self.pairs.corners[:, :, None] + np.arange(2)).reshape(-1, 6)
        rows = np.broadcast_to(dof[:, :, None], blocks.shape)
        columns = np.broadcast_to(dof[:, None, :], blocks.shape)
        size = 2 * len(self.x)
        return sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))


def distance_hessian(pairs: PointEdge, a: Array, b: Array) -> Array:
    """(K, 6, 6) Hessian of the distances with respect to (p, a, b); a and b are the (K, 2) ends of the edges."""
    c_t = (coefficients(pairs)[:, :, None] * tangents(pairs, a, b)[:, None, :]).reshape(-1, 6)
    q = bending(pairs)
    mixed = c_t[:, :, None] * q[:, None, :]
    inside = -(mixed + mixed.transpose(0, 2, 1)) - pairs.distance[:, None, None] * (q[:, :, None] * q[:, None, :])
    at_end = c_t[:, :, None] * c_t[:, None, :] / np.maximum(pairs.distance, 1e-150)[:, None, None]
    return np.where(interior(pairs)[:, None, None], inside, at_end)


REFERENCE_DISTANCE = 1e-8  # distance, in bounding-box diagonals, at which the least stiffness is measured
STIFFNESS_RANGE = 100.0  # largest κ over the least one
STIFFENING = 2.0  # factor on κ while pairs that are very close come closer still
VERY_CLOSE = 1e-9  # distance, in bounding-box diagonals, below which a pair is very close


@dataclass(frozen=True)
class StiffnessBounds:
    """Bounds on κ for one range d̂; lengths in bounding-box diagonals, masses of 1."""

    least: float
    largest: float

    @classmethod
    def of(cls, d_hat: float, stiffness: float) -> StiffnessBounds:
        """κ that gives the barrier the curvature ``stiffness`` at the reference distance, and a hundred times that."""
        squared = REFERENCE_DISTANCE**2
        curvature = float(barrier(np.array([squared]), d_hat**2).second[0])
        least = stiffness / (4.0 * squared * curvature)
        return cls(least, STIFFNESS_RANGE * least)

    def first(self, energy: Array, contact: Array) -> float:
        """κ that balances the gradients of the energy and of the barriers where both act, within the bounds."""
        squared = float((contact * contact).sum())
        balancing = -float((contact * energy).sum()) / squared if squared > 0.0 else 0.0
        return min(max(balancing, self.least), self.largest)

    def raised(self, kappa: float, before: dict[int, float], now: dict[int, float]) -> float:
        """κ after a step: doubled if a pair that was very close has not moved apart."""
        closer = any(now.get(pair, np.inf) <= distance for pair, distance in before.items())
        return min(STIFFENING * kappa, self.largest) if closer else kappa


SLACKNESS = 0.8  # fraction of the time of impact that a step may take
FIRST_PENALTY, LARGEST_PENALTY, PENALTY_GROWTH = 1e6, 1e8, 2.0  # ρ: first value, maximum, and growth factor
NEAR_ARRIVAL = 0.99  # fraction of the path from which λ is updated instead of ρ
MAX_HALVINGS = 60  # cap on the halvings of a step
MAX_SHIFTS = 8  # cap on the shifts of a Hessian that rounding has made singular
FIRST_SHIFT, SHIFT_GROWTH = 1e-10, 100.0
"""First shift, relative to the largest diagonal entry of the cage, and its growth."""

ROOM_LEFT = 0.2  # fraction of its distance that each pair must keep when the fine mesh is placed at its target


@dataclass(frozen=True)
class OriginalIPC:
    """One range for all pairs, adaptive stiffness, full projected Newton; lengths in bounding-box diagonals."""

    energy: object = field(default_factory=Area)
    """E_cages, the potential of the cage; its projected Hessian must be positive definite."""
    d_hat: float = 1e-3  # d̂, the range of the barrier
    stiffness: float = 1e11
    """Curvature of the softest barrier at a distance of 1e-8, in units of the mass: the lower bound of κ."""
    tolerance: float = 2.5e-4
    """Largest component of a Newton step at which a time step ends: 1e-2 per unit of time, for steps of 0.025."""
    iterations: int = 300  # maximum number of Newton steps per step of the flow; the original has 10,000

    def reinflate(
        self, bodies: Bodies, x: Array, path: Sequence[Array], *, clearance: float, on_step: OnStep
    ) -> ContactOutcome:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`. It has no clearance."""
        energy = self.energy.at(bodies.coarse)
        candidates = CandidateList(bodies)
        iterations = 0
        for target in path:
            step = _TimeStep(self, bodies, energy.after(x[: bodies.m]), candidates, target)
            arrived = step.run(x, on_step)
            x = step.x
            iterations += step.iterations
            if not arrived:
                worst = int(np.hypot(*(target - x[bodies.m :]).T).argmax())
                return ContactOutcome(x, False, iterations, f"the cage holds up fine vertex {worst}")
        return ContactOutcome(x, True, iterations)


class _TimeStep:
    """One step of the fine mesh towards a target, and the state of its minimisation."""

    def __init__(
        self, settings: OriginalIPC, bodies: Bodies, energy: object, candidates: CandidateList, target: Array
    ) -> None:
        self.settings, self.bodies, self.energy, self.target = settings, bodies, energy, target
        self.candidates = candidates
        self.bounds = StiffnessBounds.of(settings.d_hat, settings.stiffness)
        self.kappa = self.bounds.least
        self.penalty = FIRST_PENALTY
        self.multiplier = np.zeros_like(target)
        self.arrived = False
        self.iterations = 0
        self.x = np.zeros((0, 2))

    def run(self, x: Array, on_step: OnStep) -> bool:
        """Newton steps from x (m + n, 2) until the fine mesh is at its target and the cage at rest."""
        m = self.bodies.m
        self.x = x
        whole = float(np.linalg.norm(self.target - x[m:]))
        if self._place():
            on_step(self.x)
        barriers = self._barriers(self.x)
        self.kappa = self.bounds.first(self._cage_gradient(self.x), barriers.gradient())
        close = self._very_close(barriers)
        part = 1.0 if self.arrived else 0.0
        for _ in range(self.settings.iterations):
            self.iterations += 1
            direction = self._direction(barriers)
            longest = float(np.abs(direction).max())
            if self.arrived and longest < self.settings.tolerance:
                return True
            if not self._advance(direction, barriers):
                return self.arrived
            on_step(self.x)
            if self._place():
                on_step(self.x)
            barriers = self._barriers(self.x)
            before, close = close, self._very_close(barriers)
            self.kappa = self.bounds.raised(self.kappa, before, close)
            if not self.arrived:
                part = self._pull(part, whole, longest)
        return self.arrived

    def _pull(self, before: float, whole: float, longest: float) -> float:
        """Update the penalty or the multipliers; returns the fraction of the path that is done."""
        part = 1.0 - float(np.linalg.norm(self.x[self.bodies.m :] - self.target)) / whole
        softer = self.penalty < LARGEST_PENALTY
        if part < before and softer:
            self.penalty *= PENALTY_GROWTH
        elif longest < self.settings.tolerance:
            if part < NEAR_ARRIVAL and softer:
                self.penalty *= PENALTY_GROWTH
            else:
                self.multiplier -= self.penalty * (self.x[self.bodies.m :] - self.target)
        return part

    def _place(self) -> bool:
        """Put the fine mesh at its target if it can move straight there; returns whether it was put there now."""
        if self.arrived:
            return False
        motion = np.zeros_like(self.x)
        motion[self.bodies.m :] = self.target - self.x[self.bodies.m :]
        pairs = self.candidates.within(self.x, self._reach(motion), self.settings.d_hat)
        distance = pairs.measure(self.x).distance
        moved = self.x + motion
        moved[self.bodies.m :] = self.target
        after = pairs.measure(moved).distance
        if (
            len(impacts(pairs, self.x, motion, distance)[0])
            or (after <= ROOM_LEFT * np.minimum(distance, self.settings.d_hat)).any()
        ):
            return False
        self.x, self.arrived = moved, True
        return True

    def _reach(self, motion: Array) -> float:
        return self.settings.d_hat + 2.0 * float(np.sqrt((motion * motion).sum(axis=1).max()))

    def _barriers(self, x: Array) -> SquaredBarrier:
        pairs = self.candidates.within(x, self.settings.d_hat, self.settings.d_hat)
        return SquaredBarrier.at(x, pairs, self.settings.d_hat)

    def _very_close(self, barriers: SquaredBarrier) -> dict[int, float]:
        """Distances of the pairs that are very close, by pair."""
        pairs, size = barriers.pairs, len(barriers.x)
        chosen = np.flatnonzero(barriers.measured.distance < VERY_CLOSE)
        keys = pairs.point[chosen] * size + pairs.start[chosen]
        return dict(zip(keys.tolist(), barriers.measured.distance[chosen].tolist(), strict=True))

    def _cage_gradient(self, x: Array) -> Array:
        """(m + n, 2) of the energy of the cage alone."""
        gradient = np.zeros_like(x)
        gradient[: self.bodies.m] = self.energy.gradient(x[: self.bodies.m], self.bodies.cage.successor)
        return gradient

    def _value(self, x: Array, barriers: SquaredBarrier) -> float:
        m = self.bodies.m
        value = self.energy.value(x[:m], self.bodies.cage.successor) + self.kappa * barriers.value
        if self.arrived:
            return value
        away = x[m:] - self.target
        return value + 0.5 * self.penalty * float((away * away).sum()) - float((self.multiplier * away).sum())

    def _direction(self, barriers: SquaredBarrier) -> Array:
        """Newton direction; the fine mesh no longer moves once it has arrived."""
        m, x = self.bodies.m, self.x
        gradient = self._cage_gradient(x) + self.kappa * barriers.gradient()
        cage = self.energy.projected_hessian(x[:m], self.bodies.cage.successor).sparse(m)
        fine = np.full(2 * self.bodies.n, self.penalty)
        hessian = sp.block_diag([cage, sp.diags(fine)], format="csr") + self.kappa * barriers.hessian(projected=True)
        if self.arrived:
            direction = np.zeros_like(x)
            direction[:m] = _solved(hessian[: 2 * m, : 2 * m], -gradient[:m].ravel()).reshape(-1, 2)
            return direction
        gradient[m:] += self.penalty * (x[m:] - self.target) - self.multiplier
        return _solved(hessian, -gradient.ravel()).reshape(-1, 2)

    def _advance(self, direction: Array, barriers: SquaredBarrier) -> bool:
        """Take the longest step without impact that does not raise the potential; False if there is none."""
        pairs = self.candidates.within(self.x, self._reach(direction), self.settings.d_hat)
        _, times = impacts(pairs, self.x, direction, pairs.measure(self.x).distance)
        step = min(1.0, SLACKNESS * float(times.min())) if len(times) else 1.0
        before = self._value(self.x, barriers)
        for _ in range(MAX_HALVINGS):
            moved = self.x + step * direction
            if self._value(moved, self._barriers(moved)) <= before:
                self.x = moved
                return True
            step *= 0.5
        return False


def _solved(matrix: sp.csr_matrix, right: Array) -> Array:
    """Solution of a positive semi-definite system, shifted where rounding has made it singular."""
    diagonal = float(np.abs(matrix.diagonal()).max())
    shift = 0.0
    for _ in range(MAX_SHIFTS):
        try:
            solution = scipy.sparse.linalg.splu(
                sp.csc_matrix(matrix + shift * sp.identity(matrix.shape[0])),
                permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True},
            ).solve(right)  # fmt: skip
            if np.isfinite(solution).all() and float(solution @ right) >= 0.0:
                return np.asarray(solution)
        except RuntimeError:  # exactly singular
            pass
        shift = max(SHIFT_GROWTH * shift, FIRST_SHIFT * diagonal)
    return right / max(diagonal, 1.0)
