"""Contact by sequential quadratic programming: the fine mesh takes long steps home, and the cage gives way as little as
it must.

For a motion E of the fine mesh, the cage's answer D is the solution of a proximal quadratic program with the distances
to first order,

    minimise   ½ |D|² + |e|² / (2 ε)
    subject to d + ∂d·(D, E) + e ≥ wanted distance,   |D_i| ≤ Δ in each coordinate,

soft in e so that it always has a solution. Both move together, as far as the feasibility rule of Incremental Potential
Contact allows: every state is free of contact and every step is bounded by continuous collision detection (Li et al.
2020). Nothing but contact moves the cage: with an energy beside it, it would drift while the fine mesh is away.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from .._types import BoolArray, FloatArray
from ..energies import Blocks, CageEnergy
from ..solver import Solver
from ..solver.quadratic_program import InteriorPoint, QuadraticProgram
from .base import ContactOutcome
from .ccd import impacts, largest_safe_step
from .linearisation import Contacts, change, constraint_rows, measure, resolve_corners
from .pairs import Bodies, CandidateList, Pairs
from .pruning import not_implied

logger = logging.getLogger(__name__)

SHORT_STEP = 0.08
"""Fraction of a step below which it is rejected and tried again with a shorter motion of the fine mesh."""

SHORTER_STRIDE = 0.35
"""Length of the next motion after a rejected one, relative to it."""

REJECTIONS = 8
"""Number of rejections in a row after which every vertex is left to go as far as it can."""

SMALLEST_STRIDE = 2e-3
"""Motions below this fraction of the mean coarse edge length are not shortened any more."""

LONG_STEP, LONGER_STRIDE = 0.6, 1.7
"""After more than this fraction of a step the stride grows by this factor."""

SLOW_STEP, SLOWER_STRIDE = 0.25, 0.5
"""After less than this fraction of a step the stride shrinks by this factor."""

SHORTEN = 0.6
"""Factor by which a step is shortened while distances at its end are too small."""

KEPT_DISTANCE = 0.5
"""A step may take at most about this part of a distance, once it is below the clearance."""

KEPT_GAP = 0.05
"""What a step must leave besides, as a fraction of the distance or of the working gap."""

REACH = 1.5
"""The cage's vertices may move this much farther than the farthest fine vertex ..."""

LONGEST_REACH = 0.5
"""... but at most so many mean coarse edge lengths."""

HALVINGS = 14
"""Number of times that single vertices are slowed down in the last resort."""

STALLED_PROGRESS = 2e-3
"""Smallest part of the remaining way that an iteration must cover to count."""

STALLED_ITERATIONS = 20
"""Number of iterations in a row without progress after which the way is blocked."""

ABSOLUTE_TOLERANCE = 1e-4
"""Complementarity of the quadratic programs that is small enough, in units of the working gap squared."""


@dataclass(frozen=True)
class SequentialQP:
    """Long steps straight home, or back along the recorded path where the straight way is blocked; lengths in units of
    the mean coarse edge length."""

    gap: float = 0.05
    """Distance that the cage keeps from the fine mesh on the way, where there is room."""
    softness: float = 3e-5
    """ε: how far a constraint may be missed per unit of force; the cage moves D under the force D."""
    stride: float = 1.0
    """Longest motion of a fine vertex in one step."""
    iterations: int = 300
    """Cap on the steps to one target."""
    solver: InteriorPoint = field(default_factory=lambda: InteriorPoint(iterations=25, complementarity=0.1))
    """Method for the quadratic programs."""

    def reinflate(
        self,
        bodies: Bodies,
        x: FloatArray,
        path: Sequence[FloatArray],
        *,
        clearance: float,
        energy: CageEnergy,
        solver: Solver,
        on_step: Callable[[FloatArray], None],
    ) -> ContactOutcome:
        """Bring the fine mesh home; see :class:`nestedcages_core.contact.base.Contact`. ``energy`` and ``solver`` have
        no part in it."""
        way = _Way(self, bodies, x, clearance, on_step)
        came_home = way.towards(path[-1])
        if not came_home:
            fine = way.x[bodies.m :]
            nearest = int(np.argmin([float(np.abs(target - fine).sum()) for target in path]))
            logger.debug("the straight way home is blocked: along the path from place %d of %d", nearest, len(path))
            for target in path[nearest:]:
                came_home = way.towards(target)
        return ContactOutcome(way.x, came_home, way.systems, "" if came_home else way.obstacle(path[-1]))


class _Way:
    """Positions on the way home, and what is needed to move them."""

    def __init__(
        self,
        settings: SequentialQP,
        bodies: Bodies,
        x: FloatArray,
        clearance: float,
        on_step: Callable[[FloatArray], None],
    ) -> None:
        self.settings, self.bodies, self.x, self.clearance, self.on_step = settings, bodies, x, clearance, on_step
        self.m = bodies.m
        self.unit = bodies.cage_edge_length
        self.gap = settings.gap * self.unit
        self.candidates = CandidateList(bodies)
        self.systems = 0
        still = np.arange(self.m)
        self.proximal = Blocks(still, still, np.broadcast_to(np.eye(2), (self.m, 2, 2)))

    def towards(self, target: FloatArray) -> bool:
        """Move the fine mesh to ``target`` (n, 2); whether it stands there, to the last bit."""
        stride = self.settings.stride * self.unit
        pace = np.ones(self.bodies.n)
        rejected = stalled = 0
        left = np.inf
        for _ in range(self.settings.iterations):
            way = target - self.x[self.m :]
            length = np.hypot(way[:, 0], way[:, 1])
            if not way.any():
                return True
            if (total := float(length.sum())) > (1.0 - STALLED_PROGRESS) * left:
                stalled += rejected == 0
                if stalled > STALLED_ITERATIONS:
                    return False
            else:
                left, stalled = total, 0
            part = np.minimum(pace, stride / np.maximum(length, stride))
            longest = float((part * length).max())
            motion = np.zeros_like(self.x)
            motion[self.m :] = part[:, None] * way
            pairs, contacts = self._answer(motion, longest)
            fraction = self._safe_fraction(pairs, contacts, motion)
            logger.debug(
                "reinflation: left %.3e, motion %.2e, fraction %.3f, %d pairs, systems %d",
                total, longest, fraction, len(pairs), self.systems,
            )  # fmt: skip
            if fraction <= SHORT_STEP and longest > SMALLEST_STRIDE * self.unit and rejected < REJECTIONS:
                stride = SHORTER_STRIDE * longest
                rejected += 1
                continue
            rejected = 0
            if fraction > SHORT_STEP:
                kept = np.full(len(self.x), fraction)
            else:
                kept = self._safe_fractions(pairs, contacts, motion)
                slowed = kept[self.m :]
                pace = np.minimum(1.0, pace * np.where(slowed > LONG_STEP, 2.0, np.where(slowed > SLOW_STEP, 1.0, 0.4)))
            stride *= LONGER_STRIDE if fraction > LONG_STEP else (1.0 if fraction > SLOW_STEP else SLOWER_STRIDE)
            stride = min(max(stride, 1e-4 * self.unit), self.settings.stride * self.unit)
            if kept.any():
                self._move(kept[:, None] * motion, target, (kept[self.m :] >= 1.0) & (part >= 1.0))
        return not (target - self.x[self.m :]).any()

    def _move(self, motion: FloatArray, target: FloatArray, arrived: BoolArray) -> None:
        x = self.x + motion
        x[self.m :][arrived] = target[arrived]
        self.x = x
        self.on_step(x)

    def _answer(self, motion: FloatArray, longest: float) -> tuple[Pairs, Contacts]:
        """Fill in the cage's answer to the fine mesh's ``motion`` (m + n, 2); all pairs that can meet in it, and their
        contacts."""
        radius = min(max(REACH * longest, self.gap), LONGEST_REACH * self.unit)
        reach = 2.0 * np.sqrt(2.0) * radius + longest
        all_pairs = self.candidates.within(self.x, self.clearance + self.gap + reach, 0.3 * reach)
        all_contacts = measure(all_pairs, self.x)
        able = np.hypot(motion[:, 0], motion[:, 1])
        able[: self.m] = np.sqrt(2.0) * radius
        keep = all_contacts.distance - self.clearance - self.gap < _approach(all_pairs, able)
        pairs, contacts = all_pairs.subset(keep), all_contacts.where(keep)
        pairs, contacts = resolve_corners(self.bodies, pairs, contacts, self.x, 0.0)
        wanted = np.minimum(0.5 * (contacts.distance + self.clearance), self.clearance + self.gap)
        room = contacts.distance + change(pairs, contacts, motion) - wanted
        able[self.m :] = 0.0
        keep = (room < _approach(pairs, able)) & not_implied(pairs, contacts, room, 0.0)
        pairs, contacts, room = pairs.subset(keep), contacts.where(keep), room[keep]
        program = QuadraticProgram(
            np.zeros((self.m, 2)),
            self.proximal,
            constraint_rows(pairs, contacts),
            room,
            np.full(self.m, radius),
            softness=self.settings.softness,
            order=self.bodies.cage_order,
            scale=max(longest, 0.1 * self.gap),
        )
        solution = self.settings.solver.solve(program, ABSOLUTE_TOLERANCE * self.gap**2)
        self.systems += solution.iterations
        if np.isfinite(solution.step).all():
            motion[: self.m] = solution.step
        return all_pairs, all_contacts

    def _least(self, contacts: Contacts) -> FloatArray:
        """(K,) distances that a step must leave."""
        d = contacts.distance
        least: FloatArray = np.minimum(self.clearance, KEPT_DISTANCE * d) + KEPT_GAP * np.minimum(d, self.gap)
        return least

    def _safe_fraction(self, pairs: Pairs, contacts: Contacts, motion: FloatArray) -> float:
        """Fraction of the motion that meets nothing and leaves the least distances; at most ``SHORT_STEP`` if there is
        none."""
        least = self._least(contacts)
        fraction = largest_safe_step(pairs, self.x, motion, contacts.distance, self.clearance)
        while fraction > SHORT_STEP:
            if bool((measure(pairs, self.x + fraction * motion).distance > least).all()):
                break
            fraction *= SHORTEN
        return fraction

    def _safe_fractions(self, pairs: Pairs, contacts: Contacts, motion: FloatArray) -> FloatArray:
        """(m + n,) a fraction for every vertex: the last resort where one common fraction would be too short."""
        least = self._least(contacts)
        kept = np.ones(len(self.x))
        for halving in range(HALVINGS):
            moved = kept[:, None] * motion
            hit, _ = impacts(pairs, self.x, moved, contacts.distance, self.clearance)
            close = np.flatnonzero(measure(pairs, self.x + moved).distance < least)
            failing = np.concatenate([hit, close])
            if len(failing) == 0:
                return kept
            vertex = np.unique(np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing]]))
            if halving > 4:
                cage = vertex[vertex < self.m]
                vertex = np.concatenate([vertex, self.bodies.cage_successor[cage], self.bodies.cage_predecessor[cage]])
            kept[vertex] *= 0.5 if halving < 9 else 0.0
        return np.zeros(len(self.x))

    def obstacle(self, home: FloatArray) -> str:
        """Which fine vertex is farthest from home."""
        worst = int(np.hypot(*(home - self.x[self.m :]).T).argmax())
        return f"the cage holds up fine vertex {worst}"


def _approach(pairs: Pairs, able: FloatArray) -> FloatArray:
    """(K,) how much closer each pair can come when every vertex can move as far as ``able`` (m + n,)."""
    approach: FloatArray = able.take(pairs.point) + np.maximum(able.take(pairs.start), able.take(pairs.end))
    return approach
