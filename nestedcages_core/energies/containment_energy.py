"""E_cont, infinite where the cage meets the fine mesh or itself."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.predicates import BoxTree, crossing_pairs, segments_intersect

ALL_PAIRS_LIMIT = 6000
"""Number of pairs of edges up to which testing all of them is faster than box trees (measured)."""


class ContainmentEnergy:
    """0 where no edges of cage and fine mesh meet and the cage does not meet itself, infinite elsewhere; exact.

    From a contained start and by collision-free motion, containment cannot be lost in any other way. (Gurditta &
    Jacobson 2022, section 3.2, use the parity of ray crossings, which fails for rays through a vertex.)
    """

    def __init__(self, cage_successor: IntArray, fine_successor: IntArray) -> None:
        self._cage_successor = cage_successor
        self._fine_successor = fine_successor
        self._m = len(cage_successor)
        self._successor = np.concatenate([cage_successor, fine_successor + self._m])
        self._all_pairs = self._pairs() if self._m * len(self._successor) <= ALL_PAIRS_LIMIT else None

    def value(self, x: FloatArray) -> float:
        """E_cont at x = (C; F), an array (m + n, 2)."""
        return 0.0 if self.first_contact(x) is None else np.inf

    def first_contact(self, x: FloatArray) -> int | None:
        """Index into x of a vertex whose edge meets the cage; None if nothing meets the cage."""
        cage, fine = x[: self._m], x[self._m :]
        if self._all_pairs is not None:
            a, b = self._all_pairs
            ends = x[self._successor]
            met = np.flatnonzero(segments_intersect(x[a], ends[a], x[b], ends[b]))
            return int(a[met[0]]) if len(met) else None
        cage_tree = BoxTree(cage, cage[self._cage_successor])
        fine_edge, _ = crossing_pairs(BoxTree(fine, fine[self._fine_successor]), cage_tree)
        if len(fine_edge):
            return self._m + int(fine_edge[0])
        one, other = crossing_pairs(cage_tree)
        apart = self._not_neighbours(one, other)
        return int(one[apart][0]) if apart.any() else None

    def _not_neighbours(self, one: IntArray, other: IntArray) -> BoolArray:
        """Whether pairs of cage edges share no vertex."""
        apart: BoolArray = (self._cage_successor[one] != other) & (self._cage_successor[other] != one)
        return apart

    def _pairs(self) -> tuple[IntArray, IntArray]:
        """All pairs of edges that must not meet: fine edge and cage edge, and cage edges that share no vertex."""
        fine, cage = np.divmod(np.arange(self._m * (len(self._successor) - self._m)), self._m)
        one, other = np.triu_indices(self._m, 1)
        apart = self._not_neighbours(one, other)
        return np.concatenate([fine + self._m, one[apart]]), np.concatenate([cage, other[apart]])
