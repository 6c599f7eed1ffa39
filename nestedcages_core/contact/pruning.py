"""Redundant contacts: those above the lower convex hull of the contacts of their cage edge.

All fine vertices on the inner side of a cage edge share its normal. Their constraints room + (1 - t) u + t v ≥ 0 on the
motions u, v of its ends are implied by those on the lower convex hull of the points (t, room). What steps then miss of
a contact that is nearly implied, their restoration makes up for.

See docs/numbers.md: pruning of implied constraints.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from .linearisation import Contacts
from .pairs import Pairs

MAX_PASSES = 20
"""Cap on the passes; each removes the points above the chord of their neighbours, and half of those nearly above it.
Around smooth outlines hundreds follow that remove few each."""

NEGLIGIBLE_SAG = 0.05
"""How far below the chord of its neighbours a point may be to count as implied, as a fraction of its own room: near a
contact all points stay, and a smooth outline of any number of vertices has a few for each edge."""


def not_implied(pairs: Pairs, contacts: Contacts, room: FloatArray) -> BoolArray:
    """(K,) whether the constraint of each pair is needed: not implied by others.

    room: (K,) value of each constraint without motion.
    """
    keep = np.ones(len(pairs), bool)
    which = np.flatnonzero(contacts.on_line[pairs.fine_cage] & (contacts.side[pairs.fine_cage] > 0.0))
    group, t, height = pairs.start.take(which), contacts.parameter.take(which), room.take(which)
    if len(which) < 3:
        return keep
    order = np.lexsort((t, group))
    group, t, height, which = group.take(order), t.take(order), height.take(order), which.take(order)
    kept = _lower_hull(group, t, height, NEGLIGIBLE_SAG * height)
    keep[which] = False
    keep[which.take(kept)] = True
    return keep


def _lower_hull(group: IntArray, t: FloatArray, height: FloatArray, sag: FloatArray) -> IntArray:
    """Indices of points (t, height), about those on the lower convex hulls of their groups; sag: what is negligible."""
    kept = np.arange(len(group))
    for _ in range(MAX_PASSES):
        above, nearly = _above_neighbours(group, t, height, sag)
        rank = np.arange(len(group)) - np.searchsorted(group, group)
        nearly &= rank[1:-1] % 2 == 1  # of two neighbours one stays, the same in any order of the edges
        below = np.ones(len(kept), bool)
        np.logical_not(above | nearly, out=below[1:-1])
        left = np.flatnonzero(below)
        if len(left) == len(kept):
            break
        kept, group = kept.take(left), group.take(left)
        t, height, sag = t.take(left), height.take(left), sag.take(left)
    return kept


def _above_neighbours(
    group: IntArray, t: FloatArray, height: FloatArray, sag: FloatArray
) -> tuple[BoolArray, BoolArray]:
    """(K - 2,) whether each inner point is on or above the chord of its two neighbours, and whether it nearly is."""
    if len(group) < 3:
        return np.zeros(0, bool), np.zeros(0, bool)
    step = t[1:] - t[:-1]
    before, after = step[:-1], step[1:]
    chord = height[:-2] * after + height[2:] * before
    whole = before + after
    within = group[:-2] == group[2:]
    return (height[1:-1] * whole >= chord) & within, ((height[1:-1] + sag[1:-1]) * whole >= chord) & within
