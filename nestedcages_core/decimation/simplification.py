"""Loops that lose vertices one by one, cheapest first, and never cross on the way: what simplifications share.

A move replaces a short chain of edges by another one. It is made only if no vertex of any loop lies between the two
chains and the new edges touch nothing, by exact tests; so no loop is passed over and none changes its role.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

from ..errors import InvalidMeshError, NestingError
from ..geometry.mesh import Mesh
from ..geometry.predicates import orientation_sign
from .apportion import padded
from .arc_length import same_loops
from .base import Budget, Count, checked_budget
from .canonical_order import Unrolled, unroll
from .linked_loops import LinkedLoops
from .move_queue import MoveQueue
from .outline import Outline

REACH = 1.5
"""Largest distance of new vertices from the centre, in diameters; moves that go farther are not made."""

NEGLIGIBLE_COST = 1e-15
"""Cost in squared diameters that is nothing but round-off."""


class Simplification(ABC):
    """State of a greedy simplification: the loops and a queue of moves, one slot per vertex."""

    def __init__(self, outline: Outline, minimum: Sequence[int]) -> None:
        """minimum: vertices that each loop keeps, at least 3."""
        self.minimum = list(minimum)
        self.loops = LinkedLoops(outline, REACH)
        self.queue = MoveQueue(self.loops.total, NEGLIGIBLE_COST * self.loops.diameter**2)

    @abstractmethod
    def consider(self, vertex: int) -> None:
        """Push the move of a vertex, if it has one."""

    @abstractmethod
    def make(self, vertex: int, place: tuple[float, ...]) -> bool:
        """Make the move of a vertex if nothing is in its way, and consider what it changes; whether it was made."""

    def run(self, count: int) -> Outline:
        """Remove vertices until `count` are left, or as many as can be removed."""
        loops, made = self.loops, True
        while loops.total > count and made and loops.sizes != self.minimum:
            made = False  # what was in the way of a move may be gone by the end of the queue
            for vertex, alive in enumerate(loops.alive):
                if alive:
                    self.consider(vertex)
            while loops.total > count and (move := self.queue.pop()) is not None:
                vertex, place = move
                loop = loops.loop_of[vertex]
                if loops.sizes[loop] > self.minimum[loop]:
                    made |= self.make(vertex, place)
        return loops.outline()

    def is_free(self, a: tuple[float, float], b: tuple[float, float], c: tuple[float, float], *own: int) -> bool:
        """Whether no vertex but `own` lies in the triangle a, b, c, of either orientation."""
        side = orientation_sign(*a, *b, *c)
        if side < 0:
            b, c = c, b
        return side == 0 or not self.loops.vertex_in_triangle(*a, *b, *c, own=own)


def simplified(fine: Mesh, count: Count, method: type[Simplification]) -> Mesh:
    """The fine mesh with a wanted number of vertices by a simplification; loop k on loop k. Raises NestingError."""
    budget = checked_budget(fine, count)
    unrolled = unroll(fine)
    per_loop, minimum = unrolled.per_loop(budget), unrolled.minimum(budget)
    total = budget.total if per_loop is None else sum(minimum)
    left = method(unrolled.outline, minimum).run(total)
    if len(left.vertices) > total:
        raise NestingError(
            f"{total} vertices are too few to follow the mesh without crossings: the loops are in each other's way at "
            f"{len(left.vertices)}; ask for at least as many, or use the outer hull."
        )
    return followed(unrolled, left, budget, fine)


def followed(unrolled: Unrolled, outline: Outline, budget: Budget, fine: Mesh) -> Mesh:
    """The coarse mesh of a simplified outline, with all the vertices of its budget. Raises NestingError."""
    try:
        return same_loops(unrolled, padded(outline, budget.total, unrolled.per_loop(budget)), fine)
    except InvalidMeshError as error:
        raise NestingError(
            f"{budget.total} vertices are too few to follow the mesh: {error} Ask for more, or use the outer hull."
        ) from error
