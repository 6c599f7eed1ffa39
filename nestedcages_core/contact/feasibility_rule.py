"""The feasibility rule: how much of a motion meets nothing and leaves distances of a decent size at its end.

Continuous collision detection bounds the motion (Li et al. 2020, section 5); what it leaves at the end must not shrink
too fast either, or the next motion has no room.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from .ccd import impacts, largest_safe_step
from .linearisation import Contacts, measure
from .pairs import Bodies, Pairs

SHORTEN = 0.6
"""Factor by which a motion is shortened while distances at its end are too small."""

KEPT_DISTANCE = 0.5
"""A motion may take at most about this part of a distance, once it is below the clearance."""

KEPT_GAP = 0.05
"""What a motion must leave besides, as a fraction of the distance or of the working gap."""

RESOLVED = 1e-9
"""Distance, in units of the mean coarse edge length, that is never used up: below it roundings would show."""

NOT_LESS = 0.99
"""Fraction of a distance below that one that a motion must leave."""

HALVINGS, WIDEN, GIVE_UP = 14, 5, 9
"""Number of times that single vertices are slowed down; when their neighbours on the cage are as well; when they
stop."""


@dataclass(frozen=True, eq=False)
class FeasibilityRule:
    """Bounds motions of fine mesh and cage."""

    bodies: Bodies
    clearance: float
    """Distances above it may be used up."""
    gap: float
    """Working gap of the cage."""

    def concerned(self, pairs: Pairs, contacts: Contacts, motion: FloatArray) -> tuple[Pairs, Contacts]:
        """Those that the motion (m + n, 2), or a part of it, can bring closer than the rule allows."""
        length = np.hypot(motion[:, 0], motion[:, 1])
        near = contacts.distance - pairs.approach(length) <= self._least(contacts)
        return pairs.subset(near), contacts.where(near)

    def _least(self, contacts: Contacts) -> FloatArray:
        """(K,) distances that a motion must leave."""
        d = contacts.distance
        least = np.minimum(self.clearance, KEPT_DISTANCE * d) + KEPT_GAP * np.minimum(d, self.gap)
        resolved = RESOLVED * self.bodies.cage_edge_length
        return np.maximum(least, np.minimum(NOT_LESS * d, resolved))

    def fraction(self, pairs: Pairs, contacts: Contacts, x: FloatArray, motion: FloatArray, shortest: float) -> float:
        """A fraction of the motion (m + n, 2) from x that is feasible for all; below ``shortest`` it need not be."""
        least = self._least(contacts)
        fraction = largest_safe_step(pairs, x, motion, contacts.distance, self.clearance)
        while fraction > shortest:
            if bool((measure(pairs, x + fraction * motion).distance > least).all()):
                break
            fraction *= SHORTEN
        return fraction

    def fractions(self, pairs: Pairs, contacts: Contacts, x: FloatArray, motion: FloatArray) -> FloatArray:
        """(m + n,) a feasible fraction for every vertex, where one common fraction would be too short."""
        least = self._least(contacts)
        kept = np.ones(len(x))
        for halving in range(HALVINGS):
            moved = kept[:, None] * motion
            hit, _ = impacts(pairs, x, moved, contacts.distance, self.clearance)
            close = np.flatnonzero(measure(pairs, x + moved).distance < least)
            failing = np.concatenate([hit, close])
            if len(failing) == 0:
                return kept
            vertex = np.unique(np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing]]))
            if halving >= WIDEN:
                cage = vertex[vertex < self.bodies.m]
                vertex = np.concatenate([vertex, self.bodies.cage_successor[cage], self.bodies.cage_predecessor[cage]])
            kept[vertex] *= 0.5 if halving < GIVE_UP else 0.0
        return np.zeros(len(x))
