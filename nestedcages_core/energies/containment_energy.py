"""E_cont, infinite where the cage meets the fine mesh or itself."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.predicates import crossing_pairs


class ContainmentEnergy:
    """0 where no edges of cage and fine mesh meet and the cage does not meet itself, infinite elsewhere; exact.

    From a contained start and by collision-free motion, containment cannot be lost in any other way. (Gurditta &
    Jacobson 2022, section 3.2, use the parity of ray crossings, which fails for rays through a vertex.)
    """

    def __init__(self, cage_successor: IntArray, fine_successor: IntArray) -> None:
        self._cage_successor = cage_successor
        self._fine_successor = fine_successor
        self._m = len(cage_successor)

    def value(self, x: FloatArray) -> float:
        """E_cont at x = (C; F), an array (m + n, 2)."""
        return 0.0 if self.first_contact(x) is None else np.inf

    def first_contact(self, x: FloatArray) -> int | None:
        """Index into x of a vertex whose edge meets the cage; None if nothing meets the cage."""
        cage, fine = x[: self._m], x[self._m :]
        cage_tree = BoxTree(cage, cage.take(self._cage_successor, axis=0))
        fine_edge, _ = crossing_pairs(BoxTree(fine, fine.take(self._fine_successor, axis=0)), cage_tree)
        if len(fine_edge):
            return self._m + int(fine_edge[0])
        one, other = crossing_pairs(cage_tree)
        apart = (self._cage_successor[one] != other) & (self._cage_successor[other] != one)
        return int(one[apart][0]) if apart.any() else None
