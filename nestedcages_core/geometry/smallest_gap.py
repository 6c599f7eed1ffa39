"""The smallest distance between two boundaries: branch and bound over balls around stretches of them."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt, ldexp
from typing import NamedTuple

import numpy as np

from .arrays import FloatArray, IntArray
from .distance import point_edge
from .predicates import BoxTree, as_integers
from .predicates.box_tree import CROWDED, FANOUT, children

FIRST_BALLS = 32
"""Maximum number of balls of the top level: pairs of that many take less time than further levels (measured)."""

ROUNDING = 16.0 * float(np.finfo(float).eps)
"""Bound on the error of a distance between a point and a segment, over the vectors between their ends."""

ACCURATE = 1e-12
"""Relative error of a distance that is left to rounding; where it may be larger, the distance is exact."""

ROOT_BITS = 64
"""Binary digits of a root, more than a double has."""


class Balls(NamedTuple):
    """Balls around vertices of a boundary, each of which covers a stretch of it."""

    centres: FloatArray
    """(N, 2) vertices."""
    radii: FloatArray
    """(N,) lengths."""


class Stretches:
    """The segments of a tree and balls around them: level 0 around single ones, the next around FANOUT of these, ..."""

    def __init__(self, tree: BoxTree) -> None:
        self.starts, self.ends = tree.sorted_segments
        self.levels = [Balls(self.starts, np.hypot(*(self.ends - self.starts).T))]
        while len(self.levels[-1].radii) > FIRST_BALLS:
            self.levels.append(_parents(*self.levels[-1]))
        self.counts = [len(level.radii) for level in self.levels]

    def segments(self, chosen: IntArray) -> tuple[FloatArray, FloatArray]:
        """Starts and ends, (K, 2) each, of some segments (K,) in tree order."""
        return self.starts.take(chosen, axis=0), self.ends.take(chosen, axis=0)


def smallest_gap(here: BoxTree, there: BoxTree) -> float:
    """Smallest distance between the closed loops of two trees, which must not meet.

    Centres are vertices, so every measured distance is an upper bound of the result; pairs of balls that are farther
    apart than the best bound are dropped, and so are crowded pairs that oriented boxes separate. The cost grows with
    the length in close contact. What rounding may decide is measured again in whole numbers.
    """
    ours, theirs = Stretches(here), Stretches(there)
    a, b = len(ours.levels) - 1, len(theirs.levels) - 1
    i, j = np.indices((ours.counts[a], theirs.counts[b])).reshape(2, -1)
    best = np.inf
    longest = float(max(ours.levels[0].radii.max(), theirs.levels[0].radii.max()))
    while True:
        distance, reach = _distance_between(ours, a, i, theirs, b, j)
        best = min(best, float(distance.min()))
        slack = ROUNDING * (longest + best)
        if a == 0 and b == 0:
            if slack <= ACCURATE * best:
                return best
            near = distance <= best + 2.0 * slack
            return _exact_gap(*ours.segments(i[near]), *theirs.segments(j[near]))
        near = distance - reach <= best + 2.0 * slack
        i, j = i[near], j[near]
        if len(i) > CROWDED * (ours.counts[a] + theirs.counts[b]):
            near = here.oriented(a).gap(i, there.oriented(b), j) <= best + 2.0 * slack
            i, j = i[near], j[near]
        if b == 0 or (a > 0 and ours.levels[a].radii[i].mean() > theirs.levels[b].radii[j].mean()):
            a, i, j = a - 1, children(i), np.repeat(j, FANOUT)
        else:
            b, i, j = b - 1, np.repeat(i, FANOUT), children(j)
        exist = (i < ours.counts[a]) & (j < theirs.counts[b])
        i, j = i[exist], j[exist]


def _exact_gap(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float:
    """Smallest distance of a start from the other segment, of pairs a-b and c-d (K, 2), rounded once."""
    p, a, b = (np.concatenate(each) for each in ((a, c), (c, a), (d, b)))
    whole, exponent = as_integers(np.concatenate([p, a, b], axis=1).reshape(1, -1))
    p, a, b = whole.reshape(-1, 3, 2).transpose(1, 2, 0)
    along, to_a, to_b = b - a, p - a, p - b
    place, length = (along * to_a).sum(axis=0), (along**2).sum(axis=0)
    off = (along[0] * to_a[1] - along[1] * to_a[0]) ** 2
    ends = np.where(place <= 0, (to_a**2).sum(axis=0), (to_b**2).sum(axis=0)) * length
    squared = np.where((place <= 0) | (place >= length), ends, off)
    over, under = min(zip(squared, length, strict=True), key=lambda ratio: Fraction(*ratio))
    shift = 2 * (ROOT_BITS - (over.bit_length() - under.bit_length()) // 2)
    root = isqrt((over << shift if shift >= 0 else over >> -shift) // under)
    return ldexp(root, int(exponent[0]) - shift // 2)


def _parents(centres: FloatArray, radii: FloatArray) -> Balls:
    """Balls around FANOUT balls each, with their centres in the middle of these."""
    begins = np.arange(0, len(radii), FANOUT)
    middles = centres[np.minimum(begins + FANOUT // 2, len(radii) - 1)]
    across = centres - np.repeat(middles, FANOUT, axis=0)[: len(radii)]
    return Balls(middles, np.maximum.reduceat(np.hypot(across[:, 0], across[:, 1]) + radii, begins))


def _distance_between(
    ours: Stretches, a: int, i: IntArray, theirs: Stretches, b: int, j: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Distance between points of stretches i and j, of levels a and b, and by how much these may be closer, (K,), (K,).

    A stretch of one segment is measured to the centre of the other one. Of two single segments the start points are
    measured, as their end points are the start points of others.
    """
    centres, others = ours.levels[a].centres.take(i, axis=0), theirs.levels[b].centres.take(j, axis=0)
    reach, other_reach = ours.levels[a].radii.take(i), theirs.levels[b].radii.take(j)
    if a > 0 and b > 0:
        return np.hypot(*(centres - others).T), reach + other_reach
    to_theirs = point_edge(centres, *theirs.segments(j)).distance if b == 0 else None
    to_ours = point_edge(others, *ours.segments(i)).distance if a == 0 else None
    if to_ours is None:
        assert to_theirs is not None
        return to_theirs, reach
    if to_theirs is None:
        return to_ours, other_reach
    return np.minimum(to_ours, to_theirs), np.zeros(len(i))
