"""The convex polygon of least area with k edges around points, at a distance from them.

Every edge of it touches the hull of the points, widened by the distance, so the polygon is given by the directions of
its normals. With the support function h, the tangent with the normal at angle θ is n(θ) · x = h(θ), and between two
tangents that are turned by δ the polygon covers, seen from the origin, the area

    T = (h₁ h₂ - ½ (h₁² + h₂²) cos δ) / sin δ.

The area is the sum of T over the corners, so that the best choice from a finite set of tangents is a shortest cycle
with k edges. All but one of the edges of an optimum are flush with edges of the hull (DePano 1987). Edges that are not
are represented by some tangents at each vertex of the hull, which are then turned until the middle of the edge touches.
With the cheapest cycle through one tangent, the best of all has an edge between each two consecutive ones of it, since
T obeys the quadrangle inequality (Aggarwal, Chang & Yap 1985).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.distance import point_edge
from ...geometry.predicates import orientation_sign
from ...geometry.shortest_cycle import shortest_cycle
from ...geometry.vectors import rotated_left, rotated_right

MAX_TANGENTS = 900
"""Maximum number of candidate tangents; on larger hulls, those that cost least area are left out."""

FREE_TANGENTS = 240
"""Number of candidate tangents that are not flush with an edge, on small hulls."""

MAX_SAMPLES_PER_VERTEX = 40
"""The same at one vertex of the hull."""

SMALLEST_TURN = 1e-9
"""Smallest angle, in radians, between the normals of neighbouring edges, and smallest distance from a half turn."""

MAX_WINDOWS = 8
"""Maximum number of searches around the previous polygon."""

STARTS = 6
"""Number of tangents that first polygons go through: where edges are not flush, several are nearly the best."""

MAX_TURNED, NEARLY = 3, 1.02
"""Maximum number of polygons whose edges are turned, and their largest area relative to the best one."""

MAX_SWEEPS = 20
"""Maximum number of sweeps over all edges."""

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Factor by which an interval shrinks in a step of golden-section search."""

GOLDEN_STEPS = 30
"""Steps of it: intervals are 1e-6 of the first one then, and areas exact to its square."""

NEGLIGIBLE_GAIN = 1e-10
"""Relative gain of area at which a search ends."""


class Wall(NamedTuple):
    """A line that the polygon does not cross."""

    place: FloatArray
    """(2,) a point of the line."""
    normal: FloatArray
    """(2,) unit vector away from the polygon."""


class Tangents(NamedTuple):
    """Lines n · x = h that touch a hull, or keep a distance from it."""

    angle: FloatArray
    """(N,) of the normals n, in radians."""
    support: FloatArray
    """(N,) h, a length."""

    def at(self, which: IntArray) -> Tangents:
        """Some of them, in an order."""
        return Tangents(self.angle[which], self.support[which])


@dataclass(frozen=True, eq=False)
class Hull:
    """The convex hull of points, widened by a distance."""

    corners: FloatArray
    """(h, 2) counter-clockwise, about the origin."""
    angles: FloatArray
    """(h,) of the outward normals of the edges that start at the corners, increasing, over one turn."""
    distance: float
    origin: FloatArray
    """(2,) where the origin is in the coordinates of the points."""
    walls: tuple[Wall, ...] = ()

    @classmethod
    def of(cls, points: FloatArray, distance: float) -> Hull:
        """The hull of points (n, 2), not all on one line."""
        ring = points[convex_hull(points)]
        origin = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
        ring = ring - origin
        normals = rotated_right(np.roll(ring, -1, axis=0) - ring)
        angles = np.unwrap(np.arctan2(normals[:, 1], normals[:, 0]))
        return cls(ring, angles, distance, origin)

    def behind(self, walls: Sequence[Wall]) -> Hull:
        """The hull with walls around it."""
        return replace(self, walls=tuple(Wall(wall.place - self.origin, wall.normal) for wall in walls))

    def tangents(self, angles: FloatArray) -> Tangents:
        """The tangents with normals at angles (N,)."""
        after = np.searchsorted(
            self.angles, self.angles[0] + np.mod(angles - self.angles[0], 2.0 * np.pi), side="right"
        )
        corner = self.corners[after % len(self.corners)]
        support = np.cos(angles) * corner[:, 0] + np.sin(angles) * corner[:, 1] + self.distance
        return Tangents(angles, support)

    @property
    def flush(self) -> FloatArray:
        """Normals of edges, one for those of the same direction but for rounding."""
        turns = np.diff(self.angles, append=self.angles[0] + 2.0 * np.pi)
        angles: FloatArray = self.angles[turns > 10.0 * SMALLEST_TURN]
        return angles

    def candidates(self) -> Tangents:
        """Tangents along edges, or the most important of them, and some at corners, by angle."""
        flush = self.flush
        if len(flush) > MAX_TANGENTS:
            flush = self.reduced(MAX_TANGENTS).angle
        per_corner = min(MAX_SAMPLES_PER_VERTEX, FREE_TANGENTS // len(flush))
        turns = np.diff(flush, append=flush[0] + 2.0 * np.pi)
        parts = (np.arange(per_corner) + 0.5) / max(per_corner, 1)
        free = (flush[:, None] + turns[:, None] * parts).ravel()
        away = np.array([np.arctan2(wall.normal[1], wall.normal[0]) for wall in self.walls])
        angles = flush[0] + np.mod(np.concatenate([flush, free, away]) - flush[0], 2.0 * np.pi)
        return self.tangents(np.unique(angles))

    def reduced(self, count: int) -> Tangents:
        """The tangents along edges without those whose removal adds least area, reduced to a given number."""
        left = self.tangents(self.flush)
        while len(left.angle) > count:
            many = max(1, (len(left.angle) - count) // 4)
            order = np.argsort(self._loss(left), kind="stable")
            taken: list[int] = []
            blocked = np.zeros(len(left.angle), bool)
            for k in order.tolist():
                if len(taken) == many:
                    break
                if not blocked[k]:
                    taken.append(k)
                    blocked[[k - 1, k, (k + 1) % len(blocked)]] = True
            left = left.at(np.delete(np.arange(len(left.angle)), taken))
        return left

    def _loss(self, tangents: Tangents) -> FloatArray:
        """(N,) area added by leaving out each tangent, of all around the hull."""
        before, after = (Tangents(*(np.roll(part, step) for part in tangents)) for step in (1, -1))
        added = self.sector(before, after)
        meet = np.isfinite(added)
        added[meet] -= (self.sector(before, tangents) + self.sector(tangents, after))[meet]
        return added

    def sector(self, one: Tangents, other: Tangents) -> FloatArray:
        """(...,) T between tangents and their successors; infinite where they do not meet or cross a wall."""
        turn = np.mod(other.angle - one.angle, 2.0 * np.pi)
        meet = (turn > SMALLEST_TURN) & (turn < np.pi - SMALLEST_TURN)
        turn = np.where(meet, turn, 1.0)
        sine, cosine = np.sin(turn), np.cos(turn)
        area = (one.support * other.support - 0.5 * cosine * (one.support**2 + other.support**2)) / sine
        if self.walls:
            meet = meet & self._within_walls(corner(one, other))
        return np.where(meet, area, np.inf)

    def _within_walls(self, points: FloatArray) -> BoolArray:
        """(...,) whether points (..., 2) lie on this side of all walls."""
        inside = np.ones(points.shape[:-1], bool)
        for wall in self.walls:
            inside &= (points - wall.place) @ wall.normal < 0.0
        return inside

    def area(self, tangents: Tangents) -> float:
        """Of the polygon of tangents, in their order around the hull."""
        return float(self.sector(tangents, Tangents(*(np.roll(part, -1) for part in tangents))).sum())

    def polygon(self, tangents: Tangents) -> FloatArray:
        """(k, 2) corners of the polygon of tangents, counter-clockwise, in the coordinates of the points."""
        return corner(tangents, Tangents(*(np.roll(part, -1) for part in tangents))) + self.origin


def corner(one: Tangents, other: Tangents) -> FloatArray:
    """(..., 2) where tangents meet."""
    turn = other.angle - one.angle
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (other.support - one.support * np.cos(turn)) / np.sin(turn)
    normal = np.stack([np.cos(one.angle), np.sin(one.angle)], axis=-1)
    meeting: FloatArray = one.support[..., None] * normal + along[..., None] * rotated_left(normal)
    return meeting


def least_polygon(hull: Hull, count: int) -> Tangents | None:
    """The polygon of least area with ``count`` edges around a hull; None where walls leave none."""
    candidates = hull.candidates()
    costs = hull.sector(Tangents(*(part[:, None] for part in candidates)), candidates)
    found: dict[bytes, tuple[float, IntArray]] = {}
    for start in np.unique(np.linspace(0, len(costs), STARTS, endpoint=False).astype(np.int64)).tolist():
        cycle = _through(costs, start, count)
        if cycle is not None:
            area, cycle = _improved(costs, cycle)
            found[np.sort(cycle).tobytes()] = area, cycle
    best = sorted(found.values(), key=lambda each: each[0])
    turned = [_turned(hull, candidates.at(cycle)) for area, cycle in best[:MAX_TURNED] if area <= NEARLY * best[0][0]]
    return min(turned, key=hull.area, default=None)


def _improved(costs: FloatArray, cycle: IntArray) -> tuple[float, IntArray]:
    """The cheapest cycle between the tangents of another one, then around those found; and its cost."""
    area = np.inf
    for number in range(MAX_WINDOWS):
        better = _in_windows(costs, cycle if number == 0 else _middles(cycle, len(costs)))
        if better is None:
            break
        smaller = float(costs[better, np.roll(better, -1)].sum())
        if smaller >= area * (1.0 - NEGLIGIBLE_GAIN):
            break
        cycle, area = better, smaller
    return area, cycle


def _through(costs: FloatArray, start: int, count: int) -> IntArray | None:
    """(count,) the cheapest cycle through one tangent, once around; None if there is none."""
    size = len(costs)
    order = (start + np.arange(size)) % size
    ahead = np.triu(np.ones((size, size), bool), 1)
    forward = np.where(ahead, costs[np.ix_(order, order)], np.inf)
    least = np.full(size, np.inf)
    least[0] = 0.0
    back: list[IntArray] = []
    for _ in range(count - 1):
        through = least[:, None] + forward
        back.append(through.argmin(axis=0))
        least = through.min(axis=0)
    closing = least + costs[order, start]
    place = int(closing.argmin())
    if not np.isfinite(closing[place]):
        return None
    cycle = [place]
    for before in back[::-1]:
        place = int(before[place])
        cycle.append(place)
    places: IntArray = order[np.array(cycle[::-1])]
    return places


def _in_windows(costs: FloatArray, bounds: IntArray) -> IntArray | None:
    """(k,) the cheapest cycle with one tangent from each window between consecutive bounds (k,), both included."""
    size = len(costs)
    widths = np.mod(np.roll(bounds, -1) - bounds, size)
    windows = [(begin + np.arange(width + 1)) % size for begin, width in zip(bounds.tolist(), widths, strict=True)]
    picked = shortest_cycle(
        [costs[np.ix_(one, other)] for one, other in zip(windows, [*windows[1:], windows[0]], strict=True)]
    )
    if picked is None:
        return None
    return np.array([window[k] for window, k in zip(windows, picked, strict=True)])


def _middles(cycle: IntArray, size: int) -> IntArray:
    """(k,) half-way from each tangent of a cycle to the one before."""
    before = np.roll(cycle, 1)
    return np.asarray(np.mod(before + np.mod(cycle - before, size) // 2, size), np.int64)


def _turned(hull: Hull, tangents: Tangents) -> Tangents:
    """The polygon with edges turned one by one, as long as the area shrinks."""
    angles = tangents.angle.copy()
    breaks = np.unique(np.mod(hull.flush, 2.0 * np.pi))
    for _ in range(MAX_SWEEPS):
        before = hull.area(hull.tangents(angles))
        for k in range(len(angles)):
            if not _rests(hull, hull.tangents(angles), k):
                angles[k] = _best_turn(hull, angles, k, breaks)
        after = hull.area(hull.tangents(angles))
        if before - after <= NEGLIGIBLE_GAIN * before:
            break
    return hull.tangents(angles)


def _rests(hull: Hull, tangents: Tangents, k: int) -> bool:
    """Whether the middle of an edge lies on an edge of the offset hull, so that turning it costs area."""
    around = tangents.at(np.array([k - 1, k, (k + 1) % len(tangents.angle)]))
    ends = corner(around.at(np.array([0, 1])), around.at(np.array([1, 2])))
    normal = np.array([np.cos(around.angle[1]), np.sin(around.angle[1])])
    touching = np.abs(hull.corners @ normal + hull.distance - around.support[1]) <= 1e-12 * np.abs(around.support[1])
    along = hull.corners[touching] @ rotated_left(normal)
    middle = 0.5 * (ends[0] + ends[1]) @ rotated_left(normal)
    return len(along) > 1 and bool(along.min() <= middle <= along.max())


def _best_turn(hull: Hull, angles: FloatArray, k: int, breaks: FloatArray) -> float:
    """The angle of edge k, at the corners of the hull that it touches, with the least area between its neighbours."""
    before, after = angles[k - 1], angles[(k + 1) % len(angles)]
    neighbours = hull.tangents(np.array([before, after]))

    def area(angle: FloatArray) -> FloatArray:
        turned = hull.tangents(np.asarray(angle))
        one = Tangents(neighbours.angle[:1], neighbours.support[:1])
        other = Tangents(neighbours.angle[1:], neighbours.support[1:])
        return hull.sector(one, turned) + hull.sector(turned, other)

    here = float(angles[k])
    distance = np.mod(breaks - here, 2.0 * np.pi)
    ahead = here + distance[distance > SMALLEST_TURN].min()
    behind = here - np.mod(-distance, 2.0 * np.pi)[distance > SMALLEST_TURN].min()
    behind = max(behind, here - np.mod(here - before, 2.0 * np.pi) + 2.0 * SMALLEST_TURN)
    ahead = min(ahead, here + np.mod(after - here, 2.0 * np.pi) - 2.0 * SMALLEST_TURN)
    low, high = np.array([behind, here]), np.array([here, ahead])
    tried = [low.copy(), high.copy()]
    for _ in range(GOLDEN_STEPS):
        one, other = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        left = area(one) < area(other)
        low, high = np.where(left, low, one), np.where(left, other, high)
    places = np.concatenate([[here], *tried, 0.5 * (low + high)])
    return float(places[area(places).argmin()])


def convex_hull(points: FloatArray) -> IntArray:
    """(h,) the corners of the convex hull of points (n, 2), counter-clockwise, by exact predicates (Andrew 1979)."""
    order = np.lexsort((points[:, 1], points[:, 0])).tolist()
    x, y = points[:, 0].tolist(), points[:, 1].tolist()
    halves = []
    for walk in (order, order[::-1]):
        half: list[int] = []
        for k in walk:
            while (
                len(half) > 1 and orientation_sign(x[half[-2]], y[half[-2]], x[half[-1]], y[half[-1]], x[k], y[k]) <= 0
            ):
                half.pop()
            half.append(k)
        halves += half[:-1]
    return np.array(halves, dtype=np.int64)


def shortest_way(one: FloatArray, other: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The closest points (2,), (2,) of two convex polygons (h, 2) that are apart."""
    best: tuple[float, FloatArray, FloatArray] = (np.inf, one[0], other[0])
    for swapped, (points, ring) in enumerate(((one, other), (other, one))):
        ends = np.roll(ring, -1, axis=0)
        near = point_edge(points[:, None], ring[None], ends[None])
        i, j = np.unravel_index(int(near.distance.argmin()), near.distance.shape)
        if near.distance[i, j] < best[0]:
            met = ring[j] + near.parameter[i, j] * (ends[j] - ring[j])
            best = (float(near.distance[i, j]), *((met, points[i]) if swapped else (points[i], met)))
    return best[1], best[2]
