"""Contact by sequential quadratic programming: the fine mesh takes long steps home, and the cage gives way.

The cage answers every motion of the fine mesh with a quadratic program. Both move together, as far as the feasibility
rule of Incremental Potential Contact allows: every state is free of contact and every step is bounded by continuous
collision detection (Li et al. 2020). The straight line home comes first; where it is blocked, the recorded path leads.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..energies import CageEnergy
from ..geometry.arrays import FloatArray
from ..solver import Solver
from ..solver.quadratic_program import InteriorPoint
from .base import ContactOutcome
from .contact_response import ContactResponse, Distances
from .feasibility_rule import FeasibilityRule
from .pairs import Bodies

logger = logging.getLogger(__name__)

SHORT_STEP = 0.08
"""Fraction of a step below which it is rejected and tried again with a shorter motion of the fine mesh."""

SHORTER_STRIDE = 0.35
"""Length of the next motion after a rejected one, relative to it."""

REJECTIONS = 8
"""Number of rejections in a row after which every vertex is left to go as far as it can."""

SMALLEST_STRIDE = 2e-3
"""Motions below this fraction of the mean coarse edge length are not shortened after a rejection ..."""

LEAST_STRIDE = 1e-4
"""... and no stride is shorter than this fraction."""

LONG_STEP, LONGER_STRIDE = 0.6, 1.7
"""After more than this fraction of a step the stride grows by this factor."""

SLOW_STEP, SLOWER_STRIDE = 0.25, 0.5
"""After less than this fraction of a step the stride shrinks by this factor."""

FASTER_PACE, SLOWER_PACE = 2.0, 0.4
"""The same for the pace of a single vertex in the last resort."""

REACH, LONGEST_REACH = 1.5, 0.5
"""The cage's vertices may move so much farther than the farthest fine vertex, but at most so many mean coarse edge
lengths."""

STALLED_PROGRESS = 2e-3
"""Smallest part of the remaining way that an iteration must cover to count."""

STALLED_ITERATIONS = 20
"""Number of iterations in a row without progress after which the way is blocked."""


@dataclass(frozen=True)
class SequentialQP:
    """Long steps straight home, or back along the recorded path where the straight way is blocked.

    Lengths are in units of the mean coarse edge length.
    """

    gap: float = 0.05
    """Distance that the cage keeps from the fine mesh on the way, where there is room."""
    stride: float = 1.0 / 3.0
    """Longest motion of a fine vertex in one step."""
    iterations: int = 300
    """Cap on the steps to one target."""
    quadratic_programs: InteriorPoint = field(default_factory=lambda: InteriorPoint(iterations=25, complementarity=0.1))
    """How they are solved."""

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
        """Bring the fine mesh home; see :class:`nestedcages_core.contact.base.Contact`.

        ``energy`` and ``solver`` have no part in it.
        """
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
        self.settings, self.x, self.on_step = settings, x, on_step
        self.m = bodies.m
        self.unit = bodies.cage_edge_length
        self.gap = settings.gap * self.unit
        distances = Distances(clearance, clearance, self.gap)
        self.answer = ContactResponse(bodies, distances, settings.quadratic_programs)
        self.rule = FeasibilityRule(bodies, clearance, self.gap)
        self.systems = 0

    def towards(self, target: FloatArray) -> bool:
        """Move the fine mesh to ``target`` (n, 2); whether it stands there, to the last bit."""
        stride = self.settings.stride * self.unit
        pace = np.ones(len(target))
        rejected = stalled = 0
        left = np.inf
        for _ in range(self.settings.iterations):
            way = target - self.x[self.m :]
            if not way.any():
                return True
            length = np.hypot(way[:, 0], way[:, 1])
            total = float(length.sum())
            if total <= (1.0 - STALLED_PROGRESS) * left:
                left, stalled = total, 0
            elif rejected == 0:
                stalled += 1
                if stalled > STALLED_ITERATIONS:
                    return False

            part: FloatArray = np.minimum(pace, stride / np.maximum(length, stride))
            longest = float((part * length).max())
            radius = min(max(REACH * longest, self.gap), LONGEST_REACH * self.unit)
            answer = self.answer.to(part[:, None] * way, self.x, radius)
            self.systems += answer.systems
            step = *self.rule.concerned(answer.pairs, answer.contacts, answer.motion), self.x, answer.motion
            fraction = self.rule.fraction(*step, SHORT_STEP)
            logger.debug(
                "reinflation: left %.3e, motion %.2e, fraction %.3f, %d pairs, systems %d",
                total, longest, fraction, len(answer.pairs), answer.systems,
            )  # fmt: skip
            kept = np.full(len(self.x), fraction)
            if fraction < LONG_STEP:
                single = self.rule.fractions(*step)
                covered = float(single[self.m :] @ (part * length)) / float((part * length).sum())
                if covered > fraction or fraction <= SHORT_STEP:  # a fraction that is so short need not be feasible
                    kept, fraction = single, covered
            if fraction <= SHORT_STEP and longest > SMALLEST_STRIDE * self.unit and rejected < REJECTIONS:
                stride = SHORTER_STRIDE * longest
                rejected += 1
                continue
            rejected = 0
            slowed = kept[self.m :]
            pace *= np.where(slowed > LONG_STEP, FASTER_PACE, np.where(slowed > SLOW_STEP, 1.0, SLOWER_PACE))
            pace = np.minimum(pace, 1.0)
            stride *= LONGER_STRIDE if fraction > LONG_STEP else (1.0 if fraction > SLOW_STEP else SLOWER_STRIDE)
            stride = min(max(stride, LEAST_STRIDE * self.unit), self.settings.stride * self.unit)
            if kept.any():
                arrived = (kept[self.m :] >= 1.0) & (part >= 1.0)
                x = self.x + kept[:, None] * answer.motion
                x[self.m :][arrived] = target[arrived]
                self.x = x
                self.on_step(x)
        return not bool((target - self.x[self.m :]).any())

    def obstacle(self, home: FloatArray) -> str:
        """Which fine vertex is farthest from home."""
        worst = int(np.hypot(*(home - self.x[self.m :]).T).argmax())
        return f"the cage holds up fine vertex {worst}"
