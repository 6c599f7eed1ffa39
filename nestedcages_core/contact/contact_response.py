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

from typing import NamedTuple

import numpy as np

from ..energies import Blocks
from ..geometry.arrays import FloatArray
from ..geometry.precision import BACKTRACKING, MOST_ROUNDS, NEGLIGIBLE
from ..geometry.vectors import norm
from ..solver.banded import Rows
from ..solver.quadratic_program import InteriorPoint, QuadraticProgram
from .ccd import impacts, largest_safe_step
from .linearisation import Contacts, constraint_rows, distance_change, local_axes, measure, resolve_corners
from .pairs import Bodies, CandidateList, Pairs
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


class ContactResponse:
    """Computes responses; reuses candidate pairs."""

    def __init__(self, bodies: Bodies, clearance: float, gap: float, solver: InteriorPoint) -> None:
        """clearance: distance to keep in the end; gap: to keep in addition, where there is space; lengths."""
        self.bodies, self.clearance, self.gap, self.solver = bodies, clearance, gap, solver
        self.candidates = CandidateList(bodies)
        self._order = bodies.order
        still = np.arange(bodies.m)
        self._proximal = Blocks(still, still, np.broadcast_to(np.eye(2), (bodies.m, 2, 2)))

    def to(self, fine_motion: FloatArray, x: FloatArray, radius: float) -> Response:
        """The response to a motion (n, 2) of the fine mesh at x (m + n, 2), at most ``radius`` along each axis."""
        m, gap = self.bodies.m, self.gap
        length = norm(fine_motion)
        longest = float(length.max())
        farthest = self.clearance + gap
        farthest_cage = float(np.sqrt(2.0)) * radius  # along both axes
        farthest_motion = np.concatenate([np.full(m, farthest_cage), length])
        reach = farthest_cage + longest
        pairs = self.candidates.meeting(x, farthest, farthest_motion, farthest + reach, SKIN * reach)
        contacts = measure(pairs, x)
        motion = np.concatenate([np.zeros((m, 2)), fine_motion])
        farthest_motion[m:] = 0.0
        resolved = resolve_corners(self.bodies, pairs, contacts, x, 0.0)
        rows, room, softness = self._constraints(*resolved, motion, farthest_motion)
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
        solution = self.bodies.solved(self.solver, program, NEGLIGIBLE * gap**2, self._order)
        self._order = solution.order
        if np.isfinite(solution.step).all():
            motion[:m] = solution.step
        return Response(motion, pairs, contacts, solution.iterations)

    def _constraints(
        self, pairs: Pairs, contacts: Contacts, motion: FloatArray, farthest_motion: FloatArray
    ) -> tuple[list[Rows], FloatArray, FloatArray]:
        """Rows, room and softness of the constraints after a ``motion`` (m + n, 2) of the fine mesh.

        farthest_motion: (m + n,) longest motion of each vertex in the response; constraints out of reach are left out.
        """
        d, clearance, gap = contacts.distance, self.clearance, self.gap
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


class FeasibleMotion:
    """Bounds the motion of a response.

    Continuous collision detection bounds it (Li et al. 2020, section 5). So does how fast distances shrink, so that the
    next motion is not blocked.
    """

    def __init__(self, response: Response, x: FloatArray, clearance: float, gap: float) -> None:
        """x: (m + n, 2) where it begins; clearance: final distance, of which it may use up what is above it; gap:
        working gap of the cage, a length."""
        self._x, self._motion, self._clearance = x, response.motion, clearance
        d = response.contacts.distance
        least = np.minimum(clearance, KEPT_DISTANCE * d) + KEPT_GAP * np.minimum(d, gap)
        near = np.flatnonzero(d - response.pairs.approach(norm(response.motion)) <= least)
        self._pairs, self._distance, self._least = response.pairs.take(near), d.take(near), least.take(near)

    def fraction(self, shortest: float) -> float:
        """A feasible fraction; below ``shortest`` it may be infeasible."""
        fraction = largest_safe_step(self._pairs, self._x, self._motion, self._distance, self._clearance)
        while fraction > shortest and (self._after(fraction * self._motion) <= self._least).any():
            fraction *= BACKTRACKING
        return fraction

    def fractions(self, bodies: Bodies) -> FloatArray:
        """(m + n,) a feasible fraction per vertex; used where a common one would be too short."""
        pairs, kept = self._pairs, np.ones(len(self._x))
        for _ in range(MOST_ROUNDS):
            moved = bodies.scaled(self._motion, kept)
            hit, _ = impacts(pairs, self._x, moved, self._distance, self._clearance)
            failing = np.concatenate([hit, np.flatnonzero(self._after(moved) < self._least)])
            if len(failing) == 0:
                return kept
            vertex = np.unique(np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing]]))
            kept[vertex] *= BACKTRACKING
            if bodies.elimination is not None:
                kept[: bodies.m] = bodies.elimination.least(kept[: bodies.m])
        return np.zeros(len(self._x))

    def _after(self, motion: FloatArray) -> FloatArray:
        return measure(self._pairs, self._x + motion).distance
