"""The feasibility rule: the part of a motion that is free of collisions and leaves enough distance at its end.

Continuous collision detection bounds the motion (Li et al. 2020, section 5). The rule also bounds how fast distances
shrink, so that the next motion is not blocked.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from .ccd import impacts, largest_safe_step
from .linearisation import Contacts, measure
from .pairs import Bodies, Pairs

MOTION_REDUCTION = 0.6
"""Factor on a motion while distances at its end are too small."""

KEPT_DISTANCE = 0.5
"""Fraction of a distance below the clearance that a motion must leave."""

KEPT_GAP = 0.05
"""Distance that a motion must leave on top, as a fraction of the distance or of the working gap."""


MAX_SLOWDOWNS = 14
"""Cap on the rounds in which failing vertices are slowed down by half."""


@dataclass(frozen=True, eq=False)
class FeasibilityRule:
    """Bounds motions of cage and fine mesh."""

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
            fraction *= MOTION_REDUCTION
        return fraction

    def fractions(self, pairs: Pairs, contacts: Contacts, x: FloatArray, motion: FloatArray) -> FloatArray:
        """(m + n,) a feasible fraction per vertex; used where a common one would be too short."""
        least = self._least(contacts)
        kept = np.ones(len(x))
        for _ in range(MAX_SLOWDOWNS):
            moved = kept[:, None] * motion
            hit, _ = impacts(pairs, x, moved, contacts.distance, self.clearance)
            close = np.flatnonzero(measure(pairs, x + moved).distance < least)
            failing = np.concatenate([hit, close])
            if len(failing) == 0:
                return kept
            vertex = np.unique(np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing]]))
            kept[vertex] *= 0.5
            if self.bodies.tie is not None:
                kept[: self.bodies.m] = self.bodies.tie.least(kept[: self.bodies.m])
        return np.zeros(len(x))
