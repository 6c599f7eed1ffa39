"""How the loops of two meshes lie in each other: the one test of enclosure, by exact predicates."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..arrays import IntArray
from ..loops import enclosing_pairs, extreme_places, parents
from ..predicates import segments_intersect
from .mesh import Mesh


class Nesting:
    """Two meshes, of which the first may enclose the second.

    Where loops of both are numbered together, those of the outer mesh come first.
    """

    def __init__(self, outer: Mesh, inner: Mesh) -> None:
        """Both meshes must be valid; their boundaries may meet, but then only `contact` has a meaning."""
        self.outer, self.inner = outer, inner

    @cached_property
    def contact(self) -> tuple[int, int] | None:
        """Start vertices of an edge of the outer and one of the inner mesh that touch or cross; None if none do."""
        tree, other = self.outer.edge_tree, self.inner.edge_tree
        for i, j in tree.blocks(other):
            hits = np.flatnonzero(segments_intersect(*tree.segments(i), *other.segments(j)))
            if len(hits):
                k, m = i[hits[0]], j[hits[0]]
                return int(self.outer.loop_order.numbers[k]), int(self.inner.loop_order.numbers[m])
        return None

    @cached_property
    def pairs(self) -> tuple[IntArray, IntArray]:
        """Pairs (within, around) of loops of which one lies inside the other, (K,), (K,)."""
        meshes = self.outer, self.inner
        orders = [mesh.loop_order for mesh in meshes]
        extremes = np.concatenate([order.vertices[extreme_places(order)] for order in orders])
        within, around = zip(*(enclosing_pairs(extremes, order) for order in orders), strict=True)
        return np.concatenate(within), np.concatenate((around[0], around[1] + len(self.outer.loops)))

    @cached_property
    def parents(self) -> IntArray:
        """The smallest loop around each loop of either mesh, -1 for none."""
        return parents(*self.pairs, len(self.outer.loops) + len(self.inner.loops))[1]

    @cached_property
    def uncovered(self) -> tuple[IntArray, IntArray]:
        """Loops of the inner mesh outside the outer solid, and loops of the outer mesh inside the inner solid.

        Where boundaries do not meet, the inner solid lies inside the outer one if and only if there are neither. The
        second kind occurs in a thin ring around the boundary of the inner solid.
        """
        within, around = self.pairs
        kept, count = len(self.outer.loops), len(self.outer.loops) + len(self.inner.loops)
        by_outer, by_inner = around < kept, around >= kept
        in_outer = np.bincount(within[by_outer], self.outer.loop_signs[around[by_outer]], count)[kept:]
        in_inner = np.bincount(within[by_inner], self.inner.loop_signs[around[by_inner] - kept], count)[:kept]
        return np.flatnonzero(in_outer < 1), np.flatnonzero(in_inner > 0)

    def encloses(self) -> bool:
        """Whether the inner solid lies in the interior of the outer one."""
        return self.contact is None and not any(map(len, self.uncovered))

    def encloses_loop_by_loop(self) -> bool:
        """Whether moreover loop k of the outer mesh runs around loop k of the inner one; for holes, inside it."""
        if not np.array_equal(self.outer.loop_signs, self.inner.loop_signs) or not self.encloses():
            return False
        count, k = len(self.outer.loops), np.arange(len(self.outer.loops), dtype=np.int64)
        is_outer = self.outer.loop_signs > 0
        wanted = np.where(is_outer, count + k, k) * 2 * count + np.where(is_outer, k, count + k)
        within, around = self.pairs
        return bool(np.isin(wanted, within * 2 * count + around).all())


def outer_and_inner(cage: Mesh, fine: Mesh, side: int) -> tuple[Mesh, Mesh]:
    """The outer and the inner mesh: a cage around a fine mesh has the side 1, one inside it -1."""
    return (cage, fine) if side > 0 else (fine, cage)
