"""The constrained Delaunay triangulation of a solid given by points and closed loops of segments.

Every edge that is not a segment has its opposite angles sum up to at most π, so the cotangent Laplacian is an M-matrix
and what is harmonic on the triangles obeys the maximum principle.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from fractions import Fraction

import numpy as np
import scipy

from ...errors import InvalidMeshError
from ..arrays import BoolArray, FloatArray, IntArray
from ..predicates import Signs, orientation, orientation_sign
from ..vectors import cross, format_point

FRAME_DISTANCE = 4.0
"""Distance of the auxiliary corners from the centre, in extents of the points; they keep the points off the hull."""

FRAME_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
"""Directions of the auxiliary corners, counter-clockwise."""

DOUBTFUL_ANGLE = 1e-13
"""Radians by which opposite angles must exceed π for an edge to get the exact in-circle test."""


def constrained_delaunay(points: FloatArray, segments: IntArray) -> IntArray:
    """Triangles (T, 3), counter-clockwise, of the region to the left of the segments; valid for any input.

    points: (N, 2), all different; segments: (S, 2) indices, closed loops that neither cross nor pass through a point.
    Points outside the region are left unused. Exact predicates decide on corners; an edge is Delaunay to within
    DOUBTFUL_ANGLE. Raises InvalidMeshError where points coincide or segments cross.
    """
    _check_different(points)
    low, high = points.min(axis=0), points.max(axis=0)
    unit = (points - low) / float((high - low).max())  # powers aside; only Qhull sees these
    framed = np.concatenate((unit, 0.5 + FRAME_DISTANCE * FRAME_CORNERS))
    exact = np.concatenate((points, 0.5 * (low + high) + FRAME_DISTANCE * float((high - low).max()) * FRAME_CORNERS))
    triangles = _delaunay(framed, exact)
    suspects, missing = _suspects(exact, triangles, segments), _missing_segments(triangles, segments, len(exact))
    if len(suspects) or missing.any():
        flips = Flips(exact, triangles)
        flips.legalise(map(tuple, suspects.tolist()))
        flips.constrain(np.concatenate((segments[~missing], segments[missing])))
        triangles = flips.triangles()
    return _left_of(triangles, segments, len(exact))


def _check_different(points: FloatArray) -> None:
    order = np.lexsort((points[:, 1], points[:, 0]))
    same = np.flatnonzero((points[order[1:]] == points[order[:-1]]).all(axis=1))
    if len(same):
        raise InvalidMeshError(
            f"Two points lie at {format_point(points[order[same[0]]])}; remove one of them.",
            code="mesh.repeated_vertex",
            place=points[order[same[0]]],
        )


def _delaunay(framed: FloatArray, exact: FloatArray) -> IntArray:
    """A Delaunay triangulation of the points, up to rounding, that is valid by exact predicates.

    Qhull's where it is valid, which is nearly always; else that of a sweep, flipped.
    """
    try:
        triangles: IntArray = scipy.spatial.Delaunay(framed).simplices.astype(np.int64)
    except scipy.spatial.QhullError:
        triangles = np.zeros((0, 3), dtype=np.int64)
    turn = orientation(*(exact[triangles[:, k]] for k in range(3)))
    triangles[turn < 0, :2] = triangles[turn < 0, 1::-1]
    if _is_valid(triangles, len(exact), turn):
        return triangles
    flips = Flips(exact, _sweep_line_triangles(exact))
    flips.legalise(list(flips.apex))
    return flips.triangles()


def _is_valid(triangles: IntArray, count: int, turn: Signs) -> bool:
    """Whether triangles with exact orientations `turn` tile the frame: Euler's count, each inner edge once each way.

    Without a flat triangle, and with every directed edge once, they cover the frame once.
    """
    if len(triangles) != 2 * (count - 1) - len(FRAME_CORNERS) or not turn.all() or len(np.unique(triangles)) != count:
        return False
    starts, ends = directed_edges(triangles)
    distinct = len(np.unique(starts * count + ends)) == len(starts)
    return distinct and int((opposite_edges(triangles, count) < 0).sum()) == len(FRAME_CORNERS)


def _sweep_line_triangles(points: FloatArray) -> IntArray:
    """Any triangulation (T, 3) of the convex hull of points (N, 2): each sees the hull of those to its left.

    The first two of them, from left to right, are not on a line with the third.
    """
    order = np.lexsort((points[:, 1], points[:, 0])).tolist()
    places = points.tolist()
    a, b, last = order[:3]
    triangles = [(a, last, b)]
    ahead, back = {a: last, last: b, b: a}, {last: a, b: last, a: b}
    for p in order[3:]:
        above, below = last, last
        while orientation_sign(*places[above], *places[ahead[above]], *places[p]) < 0:
            triangles.append((above, p, ahead[above]))
            above = ahead[above]
        while orientation_sign(*places[back[below]], *places[below], *places[p]) < 0:
            triangles.append((back[below], p, below))
            below = back[below]
        ahead[below], back[p], ahead[p], back[above], last = p, below, above, p, p
    return np.array(triangles, dtype=np.int64)


def directed_edges(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """Starts and ends, (3T,) each, of the edges of triangles (T, 3); edge k T + t starts at corner k of triangle t."""
    return triangles.T.ravel(), triangles[:, [1, 2, 0]].T.ravel()


def opposite_edges(triangles: IntArray, count: int) -> IntArray:
    """(3T,) the same edge of the neighbour, for each of the `directed_edges`, -1 at the boundary; count: of points."""
    starts, ends = directed_edges(triangles)
    keys, back = starts * count + ends, ends * count + starts
    order = np.argsort(keys)
    across = order[np.searchsorted(keys, back, sorter=order).clip(max=len(keys) - 1)]
    return np.where(keys[across] == back, across, -1)


def _missing_segments(triangles: IntArray, segments: IntArray, count: int) -> BoolArray:
    """(S,) whether a segment is no edge."""
    starts, ends = directed_edges(triangles)
    return ~np.isin(segments[:, 0] * count + segments[:, 1], starts * count + ends)


def _suspects(points: FloatArray, triangles: IntArray, segments: IntArray) -> IntArray:
    """Inner edges (K, 2) that may fail the in-circle test, by their opposite angles in floating point."""
    starts, ends = directed_edges(triangles)
    across = opposite_edges(triangles, len(points))
    apexes = triangles[:, [2, 0, 1]].T.ravel()
    to_start, to_end = points[starts] - points[apexes], points[ends] - points[apexes]
    angle = np.arctan2(cross(to_start, to_end), (to_start * to_end).sum(axis=1))
    wide = (starts < ends) & (across >= 0) & (angle + angle[across] > np.pi + DOUBTFUL_ANGLE)
    wide &= ~np.isin(starts * len(points) + ends, _both_ways(segments, len(points)))
    return np.stack((starts[wide], ends[wide]), axis=1)


def _both_ways(segments: IntArray, count: int) -> IntArray:
    """(2 S,) keys of segments in their direction, then in the other one."""
    return np.concatenate((segments[:, 0] * count + segments[:, 1], segments[:, 1] * count + segments[:, 0]))


def _left_of(triangles: IntArray, segments: IntArray, count: int) -> IntArray:
    """The triangles that can be reached from the left side of a segment without crossing one."""
    starts, ends = directed_edges(triangles)
    owner, across = np.tile(np.arange(len(triangles)), 3), opposite_edges(triangles, count)
    keys, fixed = starts * count + ends, _both_ways(segments, count)
    joined = (across >= 0) & ~np.isin(keys, fixed)
    links = scipy.sparse.coo_array(
        (np.ones(joined.sum()), (owner[joined], owner[across[joined]])), shape=(len(triangles),) * 2
    )
    piece = scipy.sparse.csgraph.connected_components(links, directed=False)[1]
    seeds = np.unique(piece[owner[np.isin(keys, fixed[: len(segments)])]])
    return triangles[np.isin(piece, seeds)]


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
    """Triangles as a map from each directed edge (u, v) to the corner w on its left, over (N, 2) points.

    Segments after Sloan (constrained Delaunay triangulations, 1993), flips after Lawson (C1 interpolation, 1977).
    """

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

    def constrain(self, segments: IntArray) -> None:
        """Make segments (S, 2) edges that no later flip removes. Raises InvalidMeshError where that is impossible."""
        for a, b in segments.tolist():
            created = [] if (a, b) in self.apex or (b, a) in self.apex else self._recover(a, b)
            self.fixed |= {(a, b), (b, a)}
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
            f"The segment from {format_point(self.points[a])} to {format_point(self.points[b])} meets another one or a "
            f"point at or near {format_point(self.points[on])}; move them apart.",
            code="mesh.crossing",
        )
