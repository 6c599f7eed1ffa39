"""Greedy simplification: loops lose vertices one by one, cheapest first, and never cross.

A move replaces a short chain of edges by another one. It is made only if no vertex of any loop lies between the two
chains and the new edges touch nothing, by exact tests. So loops never pass each other or change their roles.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

from nestedcages_core.decimation.base import REACH, Count
from nestedcages_core.decimation.hull.hull_moves import NEGLIGIBLE_COST, MoveQueue
from nestedcages_core.decimation.hull.linked_loops import LinkedLoops
from nestedcages_core.decimation.request import Request
from nestedcages_core.errors import InvalidMeshError, NestingError
from nestedcages_core.geometry.loops import Loops
from nestedcages_core.geometry.mesh import Mesh
from nestedcages_core.geometry.predicates import orientation_sign


class Simplification(ABC):
    """State of a greedy simplification: the loops and a queue of moves, one slot per vertex."""

    def __init__(self, outline: Loops, minimum: Sequence[int]) -> None:
        """minimum: vertices that each loop keeps, at least 3."""
        self.minimum = list(minimum)
        self.loops = LinkedLoops(outline, REACH)
        self.queue = MoveQueue(self.loops.total, NEGLIGIBLE_COST * self.loops.diameter**2)

    @abstractmethod
    def consider(self, vertex: int) -> None:
        """Push the move of a vertex, if it has one."""

    @abstractmethod
    def make(self, vertex: int, place: tuple[float, ...]) -> bool:
        """Make the move of a vertex if nothing blocks it, and reconsider its neighbours; whether it was made."""

    def renew(self, vertex: int) -> None:
        """Discard the moves of a vertex."""
        self.queue.stamps[vertex] += 1

    def run(self, count: int) -> Loops:
        """Remove vertices until `count` are left, or as many as can be removed."""
        loops, made = self.loops, True
        while loops.total > count and made and loops.sizes != self.minimum:
            made = False  # an obstacle may be gone once the queue is empty
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
    request = Request.of(fine, count)
    left = method(request.outline, request.minimum).run(request.target)
    if len(left.vertices) > request.target:
        raise NestingError(
            f"{request.target} vertices are too few to follow the mesh without crossings: the loops block each "
            f"other at {len(left.vertices)}; ask for at least as many, or use the outer hull.",
            code="count.too_small",
        )
    return followed(request, left)


def followed(request: Request, outline: Loops) -> Mesh:
    """The coarse mesh of a simplified outline, with as many vertices as wanted. Raises NestingError."""
    try:
        return request.same_roles(request.coarse(outline))
    except InvalidMeshError as error:
        raise NestingError(
            f"{request.total} vertices are too few to follow the mesh: {error} Ask for more, or use the outer hull.",
            code="count.too_small",
        ) from error
