"""Visvalingam's simplification: remove the vertex whose triangle with its neighbours is smallest."""

from __future__ import annotations

from dataclasses import dataclass

from nestedcages_core.decimation.base import Count
from nestedcages_core.geometry.mesh import Mesh
from nestedcages_core.geometry.predicates import orientation_sign

from .greedy import Simplification, simplified


@dataclass(frozen=True)
class Visvalingam:
    """The vertices of the fine mesh that span most area (Visvalingam & Whyatt 1993), in loops that stay simple."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh of vertices of the fine one, whatever the clearance; loop k on loop k. Raises NestingError."""
        return simplified(fine, count, _Dropping)


class _Dropping(Simplification):
    """The move of a vertex b between a and c: drop it."""

    def consider(self, vertex: int) -> None:
        """Its cost is the area of the triangle a, b, c."""
        loops = self.loops
        self.renew(vertex)
        a, c = loops.previous[vertex], loops.next[vertex]
        ux, uy = loops.x[vertex] - loops.x[a], loops.y[vertex] - loops.y[a]
        wx, wy = loops.x[c] - loops.x[vertex], loops.y[c] - loops.y[vertex]
        self.queue.push([(0.5 * abs(ux * wy - uy * wx), vertex, ())])

    def make(self, vertex: int, place: tuple[float, ...]) -> bool:
        """Drop b unless something lies in the triangle, or the last three vertices would lie on a line."""
        loops, x, y = self.loops, self.loops.x, self.loops.y
        a, c = loops.previous[vertex], loops.next[vertex]
        d = loops.next[c]
        if loops.next[d] == a and orientation_sign(x[a], y[a], x[c], y[c], x[d], y[d]) == 0:
            return False
        if not self.is_free((x[a], y[a]), (x[vertex], y[vertex]), (x[c], y[c]), a, vertex, c):
            return False
        self.renew(vertex)
        loops.remove(vertex)
        self.consider(a)
        self.consider(c)
        return True
