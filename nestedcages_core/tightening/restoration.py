"""Parallel restoration: after a linearised step, push what came too close back out to its distance.

A step that turns an edge by a small angle brings it closer to all its contacts by about the same second-order amount.
So every cage edge that is too close to a fine vertex is shifted in parallel, outwards, by its worst violation; each
vertex makes the smallest move that shifts both its edges so. Cage vertices that are too close to a fine edge, or to
another cage edge, move along the normal of that contact.
"""

from __future__ import annotations

import numpy as np

from ..contact.linearisation import Contacts, measure
from ..contact.pairs import Bodies, Pairs
from ..geometry.arrays import FloatArray

PASSES = 10
"""Number of rounds: a shift of one edge can bring its neighbour too close, by far less each time."""

OVERSHOOT, LATER_OVERSHOOT, LATER = 1.02, 1.5, 3
"""Factor of every shift, so that rounds end; a larger one from this round on, where edges push each other back and
forth by lengths that hardly matter."""

NUDGE = 1e-6
"""Smallest extra shift, as a fraction of the wanted distance, for the same reason."""

NEARLY_STRAIGHT = 0.98
"""Cosine of the angle between neighbouring edges above which both are shifted by the larger of their two shifts."""

DAMPING = 1e-9
"""Added to the squared cosines so that straight angles and spikes have a solution."""


def restore(
    bodies: Bodies, pairs: Pairs, x: FloatArray, required: FloatArray, side: FloatArray
) -> tuple[FloatArray, Contacts]:
    """Positions (m + n, 2) near x where, if all goes well, every pair keeps its distance, and the contacts there.

    required: (K,) wanted distances; side: (K,) sides on which the points belong.
    """
    contacts = measure(pairs, x, side)
    for number in range(PASSES):
        missing = required - contacts.distance
        if float(missing.max(initial=0.0)) <= 0.0:
            break
        missing *= OVERSHOOT if number < LATER else LATER_OVERSHOOT
        missing[missing > 0.0] += NUDGE * required[missing > 0.0]
        x = x.copy()
        x[: bodies.m] += _correction(bodies, pairs, contacts, x, missing)
        contacts = measure(pairs, x, side)
    return x, contacts


def _correction(bodies: Bodies, pairs: Pairs, contacts: Contacts, x: FloatArray, missing: FloatArray) -> FloatArray:
    """(m, 2) motion of the cage that makes up for the missing distances (K,)."""
    m = bodies.m
    cage = x[:m]
    family = pairs.fine_cage
    short = np.flatnonzero(missing[family] > 0.0)
    shift = np.zeros(m)
    np.maximum.at(shift, pairs.start[short], missing[short])
    correction = _shift_edges(bodies, cage, shift)
    for family, share in ((pairs.cage_fine, 1.0), (pairs.cage_cage, 0.5)):
        short = np.flatnonzero(missing[family] > 0.0) + family.start
        if len(short) == 0:
            continue
        push = contacts.normal[short] * (share * missing[short])[:, None]
        np.add.at(correction, pairs.point[short], push)
        if share < 1.0:
            np.subtract.at(correction, pairs.start[short], push)
            np.subtract.at(correction, pairs.end[short], push)
    return correction


def _shift_edges(bodies: Bodies, cage: FloatArray, shift: FloatArray) -> FloatArray:
    """(m, 2) smallest motions of the vertices that move every edge outwards by ``shift`` (m,)."""
    edge = cage[bodies.cage_successor] - cage
    length = np.hypot(edge[:, 0], edge[:, 1])
    n_x, n_y = edge[:, 1] / length, -edge[:, 0] / length
    before = bodies.cage_predecessor
    p_x, p_y, before_shift = n_x[before], n_y[before], shift[before]
    straight = np.abs(n_x * p_x + n_y * p_y) > NEARLY_STRAIGHT
    larger = np.maximum(shift, before_shift)
    own, other = np.where(straight, larger, shift), np.where(straight, larger, before_shift)
    # normal equations of n · e = own, p · e = other
    xx = n_x * n_x + p_x * p_x + DAMPING
    xy = n_x * n_y + p_x * p_y
    yy = n_y * n_y + p_y * p_y + DAMPING
    right_x, right_y = n_x * own + p_x * other, n_y * own + p_y * other
    determinant = xx * yy - xy * xy
    motion = np.stack([yy * right_x - xy * right_y, xx * right_y - xy * right_x], axis=1)
    out: FloatArray = motion / determinant[:, None]
    return out
