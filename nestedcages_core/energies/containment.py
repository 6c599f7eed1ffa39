"""E_cont, infinite when the fine mesh is not inside the cage."""

from __future__ import annotations

import numpy as np

from .._types import FloatArray, IntArray
from ..predicates import BoxTree, crossing_pairs


class Containment:
    """0 where no edges of cage and fine mesh meet and the cage does not meet itself, infinite elsewhere; exact.

    With a contained start and motions free of collisions, containment can only be lost together with this (Gurditta &
    Jacobson 2022,
    section 3.2, test it by a parity count, which a ray through a vertex deceives).
    """

    def __init__(self, cage_successor: IntArray, fine_successor: IntArray) -> None:
        self._cage_successor = cage_successor
        self._fine_successor = fine_successor
        self._m = len(cage_successor)

    def value(self, x: FloatArray) -> float:
        """E_cont at x = (C; F), an array (m + n, 2)."""
        return 0.0 if self.first_contact(x) is None else np.inf

    def first_contact(self, x: FloatArray) -> int | None:
        """Index into x of a vertex whose edge meets the cage; None where the cage meets neither the fine mesh nor
        itself."""
        cage, fine = x[: self._m], x[self._m :]
        cage_tree = BoxTree(cage, cage[self._cage_successor])
        fine_edge, _ = crossing_pairs(BoxTree(fine, fine[self._fine_successor]), cage_tree)
        if len(fine_edge):
            return self._m + int(fine_edge[0])
        one, other = crossing_pairs(cage_tree)
        foreign = (self._cage_successor[one] != other) & (self._cage_successor[other] != one)
        if foreign.any():
            return int(one[foreign][0])
        return None
