"""Edge collapse by quadric error: an edge shrinks to the point closest to the lines that it replaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import frexp

import numpy as np

from nestedcages_core.decimation.base import REACH, Count
from nestedcages_core.geometry.arrays import TINY
from nestedcages_core.geometry.loops import Loops
from nestedcages_core.geometry.mesh import Mesh
from nestedcages_core.geometry.predicates import orientation_sign
from nestedcages_core.geometry.vectors import norm

from .greedy import Simplification, simplified

MIDPOINT_WEIGHT = 1e-3
"""Weight of the distance to the middle of the edge, relative to that of its lines: decides for parallel lines."""

Point = tuple[float, float]


@dataclass(frozen=True)
class EdgeCollapse:
    """Vertices near the fine mesh, where squared distances to its lines are least (Garland & Heckbert 1997)."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh near the fine one, whatever the clearance; loop k on loop k. Raises NestingError."""
        return simplified(fine, count, _Collapsing)


class _Collapsing(Simplification):
    """The move of the vertex b of a chain a, b, c, d: b and c become one vertex x.

    Each vertex carries the quadric Q(x) = Σ l (n · (x - p))² of the fine edges that have come together in it, with
    lengths l and normals n, about the centre: coefficients of x², xy, y², x, y and 1.
    """

    def __init__(self, outline: Loops, minimum: Sequence[int]) -> None:
        super().__init__(outline, minimum)
        # a power of two scales exactly, and keeps the sixth powers of lengths within the range of floats
        self.unit = 2.0 ** frexp(self.loops.diameter)[1]
        edge = outline.vertices[outline.successor] - outline.vertices
        length = norm(edge)
        nx, ny = edge[:, 1] / length, -edge[:, 0] / length
        offset = (np.stack((nx, ny), axis=1) * ((outline.vertices - self.loops.centre) / self.unit)).sum(axis=1)
        length /= self.unit
        of_edge = length * np.stack((nx * nx, 2 * nx * ny, ny * ny, -2 * offset * nx, -2 * offset * ny, offset**2))
        self.quadrics: list[list[float]] = (of_edge + of_edge[:, outline.predecessor]).T.tolist()

    def consider(self, vertex: int) -> None:
        """Its cost is the quadric of both ends at the best x."""
        loops = self.loops
        self.renew(vertex)
        c = loops.next[vertex]
        (cx, cy), X, Y = loops.centre, loops.x, loops.y
        xx, xy, yy, x1, y1, one = map(sum, zip(self.quadrics[vertex], self.quadrics[c], strict=True))
        mx, my = (0.5 * (X[vertex] + X[c]) - cx) / self.unit, (0.5 * (Y[vertex] + Y[c]) - cy) / self.unit
        anchor = MIDPOINT_WEIGHT * (xx + yy)
        # gradient: (2 (xx + anchor), xy; xy, 2 (yy + anchor)) (x, y) = (2 anchor mx - x1, 2 anchor my - y1)
        p, q, r, s = 2.0 * (xx + anchor), 2.0 * (yy + anchor), 2.0 * anchor * mx - x1, 2.0 * anchor * my - y1
        determinant = p * q - xy * xy
        if determinant < TINY:
            return  # edges too short to have a line
        x, y = (q * r - xy * s) / determinant, (p * s - xy * r) / determinant
        cost = xx * x * x + xy * x * y + yy * y * y + x1 * x + y1 * y + one
        if max(abs(x), abs(y)) < REACH * loops.diameter / self.unit:
            squared = max(cost, 0.0) / (loops.diameter / self.unit) * self.unit * self.unit
            self.queue.push([(squared, vertex, (self.unit * x + cx, self.unit * y + cy))])

    def make(self, vertex: int, place: tuple[float, ...]) -> bool:
        """Collapse unless something lies between the chains, or the new edges touch something."""
        loops = self.loops
        b, c = vertex, loops.next[vertex]
        a, d = loops.previous[b], loops.next[c]
        at = (place[0], place[1])
        A, D = self._point(a), self._point(d)
        if orientation_sign(*A, *at, *D) == 0 and (loops.next[d] == a or not _between(A, at, D)):
            return False
        if not self._is_free(a, b, c, d, at):
            return False
        self.renew(b)
        self.renew(c)
        self.quadrics[b] = list(map(sum, zip(self.quadrics[b], self.quadrics[c], strict=True)))
        loops.remove(c, (b, *at))
        for v in (loops.previous[a], a, b, d):
            self.consider(v)
        return True

    def _is_free(self, a: int, b: int, c: int, d: int, at: Point) -> bool:
        """Whether nothing blocks the motion of the chain a, b, c, d to a, x, d with x at ``at``; exact."""
        loops, X, Y = self.loops, self.loops.x, self.loops.y
        A, B, C, D = (self._point(v) for v in (a, b, c, d))
        xs, ys = (A[0], B[0], C[0], D[0], at[0]), (A[1], B[1], C[1], D[1], at[1])
        for edge in loops.boxes.near(min(xs), min(ys), max(xs), max(ys)):
            if edge in (a, b, c):
                continue
            after = loops.next[edge]
            start, stop = (X[edge], Y[edge]), (X[after], Y[after])
            if edge != d and any(_in_triangle(start, *corners, at) for corners in ((A, B), (B, C), (C, D))):
                return False
            for end, own in ((a, A), (d, D)):
                if end in (edge, after):  # the edge that the new one continues
                    away = stop if edge == end else start
                    if orientation_sign(*own, *at, *away) == 0 and not _between(at, own, away):
                        return False
                elif touching(own, at, start, stop):
                    return False
        return True

    def _point(self, vertex: int) -> Point:
        return self.loops.x[vertex], self.loops.y[vertex]


def _between(a: Point, b: Point, c: Point) -> bool:
    """Whether b lies strictly between a and c, given that they are on one line."""
    return (a[0] < b[0] < c[0] or a[0] > b[0] > c[0]) if a[0] != c[0] else (a[1] < b[1] < c[1] or a[1] > b[1] > c[1])


def _in_triangle(p: Point, a: Point, b: Point, c: Point) -> bool:
    """Whether a point lies in a closed triangle of either orientation; exact."""
    signs = orientation_sign(*a, *b, *p), orientation_sign(*b, *c, *p), orientation_sign(*c, *a, *p)
    if min(signs) < 0 < max(signs):
        return False
    return signs != (0, 0, 0) or touching(p, p, a, b) or touching(p, p, b, c)


def touching(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether the closed segments a-b and c-d have a point in common; exact."""
    if max(a[0], b[0]) < min(c[0], d[0]) or max(c[0], d[0]) < min(a[0], b[0]):
        return False
    if max(a[1], b[1]) < min(c[1], d[1]) or max(c[1], d[1]) < min(a[1], b[1]):
        return False
    if orientation_sign(*a, *b, *c) * orientation_sign(*a, *b, *d) > 0:
        return False
    return orientation_sign(*c, *d, *a) * orientation_sign(*c, *d, *b) <= 0
