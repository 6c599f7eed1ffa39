"""The response of the cage to a motion of the fine mesh: the smallest motion that keeps the wanted distances.

For a motion E of the fine mesh the response D solves a proximal quadratic program, with distances to first order,

    minimise   ½ |D|² + ½ Σ e² / ε
    subject to d + ∂d·(D, E) + e ≥ wanted distance,   |D_i| ≤ Δ along and across the cage,

soft in e, so that it always has a solution. Every contact wants two distances: a hard one, half of its current distance
down to the clearance, which lets the motion go on; and a larger one where the cage is free to move, since a cage that
is too close can only take the smallest steps. The cage moves by contact alone: with an energy it would drift while the
fine mesh is still away.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..energies import Blocks
from ..geometry.arrays import FloatArray
from ..geometry.precision import BACKTRACKING, MOST_ROUNDS, NEGLIGIBLE
from ..solver.banded import Rows
from ..solver.quadratic_program import InteriorPoint, QuadraticProgram
from .ccd import impacts, largest_safe_step
from .linearisation import Contacts, constraint_rows, distance_change, local_axes, measure, resolve_corners
from .pairs import Bodies, CandidateList, Pairs, WantedDistances
from .pruning import not_implied

HARD_COMPLIANCE = 3e-5
"""ε of the hard distances: violation per unit of force, where the force D moves the cage by D."""

SOFT_COMPLIANCE = 0.1
"""ε of the larger distances: nine tenths of the distance are made up where nothing else holds the cage."""

GAP_GROWTH = 0.25
"""How much the larger distance exceeds the current one, as a fraction of the working gap."""

SKIN = 0.3
"""Skin of the candidate list, as a fraction of the search radius beyond the wanted distance."""

SMALLEST_SCALE = 0.1
"""Lower bound of the expected multipliers, as a fraction of the working gap."""

KEPT_DISTANCE = 0.5
"""Fraction of a distance below the clearance that a motion must leave."""

KEPT_GAP = 0.05
"""Distance that a motion must leave on top, as a fraction of the distance or of the working gap."""


@dataclass(frozen=True)
class Distances(WantedDistances):
    """Final distances to keep, and the working gap."""

    gap: float
    """Distance to keep in addition during the motion, where there is space; a length."""


class Prepared(NamedTuple):
    """A motion of the fine mesh, and the quadratic program whose solution is the motion of the cage."""

    motion: FloatArray
    """(m + n, 2), the cage at rest."""
    pairs: Pairs
    contacts: Contacts
    program: QuadraticProgram


class Response(NamedTuple):
    """A motion of cage and fine mesh, and the pairs that can meet in it."""

    motion: FloatArray
    """(m + n, 2)."""
    pairs: Pairs
    """All pairs that can meet."""
    contacts: Contacts
    """Contacts of these pairs before the motion."""
    systems: int
    """Number of linear systems solved."""


@dataclass(eq=False)
class ContactResponse:
    """Computes responses; reuses candidate pairs."""

    bodies: Bodies
    distances: Distances
    solver: InteriorPoint
    candidates: CandidateList = field(init=False)

    def __post_init__(self) -> None:
        self.candidates = CandidateList(self.bodies)
        self._order = self.bodies.order
        still = np.arange(self.bodies.m)
        self._proximal = Blocks(still, still, np.broadcast_to(np.eye(2), (self.bodies.m, 2, 2)))

    def to(self, fine_motion: FloatArray, x: FloatArray, radius: float) -> Response:
        """The response to a motion (n, 2) of the fine mesh at x (m + n, 2), at most ``radius`` along each axis."""
        return self.solved(self.prepared(fine_motion, x, radius))

    def prepared(self, fine_motion: FloatArray, x: FloatArray, radius: float) -> Prepared:
        """The first half of :meth:`to`: the pairs that can meet and their constraints."""
        m, gap = self.bodies.m, self.distances.gap
        length = np.hypot(fine_motion[:, 0], fine_motion[:, 1])
        longest = float(length.max())
        farthest = self.distances.largest + gap
        farthest_cage = float(np.sqrt(2.0)) * radius  # along both axes
        farthest_motion = np.concatenate([np.full(m, farthest_cage), length])
        reach = farthest_cage + longest
        all_pairs = self.candidates.meeting(x, farthest, farthest_motion, farthest + reach, SKIN * reach)
        all_contacts = measure(all_pairs, x)

        near = np.flatnonzero(all_contacts.distance - farthest < all_pairs.approach(farthest_motion))
        pairs, contacts = resolve_corners(self.bodies, all_pairs.take(near), all_contacts.take(near), x, 0.0)
        motion = np.concatenate([np.zeros((m, 2)), fine_motion])
        farthest_motion[m:] = 0.0
        rows, room, softness = self._constraints(pairs, contacts, motion, farthest_motion)
        if self.bodies.bounds:
            from ..constraints.base import terms_of

            more, rooms = terms_of(self.bodies.bounds, x[:m], radius)
            rows, room = [*rows, *more], np.concatenate((room, rooms))
            softness = np.concatenate((softness, np.full(len(rooms), HARD_COMPLIANCE)))
        program = QuadraticProgram(
            np.zeros((m, 2)),
            self._proximal,
            rows,
            room,
            np.full(m, radius),
            local_axes(self.bodies, x),
            softness=softness,
            scale=max(longest, SMALLEST_SCALE * gap),
        )
        return Prepared(motion, all_pairs, all_contacts, program)

    def solved(self, prepared: Prepared) -> Response:
        """The second half of :meth:`to`: the motion of the cage."""
        tolerance = NEGLIGIBLE * self.distances.gap**2
        solution = self.bodies.solved(self.solver, prepared.program, tolerance, self._order)
        self._order = solution.order
        motion = prepared.motion
        if np.isfinite(solution.step).all():
            motion = np.concatenate([solution.step, motion[self.bodies.m :]])
        return Response(motion, prepared.pairs, prepared.contacts, solution.iterations)

    def _constraints(
        self, pairs: Pairs, contacts: Contacts, motion: FloatArray, farthest_motion: FloatArray
    ) -> tuple[list[Rows], FloatArray, FloatArray]:
        """Rows, room and softness of the constraints after a ``motion`` (m + n, 2) of the fine mesh.

        farthest_motion: (m + n,) longest motion of each vertex in the response; constraints out of reach are left out.
        """
        d = contacts.distance
        clearance = self.distances.of(pairs)
        gap = self.distances.gap
        after = d + distance_change(pairs, contacts, motion)
        hard = np.minimum(0.5 * (d + clearance), clearance + gap)
        larger = np.minimum(d + GAP_GROWTH * gap, clearance + gap)
        reachable = after - np.maximum(hard, larger) < pairs.approach(farthest_motion)
        rows: list[Rows] = []
        rooms: list[FloatArray] = []
        softness: list[FloatArray] = []
        for wanted, epsilon, where in (
            (hard, HARD_COMPLIANCE, reachable),
            (larger, SOFT_COMPLIANCE, reachable & (larger > hard)),
        ):
            kept = np.flatnonzero(where)
            some, contact, room = pairs.take(kept), contacts.take(kept), (after - wanted).take(kept)
            keep = np.flatnonzero(not_implied(some, contact, room))
            rows.extend(constraint_rows(some.take(keep), contact.take(keep)))
            rooms.append(room[keep])
            softness.append(np.full(len(rooms[-1]), epsilon))
        return rows, np.concatenate(rooms), np.concatenate(softness)


class FeasibilityRule(NamedTuple):
    """Bounds motions of cage and fine mesh.

    Continuous collision detection bounds a motion (Li et al. 2020, section 5). The rule also bounds how fast distances
    shrink, so that the next motion is not blocked.
    """

    bodies: Bodies
    clearance: float
    """Final distance; a motion may use up the distance above it."""
    gap: float
    """Working gap of the cage, a length."""

    def concerned(self, pairs: Pairs, contacts: Contacts, motion: FloatArray) -> tuple[Pairs, Contacts]:
        """The pairs that the motion (m + n, 2), or part of it, can bring closer than the rule allows."""
        length = np.hypot(motion[:, 0], motion[:, 1])
        near = np.flatnonzero(contacts.distance - pairs.approach(length) <= self._least(contacts))
        return pairs.take(near), contacts.take(near)

    def _least(self, contacts: Contacts) -> FloatArray:
        """(K,) distances that a motion must leave."""
        d = contacts.distance
        least: FloatArray = np.minimum(self.clearance, KEPT_DISTANCE * d) + KEPT_GAP * np.minimum(d, self.gap)
        return least

    def fraction(self, pairs: Pairs, contacts: Contacts, x: FloatArray, motion: FloatArray, shortest: float) -> float:
        """A feasible fraction of the motion (m + n, 2) from x; below ``shortest`` it may be infeasible."""
        least = self._least(contacts)
        fraction = largest_safe_step(pairs, x, motion, contacts.distance, self.clearance)
        while fraction > shortest:
            if bool((measure(pairs, x + fraction * motion).distance > least).all()):
                break
            fraction *= BACKTRACKING
        return fraction

    def fractions(self, pairs: Pairs, contacts: Contacts, x: FloatArray, motion: FloatArray) -> FloatArray:
        """(m + n,) a feasible fraction per vertex; used where a common one would be too short."""
        least = self._least(contacts)
        kept = np.ones(len(x))
        for _ in range(MOST_ROUNDS):
            moved = self.bodies.scaled(motion, kept)
            hit, _ = impacts(pairs, x, moved, contacts.distance, self.clearance)
            close = np.flatnonzero(measure(pairs, x + moved).distance < least)
            failing = np.concatenate([hit, close])
            if len(failing) == 0:
                return kept
            vertex = np.unique(np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing]]))
            kept[vertex] *= BACKTRACKING
            if self.bodies.elimination is not None:
                kept[: self.bodies.m] = self.bodies.elimination.least(kept[: self.bodies.m])
        return np.zeros(len(x))
