"""Redundant contacts: those above the lower convex hull of the contacts of their cage edge.

All fine vertices on the inner side of a cage edge share its normal. Their constraints room + (1 - t) u + t v ≥ 0 on the
motions u, v of its ends are implied by those on the lower convex hull of the points (t, room).

See docs/ablation.md: pruning of implied constraints.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from .linearisation import Contacts
from .pairs import Pairs

HULL_PASSES = 6
"""Cap on the passes of the convex hull; each removes every point above the chord of its neighbours."""

THINNING_PASSES = 8
"""Cap on the passes of thinning; each removes at most every second point."""


def not_implied(pairs: Pairs, contacts: Contacts, room: FloatArray, tolerance: float) -> BoolArray:
    """(K,) whether the constraint of each pair is needed: not implied by others up to ``tolerance``, a length.

    room: (K,) value of each constraint without motion.
    """
    keep = np.ones(len(pairs), bool)
    t = contacts.parameter
    inner = np.flatnonzero(contacts.on_line[pairs.fine_cage] & (contacts.side[pairs.fine_cage] > 0.0))
    if len(inner) < 3:
        return keep
    edge = pairs.start
    order = inner[np.lexsort((room[inner], t[inner], edge[inner]))]
    kept = _lower_hull(edge[order], t[order], room[order])
    if tolerance > 0.0:
        kept = kept[_thin(edge[order[kept]], t[order[kept]], room[order[kept]], tolerance)]
    keep[inner] = False
    keep[order[kept]] = True
    return keep


def _lower_hull(edge: IntArray, t: FloatArray, height: FloatArray) -> IntArray:
    """Indices of a superset of the points (t, height) on the lower convex hulls of their edges."""
    kept = np.arange(len(edge))
    for _ in range(HULL_PASSES):
        above = _above_neighbours(edge[kept], t[kept], height[kept], 0.0)
        if not above.any():
            break
        kept = kept[np.concatenate([[True], ~above, [True]])]
    return kept


def _thin(edge: IntArray, t: FloatArray, height: FloatArray, tolerance: float) -> IntArray:
    """Indices of points of convex chains such that each pass removes points less than ``tolerance`` below a chord."""
    kept = np.arange(len(edge))
    for _ in range(THINNING_PASSES):
        close = _above_neighbours(edge[kept], t[kept], height[kept], tolerance)
        close[1::2] = False  # never two neighbours in one pass
        if not close.any():
            break
        kept = kept[np.concatenate([[True], ~close, [True]])]
    return kept


def _above_neighbours(edge: IntArray, t: FloatArray, height: FloatArray, tolerance: float) -> BoolArray:
    """(K - 2,) whether each inner point, raised by the tolerance, is on or above the chord of its two neighbours."""
    if len(edge) < 3:
        return np.zeros(max(len(edge) - 2, 0), bool)
    before, after = t[1:-1] - t[:-2], t[2:] - t[1:-1]
    chord = height[:-2] * after + height[2:] * before
    above: BoolArray = (edge[:-2] == edge[2:]) & ((height[1:-1] + tolerance) * (before + after) >= chord)
    return above
