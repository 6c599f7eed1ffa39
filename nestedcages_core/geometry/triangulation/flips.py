"""A triangulation that is changed by edge flips, with exact predicates: recover segments, restore Delaunay.

Segments after S. W. Sloan, A fast algorithm for generating constrained Delaunay triangulations (1993); flips after
C. L. Lawson, Software for C1 surface interpolation (1977).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from fractions import Fraction

import numpy as np

from ...errors import InvalidMeshError
from ..arrays import FloatArray, IntArray
from ..predicates import orientation_sign
from ..vectors import place

CIRCLE_BOUND = (10.0 + 96.0 * 2.0**-53) * 2.0**-53
"""Relative error of the in-circle determinant of rounded differences (Shewchuk 1997, section 4.3, bound A)."""

MIN_CIRCLE_TERM = 1e-290
"""Sums of in-circle terms below this may have lost digits to underflow: the sign is computed exactly."""

Point = tuple[float, float]
Edge = tuple[int, int]


def circle_sign(a: Point, b: Point, c: Point, d: Point) -> int:
    """1 if d is inside the circle through the counter-clockwise a, b, c, -1 if outside, 0 if on it; exact."""
    ax, ay, bx, by, cx, cy = a[0] - d[0], a[1] - d[1], b[0] - d[0], b[1] - d[1], c[0] - d[0], c[1] - d[1]
    bc, cb, ca, ac, ab, ba = bx * cy, cx * by, cx * ay, ax * cy, ax * by, bx * ay
    a2, b2, c2 = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    determinant = a2 * (bc - cb) + b2 * (ca - ac) + c2 * (ab - ba)
    size = a2 * (abs(bc) + abs(cb)) + b2 * (abs(ca) + abs(ac)) + c2 * (abs(ab) + abs(ba))
    bound = CIRCLE_BOUND * size
    if MIN_CIRCLE_TERM < size < float("inf") and abs(determinant) > bound:
        return 1 if determinant > 0.0 else -1
    rows = [[Fraction(x) - Fraction(y) for x, y in zip(point, d, strict=True)] for point in (a, b, c)]
    (ux, uy), (vx, vy), (wx, wy) = rows
    exact = (
        (ux * ux + uy * uy) * (vx * wy - wx * vy)
        + (vx * vx + vy * vy) * (wx * uy - ux * wy)
        + (wx * wx + wy * wy) * (ux * vy - vx * uy)
    )
    return (exact > 0) - (exact < 0)


class Flips:
    """Triangles as a map from each directed edge (u, v) to the corner w on its left, over (N, 2) points."""

    def __init__(self, points: FloatArray, triangles: IntArray) -> None:
        """triangles: (T, 3), counter-clockwise, a valid triangulation of a convex region."""
        self.points: list[Point] = [(x, y) for x, y in points.tolist()]
        self.apex: dict[Edge, int] = {}
        self.fixed: set[Edge] = set()
        self._a_neighbour: dict[int, int] = {}
        for u, v, w in triangles.tolist():
            self._add(u, v, w)

    def triangles(self) -> IntArray:
        """(T, 3) corners, counter-clockwise, each triangle from its smallest corner."""
        own = [(u, v, w) for (u, v), w in self.apex.items() if u < v and u < w]
        return np.array(own, dtype=np.int64).reshape(-1, 3)

    def insert(self, vertices: Iterable[int]) -> None:
        """Add points to the triangulation, one by one, keeping it Delaunay."""
        hint = next(iter(self.apex))
        for p in vertices:
            hint = self._insert(p, hint)

    def constrain(self, segments: IntArray) -> None:
        """Make segments (S, 2) edges that no later flip removes. Raises InvalidMeshError where that is impossible."""
        for a, b in segments.tolist():
            created = [] if (a, b) in self.apex or (b, a) in self.apex else self._recover(a, b)
            self.fixed.add((a, b))
            self.fixed.add((b, a))
            self.legalise(created)

    def legalise(self, edges: Iterable[Edge]) -> None:
        """Flip until these edges and all others touched are locally Delaunay."""
        stack = list(edges)
        while stack:
            u, v = stack.pop()
            if (u, v) in self.fixed:
                continue
            w, z = self.apex.get((u, v)), self.apex.get((v, u))
            if w is None or z is None:
                continue
            points = self.points
            if circle_sign(points[u], points[v], points[w], points[z]) > 0:
                self._flip(u, v, w, z)
                stack += [(u, z), (z, v), (v, w), (w, u)]

    def _side(self, a: int, b: int, c: int) -> int:
        """1 if c is to the left of a -> b, -1 to the right, 0 on the line."""
        return orientation_sign(*self.points[a], *self.points[b], *self.points[c])

    def _add(self, u: int, v: int, w: int) -> None:
        self.apex[u, v] = w
        self.apex[v, w] = u
        self.apex[w, u] = v
        self._a_neighbour[u], self._a_neighbour[v], self._a_neighbour[w] = v, w, u

    def _flip(self, u: int, v: int, w: int, z: int) -> None:
        """Replace the edge u-v between corners w (left) and z (right) by z-w."""
        del self.apex[u, v], self.apex[v, u]
        self._add(z, w, u)
        self._add(w, z, v)

    def _recover(self, a: int, b: int) -> list[Edge]:
        """Make a-b an edge; the edges that this created."""
        crossing = deque(self._crossed(a, b))
        created: list[Edge] = []
        while crossing:
            u, v = crossing.popleft()
            w, z = self.apex[u, v], self.apex[v, u]
            if self._side(z, w, u) <= 0 or self._side(z, w, v) >= 0:  # the quadrilateral u z v w is not convex
                crossing.append((u, v))
                continue
            self._flip(u, v, w, z)
            if z not in (a, b) and w not in (a, b) and self._side(a, b, z) != self._side(a, b, w):
                crossing.append((z, w))
            else:
                created.append((z, w))
        return created

    def _crossed(self, a: int, b: int) -> Iterator[Edge]:
        """The edges that the open segment a-b crosses, from a on, each with a on its left."""
        right, left = next((u, v) for u, v in self._around(a) if self._side(a, u, b) >= 0 > self._side(a, v, b))
        if self._side(a, right, b) == 0:
            self._refuse(a, b, right)
        while True:
            if (right, left) in self.fixed:
                self._refuse(a, b, right)
            yield right, left
            corner = self.apex[left, right]
            if corner == b:
                return
            side = self._side(a, b, corner)
            if side == 0:
                self._refuse(a, b, corner)
            right, left = (right, corner) if side > 0 else (corner, left)

    def _around(self, a: int) -> Iterator[Edge]:
        """The edges opposite to a, counter-clockwise; a lies inside the triangulated region."""
        first = u = self._a_neighbour[a]
        while True:
            v = self.apex[a, u]
            yield u, v
            u = v
            if u == first:
                return

    def _refuse(self, a: int, b: int, on: int) -> None:
        raise InvalidMeshError(
            f"The segment from {place(self.points[a])} to {place(self.points[b])} meets another one or a point "
            f"at or near {place(self.points[on])}; move them apart.",
            code="mesh.crossing",
        )

    def _insert(self, p: int, start: Edge) -> Edge:
        """Add one point; an edge near it, where the search for the next may start."""
        u, v = self._triangle_around(p, start)
        w = self.apex[u, v]
        for s, t, r in ((u, v, w), (v, w, u), (w, u, v)):
            if self._side(s, t, p) == 0:  # on the edge s-t: split both triangles next to it
                beyond = self.apex[t, s]
                del self.apex[s, t], self.apex[t, s]
                for x, y in ((t, r), (r, s), (s, beyond), (beyond, t)):
                    self._add(x, y, p)
                self.legalise([(t, r), (r, s), (s, beyond), (beyond, t)])
                return p, self._a_neighbour[p]
        for x, y in ((u, v), (v, w), (w, u)):
            self._add(x, y, p)
        self.legalise([(u, v), (v, w), (w, u)])
        return p, self._a_neighbour[p]

    def _triangle_around(self, p: int, start: Edge) -> Edge:
        """An edge of the triangle that contains p, by walking there."""
        u, v = start if self._side(*start, p) >= 0 else start[::-1]
        while True:
            w = self.apex[u, v]
            if self._side(v, w, p) < 0:
                u, v = w, v
            elif self._side(w, u, p) < 0:
                u, v = u, w
            else:
                return u, v
