"""The clearance: a cage that is free of contact, but closer to the fine mesh than wanted, moves away at once."""

from __future__ import annotations

import numpy as np

from ..contact.base import OnStep
from ..contact.ccd import impacts
from ..contact.linearisation import OVERSHOOT, Contacts, measure
from ..contact.pairs import Bodies, CandidateList, Pairs, WantedDistances
from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.precision import MOST_ROUNDS, MOST_STEPS, NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import dot

OWN_DISTANCE_KEPT = 0.1
"""Fraction of the smallest distance between parts of the cage that they keep, if that is less than the clearance."""

CORRECTIONS = 12
"""Maximum number of corrections of bounds, each followed by a restoration that undoes a part of it; with 3, one in 100
cages with a least edge got 15 % looser."""

NEARLY_STRAIGHT = 0.98
"""Cosine of the angle between neighbouring edges above which both get the larger of their shifts."""


def reach_clearance(
    bodies: Bodies, x: FloatArray, clearance: float, candidates: CandidateList, apart: float, on_step: OnStep
) -> tuple[FloatArray, WantedDistances] | None:
    """Positions (m + n, 2) at which the cage is as far from the fine mesh as ``clearance``, in one motion from x that
    is free of collisions, and the distances that it keeps from now on; None where there is no room.

    apart: a distance that its loops then have from each other. on_step: called with the cage if it moves.
    """
    largest = clearance if bodies.clearances is None else max(clearance, float(bodies.clearances.max()))
    reach = (largest + apart) / OWN_DISTANCE_KEPT
    pairs = candidates.meeting(x, reach, np.zeros(len(x)), reach, reach)
    contacts = measure(pairs, x)
    own = min(clearance, OWN_DISTANCE_KEPT * float(contacts.distance[pairs.cage_cage].min(initial=np.inf)))
    loop = bodies.coarse.loop_of_vertex if apart else None
    wanted = WantedDistances(clearance, own, apart=apart, loop=loop, of_vertex=bodies.of_vertex)
    required = wanted.of(pairs)
    if not (contacts.distance < required).any():
        return x, wanted
    restored, after = restore(bodies, pairs, x, required, contacts.side, rounds=MOST_STEPS)
    motion = restored - x
    far = 2.0 * float(np.hypot(motion[:, 0], motion[:, 1]).max()) > reach - wanted.largest_clearance
    if far or (after.distance < required).any():
        return None
    hit, _ = impacts(pairs, x, motion, contacts.distance, min(clearance, own))
    if len(hit):
        return None
    on_step(restored[: bodies.m].copy())
    return restored, wanted


def restore(
    bodies: Bodies,
    pairs: Pairs,
    x: FloatArray,
    required: FloatArray,
    side: FloatArray,
    lacking: FloatArray | None = None,
    rounds: int = MOST_ROUNDS,
) -> tuple[FloatArray, Contacts]:
    """Positions (m + n, 2) near x at which pairs keep their distances, and the cage its bounds, and the contacts there.
    May fail: check them.

    required: (K,) wanted distances; side: (K,) side of the edge on which each point belongs; lacking: (m,) what each
    vertex lacked of its bounds before, None: bounds do not matter.
    """
    x, contacts = _apart(bodies, pairs, x, required, side, rounds)
    if lacking is None:
        return x, contacts
    from .correction import correction  # few cages have bounds

    for _ in range(CORRECTIONS):
        motion = correction(bodies, pairs, contacts, required, x[: bodies.m], lacking)
        if motion is None:
            break
        moved = x.copy()
        moved[: bodies.m] += motion
        moved, after = _apart(bodies, pairs, moved, required, side, rounds)
        if bool((after.distance < required).any()):
            break
        x, contacts = moved, after
    return x, contacts


def _apart(
    bodies: Bodies, pairs: Pairs, x: FloatArray, required: FloatArray, side: FloatArray, rounds: int
) -> tuple[FloatArray, Contacts]:
    """`restore` without bounds."""
    contacts = measure(pairs, x, side)
    for _ in range(rounds):  # each can violate the distances of neighbours, by much less
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
    normal = contacts.normal.T.take(short[first:], axis=1).T
    point = pairs.point.take(short[first:])
    left = missing[first:] - dot(normal, correction.take(point, axis=0))  # the edges may have moved it already
    push = normal * np.maximum(left, 0.0)[:, None]
    np.add.at(correction, point, push)
    own = short[second:]
    np.subtract.at(correction, pairs.start.take(own), push[second - first :])
    np.subtract.at(correction, pairs.end.take(own), push[second - first :])
    return bodies.longest(correction)


def shift_edges(bodies: Bodies, cage: FloatArray, shift: FloatArray) -> FloatArray:
    """(m, 2) smallest motions of the vertices that move each edge outwards by ``shift`` (m,)."""
    edge = cage[bodies.cage.successor] - cage
    length = np.maximum(np.hypot(edge[:, 0], edge[:, 1]), TINY)
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
