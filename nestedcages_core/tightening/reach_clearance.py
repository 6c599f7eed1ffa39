"""Widening: bring a cage that is free of contact, but closer to the fine mesh than the clearance, to the clearance.

A single restoration usually succeeds. Where walls block each other, the cage takes small steps, each the
smallest motion that increases all distances at once.

See docs/ablation.md: widening in small steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contact.base import OnStep
from ..contact.ccd import impacts
from ..contact.contact_response import ContactResponse, Distances, FeasibilityRule
from ..contact.linearisation import OVERSHOOT, Contacts, measure
from ..contact.pairs import Bodies, CandidateList, Pairs, WantedDistances
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.precision import MOST_ROUNDS, MOST_STEPS, NEGLIGIBLE, PROGRESS_RATIO, ROUND_OFF
from ..solver.quadratic_program import InteriorPoint

TARGET_DISTANCE = 2.0
"""Distance that small steps aim at, and their longest motion of a vertex, in clearances: beyond 1, so that they reach
the clearance in finite time."""

SHORTEST_STEP = 1e-3
"""Fraction of a small step below which there is no room for any."""

MAX_IDLE_STEPS = 8
"""Maximum number of small steps in a row without progress."""

OWN_DISTANCE_KEPT = 0.1
"""Fraction of the smallest distance between parts of the cage that they keep, if that is less than the clearance."""

CORRECTIONS = 12
"""Maximum number of corrections of bounds, each followed by a restoration that undoes a part of it; with 3, one in 100
cages with a least edge got 15 % looser."""

NEARLY_STRAIGHT = 0.98
"""Cosine of the angle between neighbouring edges above which both get the larger of their shifts."""


class Widened(NamedTuple):
    """Where a widening ended."""

    x: FloatArray
    """(m + n, 2)."""
    wanted: WantedDistances
    """Those that are kept from now on: between parts of the cage, at most the clearance."""
    systems: int
    """Number of linear systems solved."""
    closest: int
    """Index into x of the point of the closest pair if that is too close, else -1."""


def widen(
    bodies: Bodies,
    x: FloatArray,
    clearance: float,
    candidates: CandidateList,
    solver: InteriorPoint,
    on_step: OnStep,
    apart: float = 0.0,
) -> Widened:
    """Move the cage from x (m + n, 2), free of contact, until its distance to the fine mesh is ``clearance``.

    apart: a distance that its loops then have from each other.

    on_step: called with every intermediate x.
    """
    largest = clearance if bodies.clearances is None else max(clearance, float(bodies.clearances.max()))
    reach = max(2.0 * TARGET_DISTANCE, 1.0 / OWN_DISTANCE_KEPT) * largest + apart
    pairs, contacts = _measured(candidates, x, reach)
    own = min(clearance, OWN_DISTANCE_KEPT * float(contacts.distance[pairs.cage_cage].min(initial=np.inf)))
    loop = bodies.coarse.loop_of_vertex if apart else None
    wanted = WantedDistances(clearance, own, apart=apart, loop=loop, of_vertex=bodies.of_vertex)
    short = _short(pairs, contacts, wanted)
    if len(short) == 0:
        return Widened(x, wanted, 0, -1)
    moved = _restored(bodies, pairs, contacts, x, wanted, reach)
    if moved is not None:
        on_step(moved)
        return Widened(moved, wanted, 0, -1)

    aim = TARGET_DISTANCE * clearance
    aims = None if bodies.of_vertex is None else TARGET_DISTANCE * bodies.of_vertex
    distances = Distances(aim, min(aim, TARGET_DISTANCE * own), clearance, of_vertex=aims)
    response = ContactResponse(bodies, distances, solver)
    rule = FeasibilityRule(bodies, clearance, clearance)
    at_rest = np.zeros((bodies.n, 2))
    systems, least, idle = 0, np.inf, 0
    for _ in range(MOST_STEPS):
        found = response.to(at_rest, x, TARGET_DISTANCE * largest)
        systems += found.systems
        concerned = rule.concerned(found.pairs, found.contacts, found.motion)
        fraction = rule.fraction(*concerned, x, found.motion, SHORTEST_STEP)
        if fraction <= SHORTEST_STEP:
            break
        x = x + fraction * found.motion
        on_step(x)
        pairs, contacts = _measured(candidates, x, reach)
        short = _short(pairs, contacts, wanted)
        if len(short) == 0:
            return Widened(x, wanted, systems, -1)
        moved = _restored(bodies, pairs, contacts, x, wanted, reach)
        if moved is not None:
            on_step(moved)
            return Widened(moved, wanted, systems, -1)
        missing = float((wanted.of(pairs) - contacts.distance)[short].sum())
        idle = idle + 1 if missing > PROGRESS_RATIO * least else 0
        least = min(least, missing)
        if idle >= MAX_IDLE_STEPS:
            break
    closest = short[int(np.argmin(contacts.distance[short]))]
    return Widened(x, wanted, systems, int(pairs.point[closest]))


def _measured(candidates: CandidateList, x: FloatArray, reach: float) -> tuple[Pairs, Contacts]:
    pairs = candidates.meeting(x, reach, np.zeros(len(x)), reach, reach)
    return pairs, measure(pairs, x)


def _short(pairs: Pairs, contacts: Contacts, wanted: WantedDistances) -> IntArray:
    """Indices of the pairs that are too close."""
    return np.flatnonzero(contacts.distance < wanted.of(pairs))


def _restored(
    bodies: Bodies, pairs: Pairs, contacts: Contacts, x: FloatArray, wanted: WantedDistances, reach: float
) -> FloatArray | None:
    """x restored to all distances in one collision-free motion; None if that fails."""
    required = wanted.of(pairs)
    tried, after = restore(bodies, pairs, x, required, contacts.side)
    motion = tried - x
    farthest = float(np.hypot(motion[:, 0], motion[:, 1]).max())
    if bool((after.distance < required).any()) or 2.0 * farthest > reach - wanted.largest_clearance:
        return None
    hit, _ = impacts(pairs, x, motion, contacts.distance, min(wanted.clearance, wanted.own))
    return tried if len(hit) == 0 else None


def restore(
    bodies: Bodies,
    pairs: Pairs,
    x: FloatArray,
    required: FloatArray,
    side: FloatArray,
    lacking: FloatArray | None = None,
) -> tuple[FloatArray, Contacts]:
    """Positions (m + n, 2) near x at which pairs keep their distances, and the cage its bounds, and the contacts there.
    May fail: check them.

    required: (K,) wanted distances; side: (K,) side of the edge on which each point belongs; lacking: (m,) what each
    vertex lacked of its bounds before, None: bounds do not matter.
    """
    x, contacts = _apart(bodies, pairs, x, required, side)
    if lacking is None:
        return x, contacts
    from .correction import correction  # few cages have bounds

    for _ in range(CORRECTIONS):
        motion = correction(bodies, pairs, contacts, required, x[: bodies.m], lacking)
        if motion is None:
            break
        moved = x.copy()
        moved[: bodies.m] += motion
        moved, after = _apart(bodies, pairs, moved, required, side)
        if bool((after.distance < required).any()):
            break
        x, contacts = moved, after
    return x, contacts


def _apart(
    bodies: Bodies, pairs: Pairs, x: FloatArray, required: FloatArray, side: FloatArray
) -> tuple[FloatArray, Contacts]:
    """`restore` without bounds."""
    contacts = measure(pairs, x, side)
    for _ in range(MOST_ROUNDS):  # each can violate the distances of neighbours, by much less
        short = np.flatnonzero(contacts.distance < required)
        if len(short) == 0:
            break
        wanted = required.take(short)
        missing = wanted - contacts.distance.take(short)
        missing *= OVERSHOOT
        missing += NEGLIGIBLE * wanted
        x = x.copy()
        x[: bodies.m] += outward_correction(bodies, pairs, contacts, x, short, missing)
        contacts = measure(pairs, x, side)
    return x, contacts


def outward_correction(
    bodies: Bodies, pairs: Pairs, contacts: Contacts, x: FloatArray, short: IntArray, missing: FloatArray
) -> FloatArray:
    """(m, 2) motion of the cage that adds the missing distances (S,) > 0 of the pairs ``short`` (S,), ascending.

    A small rotation of an edge changes all its distances by about the same second-order amount. So each cage edge that
    is too close to a fine vertex is shifted outwards, parallel to itself, by its worst violation, and each vertex makes
    the smallest motion that shifts both its edges. Cage vertices too close to a fine edge, or to another cage edge,
    move along the normal of the contact. So does that cage edge, just as far: a fine vertex may hold either.
    """
    first, second = short.searchsorted((pairs.fine_cage.stop, pairs.cage_fine.stop))
    shift = np.zeros(bodies.m)
    np.maximum.at(shift, pairs.start.take(short[:first]), missing[:first])
    if bodies.elimination is not None:
        shift = bodies.elimination.largest_of_edges(shift)
    correction = shift_edges(bodies, x[: bodies.m], shift)
    push = contacts.normal.T.take(short[first:], axis=1).T * missing[first:, None]
    np.add.at(correction, pairs.point.take(short[first:]), push)
    own = short[second:]
    np.subtract.at(correction, pairs.start.take(own), push[second - first :])
    np.subtract.at(correction, pairs.end.take(own), push[second - first :])
    return bodies.longest(correction)


def shift_edges(bodies: Bodies, cage: FloatArray, shift: FloatArray) -> FloatArray:
    """(m, 2) smallest motions of the vertices that move each edge outwards by ``shift`` (m,)."""
    edge = cage[bodies.cage.successor] - cage
    length = np.hypot(edge[:, 0], edge[:, 1])
    n_x, n_y = edge[:, 1] / length, -edge[:, 0] / length
    before = bodies.cage.predecessor
    p_x, p_y, before_shift = n_x[before], n_y[before], shift[before]
    straight = np.abs(n_x * p_x + n_y * p_y) > NEARLY_STRAIGHT
    larger = np.maximum(shift, before_shift)
    own, other = np.where(straight, larger, shift), np.where(straight, larger, before_shift)
    # normal equations of n · e = own, p · e = other
    xx = n_x * n_x + p_x * p_x + ROUND_OFF
    xy = n_x * n_y + p_x * p_y
    yy = n_y * n_y + p_y * p_y + ROUND_OFF
    right_x, right_y = n_x * own + p_x * other, n_y * own + p_y * other
    determinant = xx * yy - xy * xy
    motion = np.stack([yy * right_x - xy * right_y, xx * right_y - xy * right_x], axis=1)
    out: FloatArray = motion / determinant[:, None]
    return out
