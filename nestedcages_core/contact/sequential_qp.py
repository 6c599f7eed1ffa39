"""Contact by sequential quadratic programming: the fine mesh takes long steps and pushes the cage out.

A quadratic program finds the response of the cage to each motion of the fine mesh. Both move together, as far as the
feasibility rule of Incremental Potential Contact allows: every state is free of contact, and continuous collision
detection bounds every step (Li et al. 2020). The fine mesh first goes straight to the last target; where that is
blocked, it follows the recorded path.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.precision import BACKTRACKING, PATIENCE
from ..geometry.vectors import inner, norm
from ..parameters import check_count, check_part, check_positive
from ..solver.quadratic_program import InteriorPoint
from .base import ContactOutcome, OnStep, farthest_vertex, no_step
from .contact_response import ContactResponse, FeasibleMotion
from .pairs import Bodies

logger = logging.getLogger(__name__)

SHORT_FRACTION = 0.08
"""Steps that collision detection cuts below this fraction are taken vertex by vertex."""

LONG_FRACTION, SLOW_FRACTION = 0.6, 0.25
"""After more than this fraction of a step (first) the stride grows, after less than this one (second) it shrinks."""

REACH = 1.5
"""Bound on the motion of a cage vertex, in longest fine motions."""

SUFFICIENT_PROGRESS = 2e-3
"""Smallest relative decrease of the remaining distance that counts as progress."""


@dataclass(frozen=True)
class SequentialQP:
    """Long steps straight to the last target, or along the recorded path where that is blocked.

    Lengths are in units of the mean coarse edge length.
    """

    gap: float = 0.05
    """Distance kept between cage and fine mesh during the motion, where there is space."""
    stride: float = 1.0 / 3.0
    """Maximum motion of a fine vertex in one step."""
    iterations: int = 300
    """Maximum number of steps to one target, which counts as blocked after a few without progress."""
    quadratic_programs: InteriorPoint = field(default_factory=lambda: InteriorPoint(iterations=25))
    """Solves the quadratic programs."""

    def __post_init__(self) -> None:
        check_positive(self, "gap", "stride")
        check_count(self, "iterations")
        check_part(self, "quadratic_programs", "solve", "InteriorPoint()")

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float, on_step: OnStep = no_step
    ) -> ContactOutcome:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`."""
        motion = _Motion(self, bodies, x, clearance, on_step)
        reached = motion.step_to(path[-1])
        if not reached:
            fine = motion.x[bodies.m :]
            nearest = int(np.argmin([float(np.abs(target - fine).sum()) for target in path]))
            logger.debug("the straight line is blocked: along the path from step %d of %d", nearest, len(path))
            for target in path[nearest:]:
                before = motion.x
                reached = motion.step_to(target)
                if not reached and motion.x is before:  # nothing moves towards later targets either
                    break
        reason = "" if reached else farthest_vertex(motion.x[bodies.m :], path[-1])
        return ContactOutcome(motion.x, reached, motion.systems, reason)


class _Motion:
    """State of a motion along the path."""

    def __init__(
        self, settings: SequentialQP, bodies: Bodies, x: FloatArray, clearance: float, on_step: OnStep
    ) -> None:
        self.settings, self.bodies, self.x, self.on_step = settings, bodies, x, on_step
        self.m, self.clearance, self.unit = bodies.m, clearance, bodies.cage_edge_length
        self.gap = settings.gap * self.unit
        self.response = ContactResponse(bodies, clearance, self.gap, settings.quadratic_programs)
        self.systems = 0

    def step_to(self, target: FloatArray) -> bool:
        """Move the fine mesh to ``target`` (n, 2); whether it gets there exactly."""
        stride = self.settings.stride * self.unit
        stalled, left = 0, np.inf
        for _ in range(self.settings.iterations):
            remaining = target - self.x[self.m :]
            if not remaining.any():
                return True
            length = norm(remaining)
            total = float(length.sum())
            stalled += 1
            if total <= (1.0 - SUFFICIENT_PROGRESS) * left:
                left, stalled = total, 0
            if stalled > PATIENCE:
                return False
            part: FloatArray = stride / np.maximum(length, stride)
            longest = float((part * length).max())
            self.on_step(self.x)  # a large response takes a while
            response = self.response.to(part[:, None] * remaining, self.x, max(REACH * longest, self.gap))
            self.systems += response.systems
            feasible = FeasibleMotion(response, self.x, self.clearance, self.gap)
            fraction = feasible.fraction(SHORT_FRACTION)
            logger.debug(
                "reinflation: left %.3e, motion %.2e, fraction %.3f, %d pairs, systems %d",
                total, longest, fraction, len(response.pairs), response.systems,
            )  # fmt: skip
            kept = np.full(len(self.x), fraction)
            if fraction < LONG_FRACTION:
                single = feasible.fractions(self.bodies)
                covered = inner(single[self.m :], part * length) / float((part * length).sum())
                if covered > fraction or fraction <= SHORT_FRACTION:  # a fraction as short as this may be infeasible
                    kept, fraction = single, covered
            if fraction > LONG_FRACTION:
                stride = min(stride / BACKTRACKING, self.settings.stride * self.unit)
            elif fraction <= SLOW_FRACTION:
                stride *= BACKTRACKING
            if kept.any():
                arrived = (kept[self.m :] >= 1.0) & (part >= 1.0)
                x = self.x + self.bodies.scaled(response.motion, kept)
                x[self.m :][arrived] = target[arrived]
                self.x = x
                self.on_step(x)
            else:  # a shorter motion seldom helps where a small part of this one is blocked
                stride, stalled = min(stride, BACKTRACKING * longest), max(stalled, PATIENCE - 1)
        return not bool((target - self.x[self.m :]).any())
