"""Restoration: after a linearised step, move the cage back to the wanted distances.

A small rotation of an edge changes all its distances by about the same second-order amount. So each cage edge that is
too close to a fine vertex is shifted outwards, parallel to itself, by its worst violation, and each vertex makes the
smallest motion that shifts both its edges. Cage vertices too close to a fine edge, or to another cage edge, move along
the normal of the contact.
"""

from __future__ import annotations

import numpy as np

from ..contact.linearisation import Contacts, measure
from ..contact.pairs import Bodies, Pairs
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF

MAX_PASSES = 10
"""Cap on the passes; each can violate the distances of neighbours, by much less."""

OVERSHOOT = 1.02
"""Factor on every shift, so that passes end (docs/ablation.md: overshoot of restoration)."""

NEARLY_STRAIGHT = 0.98
"""Cosine of the angle between neighbouring edges above which both get the larger of their shifts."""


def restore(
    bodies: Bodies, pairs: Pairs, x: FloatArray, required: FloatArray, side: FloatArray
) -> tuple[FloatArray, Contacts]:
    """Positions (m + n, 2) near x at which pairs keep their distances, and the contacts there. May fail: check them.

    required: (K,) wanted distances; side: (K,) side of the edge on which each point belongs.
    """
    contacts = measure(pairs, x, side)
    for _ in range(MAX_PASSES):
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
    """(m, 2) motion of the cage that adds the missing distances (S,) > 0 of the pairs ``short`` (S,), ascending."""
    first, second = short.searchsorted((pairs.fine_cage.stop, pairs.cage_fine.stop))
    shift = np.zeros(bodies.m)
    np.maximum.at(shift, pairs.start.take(short[:first]), missing[:first])
    if bodies.tie is not None:
        shift = bodies.tie.largest_of_edges(shift)
    correction = shift_edges(bodies, x[: bodies.m], shift)
    for family, share in ((slice(first, second), 1.0), (slice(second, None), 0.5)):
        near = short[family]
        if len(near) == 0:
            continue
        push = contacts.normal[near] * (share * missing[family])[:, None]
        np.add.at(correction, pairs.point[near], push)
        if share < 1.0:
            np.subtract.at(correction, pairs.start[near], push)
            np.subtract.at(correction, pairs.end[near], push)
    return correction if bodies.tie is None else bodies.tie.longest(correction)


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
