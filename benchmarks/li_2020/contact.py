"""Incremental Potential Contact as published (Li et al. 2020), with the fine mesh as a moving boundary.

Every step of the flow is a time step of a quasi-static body, the cage: its incremental potential is E_cages + κ B, and
the Hessian of E_cages, of order 1, stands for the mass. The fine mesh is prescribed. Where it cannot go straight to its
target, an augmented Lagrangian pulls it there (supplement, section 2),

    ρ/2 Σ |f - target|² - Σ λ · (f - target),

with ρ doubled while the fine mesh is far from its target and λ updated from then on.

The potential is minimised by Newton steps in all positions at once, with the full sparse Hessian, every pair's and
every edge's part projected by clamping eigenvalues, bounded by continuous collision detection, and halved while they
raise the potential. Our only addition: once the fine mesh can move straight to its target, it is placed there exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from nestedcages_core.contact.base import ContactOutcome
from nestedcages_core.contact.ccd import impacts
from nestedcages_core.contact.pairs import Bodies, CandidateList
from nestedcages_core.energies import Area, CageEnergy, Energy
from nestedcages_core.geometry.arrays import FloatArray
from nestedcages_core.parameters import check_count, check_part, check_positive
from nestedcages_core.tasks import Stage

from .barrier import SquaredBarrier
from .stiffness import VERY_CLOSE, StiffnessBounds

SLACKNESS = 0.8
"""Fraction of the time of impact that a step may take."""

FIRST_PENALTY, LARGEST_PENALTY, PENALTY_GROWTH = 1e6, 1e8, 2.0
"""ρ: first value, maximum, and growth factor."""

NEAR_ARRIVAL = 0.99
"""Fraction of the path from which λ is updated instead of ρ."""

MAX_HALVINGS = 60
"""Cap on the halvings of a step."""

MAX_SHIFTS = 8
"""Cap on the shifts of a Hessian that rounding has made singular."""

FIRST_SHIFT, SHIFT_GROWTH = 1e-10, 100.0
"""First shift, relative to the largest diagonal entry of the cage, and its growth."""

ROOM_LEFT = 0.2
"""Fraction of its distance that each pair must keep when the fine mesh is placed at its target."""


@dataclass(frozen=True)
class OriginalIPC:
    """One range for all pairs, adaptive stiffness, full projected Newton; lengths in bounding-box diagonals."""

    energy: Energy = field(default_factory=Area)
    """E_cages, the potential of the cage; its projected Hessian must be positive definite."""
    d_hat: float = 1e-3
    """d̂, the range of the barrier."""
    stiffness: float = 1e11
    """Curvature of the softest barrier at a distance of 1e-8, in units of the mass: the lower bound of κ."""
    tolerance: float = 2.5e-4
    """Largest component of a Newton step at which a time step ends: 1e-2 per unit of time, for steps of 0.025."""
    iterations: int = 300
    """Maximum number of Newton steps per step of the flow; the original has 10,000."""

    def __post_init__(self) -> None:
        check_positive(self, "d_hat", "stiffness", "tolerance")
        check_count(self, "iterations")
        check_part(self, "energy", "at", "Area()")

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float
    ) -> Stage[FloatArray, ContactOutcome]:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`. It has no clearance."""
        energy = self.energy.at(bodies.coarse)
        candidates = CandidateList(bodies)
        iterations = 0
        for target in path:
            step = _TimeStep(self, bodies, energy.after(x[: bodies.m]), candidates, target)
            arrived = yield from step.run(x)
            x = step.x
            iterations += step.iterations
            if not arrived:
                worst = int(np.hypot(*(target - x[bodies.m :]).T).argmax())
                return ContactOutcome(x, False, iterations, f"the cage holds up fine vertex {worst}")
        return ContactOutcome(x, True, iterations)


class _TimeStep:
    """One step of the fine mesh towards a target, and the state of its minimisation."""

    def __init__(
        self, settings: OriginalIPC, bodies: Bodies, energy: CageEnergy, candidates: CandidateList, target: FloatArray
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

    def run(self, x: FloatArray) -> Stage[FloatArray, bool]:
        """Newton steps from x (m + n, 2) until the fine mesh is at its target and the cage at rest."""
        m = self.bodies.m
        self.x = x
        whole = float(np.linalg.norm(self.target - x[m:]))
        if self._place():
            yield self.x
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
            yield self.x
            if self._place():
                yield self.x
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

    def _reach(self, motion: FloatArray) -> float:
        return self.settings.d_hat + 2.0 * float(np.sqrt((motion * motion).sum(axis=1).max()))

    def _barriers(self, x: FloatArray) -> SquaredBarrier:
        pairs = self.candidates.within(x, self.settings.d_hat, self.settings.d_hat)
        return SquaredBarrier.at(x, pairs, self.settings.d_hat)

    def _very_close(self, barriers: SquaredBarrier) -> dict[int, float]:
        """Distances of the pairs that are very close, by pair."""
        pairs, size = barriers.pairs, len(barriers.x)
        chosen = np.flatnonzero(barriers.measured.distance < VERY_CLOSE)
        keys = pairs.point[chosen] * size + pairs.start[chosen]
        return dict(zip(keys.tolist(), barriers.measured.distance[chosen].tolist(), strict=True))

    def _cage_gradient(self, x: FloatArray) -> FloatArray:
        """(m + n, 2) of the energy of the cage alone."""
        gradient = np.zeros_like(x)
        gradient[: self.bodies.m] = self.energy.gradient(x[: self.bodies.m], self.bodies.cage.successor)
        return gradient

    def _value(self, x: FloatArray, barriers: SquaredBarrier) -> float:
        m = self.bodies.m
        value = self.energy.value(x[:m], self.bodies.cage.successor) + self.kappa * barriers.value
        if self.arrived:
            return value
        away = x[m:] - self.target
        return value + 0.5 * self.penalty * float((away * away).sum()) - float((self.multiplier * away).sum())

    def _direction(self, barriers: SquaredBarrier) -> FloatArray:
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

    def _advance(self, direction: FloatArray, barriers: SquaredBarrier) -> bool:
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


def _solved(matrix: sp.csr_matrix, right: FloatArray) -> FloatArray:
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
