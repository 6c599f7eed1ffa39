"""How the cage answers a motion of the fine mesh: with the least motion that keeps the wanted distances.

For a motion E of the fine mesh the answer D is the solution of a proximal quadratic program, the distances to first
order,

    minimise   ½ |D|² + ½ Σ e² / ε
    subject to d + ∂d·(D, E) + e ≥ wanted distance,   |D_i| ≤ Δ along and across the cage,

soft in e so that it always has a solution. Every contact wants two distances. One that it must nearly keep, so that the
motion can go on: half of what it has, down to the clearance. And a larger one for which the cage makes room where it is
free to, for a cage that is hugged too closely can only take the smallest steps. Nothing but contact moves the cage:
with an energy beside it, it would drift while the fine mesh is away.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..energies import Blocks
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.broad_phase import near_pairs
from ..solver.banded import Rows
from ..solver.quadratic_program import InteriorPoint, QuadraticProgram
from .linearisation import Contacts, change, constraint_rows, local_axes, measure, resolve_corners
from .pairs import Bodies, CandidateList, Pairs
from .pruning import not_implied

STIFF = 3e-5
"""ε of the distances that must nearly be kept: how far one may be missed per unit of force, where the cage moves D
under the force D."""

SOFT = 0.1
"""ε of the larger distances: the cage makes nine tenths of the room where nothing else holds it."""

LARGER = 0.25
"""The larger distance is what the contact has and this fraction of the working gap."""

SKIN = 0.3
"""Skin of the candidate list, as a fraction of how far pairs are looked for beyond the wanted distance."""

MOST, SMALL = 0.3, 1_000_000
"""Fraction of moving fine vertices, and number of all possible pairs, up to which the whole cage may move as far as its
part near the moving vertices: only elsewhere it pays to look for that part."""

RINGS = 2
"""Number of neighbours, along the cage, of vertices near moving ones that may be dragged along as far."""

SMALLEST_SCALE = 0.1
"""The multipliers are expected to be at least this fraction of the working gap in size, for they are forces."""

ABSOLUTE_TOLERANCE = 1e-4
"""Complementarity of the quadratic programs that is small enough, in units of the working gap squared."""


@dataclass(frozen=True)
class Distances:
    """What the cage wants to keep; all lengths."""

    clearance: float
    """Between cage and fine mesh, in the end."""
    own: float
    """Between parts of the cage, in the end."""
    gap: float
    """How much more than these it keeps on the way, where there is room."""


@dataclass(frozen=True, eq=False)
class Response:
    """A motion of fine mesh and cage, and what can meet in it."""

    motion: FloatArray
    """(m + n, 2)."""
    pairs: Pairs
    """All pairs that can meet."""
    contacts: Contacts
    """Their contacts before the motion."""
    systems: int
    """Systems of equations solved."""


@dataclass(eq=False)
class ContactResponse:
    """Finds answers; keeps the list of candidate pairs from one to the next."""

    bodies: Bodies
    distances: Distances
    solver: InteriorPoint
    candidates: CandidateList = field(init=False)

    def __post_init__(self) -> None:
        self.candidates = CandidateList(self.bodies)
        still = np.arange(self.bodies.m)
        self._proximal = Blocks(still, still, np.broadcast_to(np.eye(2), (self.bodies.m, 2, 2)))

    def to(self, fine_motion: FloatArray, x: FloatArray, radius: float) -> Response:
        """The answer to a motion (n, 2) of the fine mesh at x (m + n, 2), at most ``radius`` along each axis."""
        m, gap = self.bodies.m, self.distances.gap
        length = np.hypot(fine_motion[:, 0], fine_motion[:, 1])
        longest = float(length.max())
        farthest = max(self.distances.clearance, self.distances.own) + gap
        touched = self._touched(fine_motion, x, farthest + _reach(radius) + longest)
        radii = np.where(touched, radius, min(radius, gap))
        able = np.concatenate([np.sqrt(2.0) * radii, length])
        reach = _reach(radii) + np.where(touched, longest, 0.0)
        all_pairs = self.candidates.within(x, farthest + reach, SKIN * reach)
        all_contacts = measure(all_pairs, x)

        near = all_contacts.distance - farthest < all_pairs.approach(able)
        pairs, contacts = resolve_corners(self.bodies, all_pairs.subset(near), all_contacts.where(near), x, 0.0)
        motion = np.concatenate([np.zeros((m, 2)), fine_motion])
        able[m:] = 0.0
        rows, room, softness = self._constraints(pairs, contacts, motion, able)
        program = QuadraticProgram(
            np.zeros((m, 2)),
            self._proximal,
            rows,
            room,
            radii,
            local_axes(self.bodies, x),
            softness=softness,
            order=self.bodies.cage_order,
            scale=max(longest, SMALLEST_SCALE * gap),
        )
        solution = self.solver.solve(program, ABSOLUTE_TOLERANCE * gap**2)
        if np.isfinite(solution.step).all():
            motion[:m] = solution.step
        return Response(motion, all_pairs, all_contacts, solution.iterations)

    def _touched(self, fine_motion: FloatArray, x: FloatArray, reach: float) -> BoolArray:
        """(m,) cage vertices that are near a moving fine vertex, or beside one that is; all where most of them move."""
        m, moving = self.bodies.m, np.flatnonzero(fine_motion.any(axis=1))
        if len(moving) > MOST * self.bodies.n or m * self.bodies.n < SMALL:
            return np.ones(m, bool)
        cage = x[:m]
        _, edge = near_pairs(x[m + moving], cage, cage[self.bodies.cage_successor], reach)
        touched = np.zeros(m, bool)
        touched[edge] = True
        for _ in range(RINGS):
            touched = touched | touched[self.bodies.cage_predecessor] | touched[self.bodies.cage_successor]
        return touched

    def _constraints(
        self, pairs: Pairs, contacts: Contacts, motion: FloatArray, able: FloatArray
    ) -> tuple[list[Rows], FloatArray, FloatArray]:
        """Rows, room and softness of the constraints after the fine mesh's ``motion`` that the cage is ``able`` to
        meet."""
        d = contacts.distance
        clearance = np.full(len(pairs), self.distances.clearance)
        clearance[pairs.cage_cage] = self.distances.own
        gap = self.distances.gap
        after = d + change(pairs, contacts, motion)
        kept = np.minimum(0.5 * (d + clearance), clearance + gap)
        larger = np.minimum(d + LARGER * gap, clearance + gap)
        reachable = after - np.maximum(kept, larger) < pairs.approach(able)
        rows: list[Rows] = []
        rooms: list[FloatArray] = []
        softness: list[FloatArray] = []
        for wanted, epsilon, where in ((kept, STIFF, reachable), (larger, SOFT, reachable & (larger > kept))):
            some, room = pairs.subset(where), (after - wanted)[where]
            contact = contacts.where(where)
            keep = not_implied(some, contact, room, 0.0)
            rows.extend(constraint_rows(some.subset(keep), contact.where(keep)))
            rooms.append(room[keep])
            softness.append(np.full(len(rooms[-1]), epsilon))
        return rows, np.concatenate(rooms), np.concatenate(softness)


def _reach(radius: Any) -> Any:
    """How much closer two cage vertices can come that move so far along two axes each."""
    return 2.0 * np.sqrt(2.0) * radius
