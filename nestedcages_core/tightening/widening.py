"""Widening: bring a cage that is free of contact, but closer to the fine mesh than wanted, to the clearance.

Where all is well a single parallel restoration does it. Where walls are in each other's way the cage takes small steps,
each the least motion that brings all distances towards the clearance at once, which shares what room there is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..contact.ccd import impacts
from ..contact.contact_response import ContactResponse, Distances
from ..contact.feasibility_rule import FeasibilityRule
from ..contact.linearisation import Contacts, measure
from ..contact.pairs import Bodies, CandidateList, Pairs
from ..geometry.arrays import FloatArray, IntArray
from ..solver.quadratic_program import InteriorPoint
from .restoration import restore

STEPS = 100
"""Cap on the small steps."""

STEP = 4.0
"""Longest motion of a vertex in a small step, in clearances."""

AIM = 2.0
"""The small steps aim at so many clearances: a goal beyond the wanted distance is passed, not approached for ever."""

SHORT_STEP = 0.1
"""Fraction of a step below which every vertex goes as far as it can by itself."""

PROGRESS, PATIENCE = 0.99, 8
"""The sum of what is missing must shrink by this factor within so many steps."""

ROOM_OF_OWN = 0.1
"""Parts of the cage that are closer to each other than the clearance need only keep this fraction of their distance."""


@dataclass(frozen=True, eq=False)
class Widened:
    """Where a widening ended."""

    x: FloatArray
    """(m + n, 2)."""
    own: float
    """Distance that parts of the cage keep from each other: at most the clearance."""
    systems: int
    """Systems of equations solved."""
    closest: int
    """Index into x of the point of a pair that is too close still; -1 if there is none."""


def widen(
    bodies: Bodies,
    x: FloatArray,
    clearance: float,
    candidates: CandidateList,
    solver: InteriorPoint,
    on_step: Callable[[FloatArray], None],
) -> Widened:
    """Move the cage from x (m + n, 2), free of contact, until all its distances to the fine mesh are ``clearance``.

    ``on_step`` gets every x on the way; the linear motion from the one before is free of collisions.
    """
    reach = (AIM + STEP) * clearance
    pairs, contacts = _measured(candidates, x, reach)
    own = min(clearance, ROOM_OF_OWN * float(contacts.distance[pairs.cage_cage].min(initial=np.inf)))
    if len(_short(pairs, contacts, clearance, own)) == 0:
        return Widened(x, own, 0, -1)
    moved = _restored(bodies, pairs, contacts, x, clearance, own, reach)
    if moved is not None:
        on_step(moved)
        return Widened(moved, own, 0, -1)

    aim = AIM * clearance
    answer = ContactResponse(bodies, Distances(aim, min(aim, AIM * own), clearance), solver)
    rule = FeasibilityRule(bodies, clearance, clearance)
    standing = np.zeros((bodies.n, 2))
    systems, least, since = 0, np.inf, 0
    for _ in range(STEPS):
        found = answer.to(standing, x, STEP * clearance)
        systems += found.systems
        step = *rule.concerned(found.pairs, found.contacts, found.motion), x, found.motion
        fraction = rule.fraction(*step, SHORT_STEP)
        kept = np.full(len(x), fraction)
        if fraction <= SHORT_STEP:
            kept = rule.fractions(*step)
        if kept.any():
            x = x + kept[:, None] * found.motion
            on_step(x)
        pairs, contacts = _measured(candidates, x, reach)
        short = _short(pairs, contacts, clearance, own)
        if len(short) == 0:
            return Widened(x, own, systems, -1)
        moved = _restored(bodies, pairs, contacts, x, clearance, own, reach)
        if moved is not None:
            on_step(moved)
            return Widened(moved, own, systems, -1)
        missing = float((_required(pairs, clearance, own) - contacts.distance)[short].sum())
        since = since + 1 if missing > PROGRESS * least else 0
        least = min(least, missing)
        if since >= PATIENCE:
            break
    closest = short[int(np.argmin(contacts.distance[short]))]
    return Widened(x, own, systems, int(pairs.point[closest]))


def _measured(candidates: CandidateList, x: FloatArray, reach: float) -> tuple[Pairs, Contacts]:
    pairs = candidates.within(x, reach, reach)
    return pairs, measure(pairs, x)


def _required(pairs: Pairs, clearance: float, own: float) -> FloatArray:
    """(K,) distance that each pair must keep."""
    required = np.full(len(pairs), clearance)
    required[pairs.cage_cage] = own
    return required


def _short(pairs: Pairs, contacts: Contacts, clearance: float, own: float) -> IntArray:
    """Pairs that are too close."""
    return np.flatnonzero(contacts.distance < _required(pairs, clearance, own))


def _restored(
    bodies: Bodies, pairs: Pairs, contacts: Contacts, x: FloatArray, clearance: float, own: float, reach: float
) -> FloatArray | None:
    """x restored to all distances in one motion free of collisions; None if that does not succeed."""
    required = _required(pairs, clearance, own)
    tried, after = restore(bodies, pairs, x, required, contacts.side)
    motion = tried - x
    farthest = float(np.hypot(motion[:, 0], motion[:, 1]).max())
    if bool((after.distance < required).any()) or 2.0 * farthest > reach - clearance:
        return None
    hit, _ = impacts(pairs, x, motion, contacts.distance, min(clearance, own))
    return tried if len(hit) == 0 else None
