"""Geometric impulses, one pair after the other (Brochu & Bridson 2009, section 4; after Bridson et al. 2002).

An impulse of size i along the unit normal n changes the velocities of a point and of the ends of an edge by

    i s / w · n  over  Σ s² / w,    s = (1, -(1 - t), -t),

with the masses w: 1 for the cage, infinite for the fine mesh. First, pairs closer than the proximity are pushed apart
gently. Then every collision loses its relative normal velocity, and the pairs of the vertices that were moved are
tested again, until none collides or the budget of tests is used up.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np

from nestedcages_core.contact.ccd import HIT_DISTANCE, impacts
from nestedcages_core.contact.pairs import Pairs
from nestedcages_core.geometry.arrays import TINY, FloatArray, IntArray
from nestedcages_core.geometry.precision import NEGLIGIBLE

SEPARATION_RATE = 0.1
"""Fraction of the missing distance by which a pair may separate in a step."""

PROXIMITY_STIFFNESS = 10.0
"""Largest impulse of a pair that is too close, per missing distance and time."""

TESTS_PER_CANDIDATE = 5
"""Budget of tests, per pair in the list when the first pass is over."""

COLLISION_DISTANCE = 1e-6
"""Distance, in bounding-box diagonals, below which a point has met an edge."""

Vector = tuple[float, float]

PROJECTION = 0.8
"""β: the part of the change that is made before collisions are detected again."""

MAX_PROJECTIONS = 20
"""Cap on the projections of one zone."""

MAX_ROUNDS = 50
"""Cap on the rounds in which zones grow; the original has none."""

UNSOLVED = 1e-6
"""Relative normal velocity left, relative to the largest one, from which a zone counts as unsolvable."""


@dataclass(frozen=True)
class Impulses:
    """Filters velocities of cage vertices, the first m of all."""

    pairs: Pairs
    """All pairs that can meet in the step."""
    m: int
    proximity: float
    """Distance below which pairs are pushed apart; a length."""

    def apart(self, x: FloatArray, v: FloatArray, time: float) -> FloatArray:
        """Velocities (m + n, 2) after the impulses of all pairs that are too close at x, in a step of length time."""
        found = self.pairs.measure(x)
        close = self._ordered(np.flatnonzero(found.distance < self.proximity))
        if not close:
            return v
        velocity = [(a, b) for a, b in v.tolist()]
        for k in close:
            missing = self.proximity - float(found.distance[k])
            n, t = (float(found.normal[k, 0]), float(found.normal[k, 1])), float(found.parameter[k])
            corners = self._corners(k)
            relative = _along(n, t, *(velocity[i] for i in corners))
            separation = SEPARATION_RATE * missing / time
            if relative <= separation:
                size = min(separation - relative, time * PROXIMITY_STIFFNESS * missing)
                self._push(velocity, corners, n, t, size)
        return np.array(velocity)

    def collisions(self, x: FloatArray, v: FloatArray, time: float) -> tuple[FloatArray, bool]:
        """Velocities (m + n, 2) after the impulses of all collisions, and whether none is left."""
        distance = self.pairs.measure(x).distance
        hits, _ = impacts(self.pairs, x, time * v, distance, COLLISION_DISTANCE / HIT_DISTANCE)
        if len(hits) == 0:
            return v, True
        velocity = [(a, b) for a, b in v.tolist()]
        position = [(a, b) for a, b in x.tolist()]
        incident = self._incident()

        def handle(k: int) -> list[int]:
            """The pairs to test again after pair k."""
            corners = self._corners(k)
            p_v, a_v, b_v = ((time * velocity[i][0], time * velocity[i][1]) for i in corners)
            p, a, b = (position[i] for i in corners)
            met = meeting(p, a, b, p_v, a_v, b_v, float(distance[k]))
            if met is None:
                return []
            n, t = met
            relative = _along(n, t, *(velocity[i] for i in corners))
            if relative >= 0.0:
                return []
            self._push(velocity, corners, n, t, -relative)
            return [other for vertex in corners if vertex < self.m for other in incident(vertex)]

        again: set[int] = set()
        for k in self._ordered(hits):
            again.update(handle(k))
        queue = deque(sorted(again))
        for _ in range(TESTS_PER_CANDIDATE * len(queue)):
            if not queue:
                break
            queue.extend(handle(queue.popleft()))
        return np.array(velocity), not queue

    def _ordered(self, chosen: IntArray) -> list[int]:
        """Pairs in El Topo's order: first the vertices of the cage with the fine mesh, then its edges with all."""
        first = (self.pairs.point[chosen] < self.m) & (self.pairs.start[chosen] >= self.m)
        ordered: list[int] = np.concatenate([chosen[first], chosen[~first]]).tolist()
        return ordered

    def _corners(self, k: int) -> tuple[int, int, int]:
        return int(self.pairs.point[k]), int(self.pairs.start[k]), int(self.pairs.end[k])

    def _incident(self) -> Callable[[int], list[int]]:
        """Lookup of the pairs that a vertex is part of."""
        corners = self.pairs.corners
        known: dict[int, list[int]] = {}

        def of(vertex: int) -> list[int]:
            if vertex not in known:
                known[vertex] = np.flatnonzero((corners == vertex).any(axis=1)).tolist()
            return known[vertex]

        return of

    def _push(self, velocity: list[Vector], corners: tuple[int, int, int], n: Vector, t: float, size: float) -> None:
        """Change the velocities of a pair by an impulse."""
        shares = (1.0, t - 1.0, -t)
        inverse = sum(s * s for s, i in zip(shares, corners, strict=True) if i < self.m)
        if inverse <= TINY:
            return
        for s, i in zip(shares, corners, strict=True):
            if i < self.m:
                change = size * s / inverse
                velocity[i] = velocity[i][0] + change * n[0], velocity[i][1] + change * n[1]


def _along(n: Vector, t: float, p: Vector, a: Vector, b: Vector) -> float:
    """Component along n of p relative to the point t of the edge a-b."""
    return n[0] * (p[0] - (1.0 - t) * a[0] - t * b[0]) + n[1] * (p[1] - (1.0 - t) * a[1] - t * b[1])


def meeting(
    p: Vector, a: Vector, b: Vector, p_v: Vector, a_v: Vector, b_v: Vector, distance: float
) -> tuple[Vector, float] | None:
    """Unit normal, towards the side that the point comes from, and parameter at the first time in (0, 1] at which a
    moving point meets a moving edge; None where it does not. A scalar :func:`nestedcages_core.contact.ccd.impacts`."""
    if hypot(*p_v) + max(hypot(*a_v), hypot(*b_v)) < (1.0 - NEGLIGIBLE) * distance:
        return None
    near = min(HIT_DISTANCE * distance, COLLISION_DISTANCE)
    e, e_v = (b[0] - a[0], b[1] - a[1]), (b_v[0] - a_v[0], b_v[1] - a_v[1])
    d, d_v = (p[0] - a[0], p[1] - a[1]), (p_v[0] - a_v[0], p_v[1] - a_v[1])
    c0 = e[0] * d[1] - e[1] * d[0]
    c1 = e[0] * d_v[1] - e[1] * d_v[0] + e_v[0] * d[1] - e_v[1] * d[0]
    c2 = e_v[0] * d_v[1] - e_v[1] * d_v[0]
    discriminant = c1 * c1 - 4.0 * c0 * c2
    if discriminant < 0.0:
        return None
    root = sqrt(discriminant)
    q = -0.5 * (c1 + root if c1 >= 0.0 else c1 - root)
    times = sorted(s for s in (q / c2 if c2 else 2.0, c0 / q if q else 2.0) if 0.0 < s <= 1.0)
    for s in times:
        edge = e[0] + s * e_v[0], e[1] + s * e_v[1]
        to = d[0] + s * d_v[0], d[1] + s * d_v[1]
        squared = max(edge[0] ** 2 + edge[1] ** 2, TINY)
        t = min(max((edge[0] * to[0] + edge[1] * to[1]) / squared, 0.0), 1.0)
        if hypot(to[0] - t * edge[0], to[1] - t * edge[1]) < near:
            length = sqrt(squared)
            side = 1.0 if c0 >= 0.0 else -1.0
            return (-side * edge[1] / length, side * edge[0] / length), t
    return None


@dataclass
class _Zone:
    """Collisions that share vertices: pair -> (normal, parameter)."""

    collisions: dict[int, tuple[Vector, float]]
    vertices: set[int]
    solved: bool = False


@dataclass(frozen=True)
class InelasticZones:
    """Inelastic impact zones (Harmon et al. 2008, section 4; Brochu & Bridson 2009): equalities, zone by zone.

    Collisions that share a vertex form a zone. A zone loses the relative normal velocities J v of all its collisions at
    once, by the smallest change of the velocities of the cage that does so,

        v ← v - β Jᵀ (J Jᵀ)⁻¹ J v,

    and its collisions are detected again. New collisions enlarge zones, which begin again with the velocities before,
    until there are no collisions. Where a zone has more collisions than unknowns, no velocity may satisfy all of them,
    and it fails. The equalities also hold back pairs that could separate.
    """

    pairs: Pairs
    m: int

    def nearest(self, x: FloatArray, v: FloatArray, time: float) -> tuple[FloatArray | None, int]:
        """Velocities (m + n, 2) without a collision in a step of length time, None if there are none, and the number
        of systems solved."""
        distance = self.pairs.measure(x).distance
        velocity, zones, systems = v.copy(), list[_Zone](), 0
        for _ in range(MAX_ROUNDS):
            known = {k for zone in zones for k in zone.collisions}
            found = [k for k in self._candidates(x, velocity, time, distance) if k not in known]
            hits = {k: met for k in found if (met := self._meeting(k, x, velocity, time, distance)) is not None}
            if not hits:
                return velocity, systems
            zones = self._merged(zones, hits)
            for zone in zones:
                if zone.solved:
                    continue
                touched = np.array(sorted(zone.vertices))
                velocity[touched] = v[touched]
                count = self._project(zone, x, velocity, time, distance)
                systems += count
                zone.solved = count > 0
                if not zone.solved:
                    return None, systems
        return None, systems

    def _candidates(self, x: FloatArray, velocity: FloatArray, time: float, distance: FloatArray) -> list[int]:
        """Pairs that are fast enough to meet."""
        speed = time * np.hypot(velocity[:, 0], velocity[:, 1])
        fast: list[int] = np.flatnonzero(self.pairs.approach(speed) >= distance - COLLISION_DISTANCE).tolist()
        return fast

    def _meeting(
        self, k: int, x: FloatArray, velocity: FloatArray, time: float, distance: FloatArray
    ) -> tuple[Vector, float] | None:
        corners = [self.pairs.point[k], self.pairs.start[k], self.pairs.end[k]]
        places = [(float(x[i, 0]), float(x[i, 1])) for i in corners]
        motions = [(time * float(velocity[i, 0]), time * float(velocity[i, 1])) for i in corners]
        return meeting(places[0], places[1], places[2], motions[0], motions[1], motions[2], float(distance[k]))

    def _merged(self, zones: list[_Zone], hits: dict[int, tuple[Vector, float]]) -> list[_Zone]:
        """The zones with new collisions, joined where they share a vertex."""
        for k, met in hits.items():
            new = _Zone({k: met}, {int(self.pairs.point[k]), int(self.pairs.start[k]), int(self.pairs.end[k])})
            apart = []
            for zone in zones:
                if zone.vertices & new.vertices:
                    new.collisions |= zone.collisions
                    new.vertices |= zone.vertices
                else:
                    apart.append(zone)
            zones = [*apart, new]
        return zones

    def _project(self, zone: _Zone, x: FloatArray, velocity: FloatArray, time: float, distance: FloatArray) -> int:
        """Change the velocities of a zone until none of its collisions is left; the number of projections, or 0 if it
        fails."""
        for count in range(1, MAX_PROJECTIONS + 1):
            rows, cage = self._rows(zone)
            vertices = np.array(sorted(zone.vertices))
            rate = rows @ velocity[vertices].ravel()
            columns = np.flatnonzero(np.repeat(vertices < self.m, 2))
            change = np.linalg.lstsq(rows[:, columns], rate, rcond=1e-12)[0]
            left = np.abs(rate - rows[:, columns] @ change).max()
            if left > UNSOLVED * max(float(np.abs(rate).max()), COLLISION_DISTANCE):
                return 0
            velocity[cage] -= PROJECTION * change.reshape(-1, 2)
            again = {k: self._meeting(k, x, velocity, time, distance) for k in zone.collisions}
            still = {k: met for k, met in again.items() if met is not None}
            if not still:
                return count
            zone.collisions |= still
        return 0

    def _rows(self, zone: _Zone) -> tuple[FloatArray, IntArray]:
        """(K, 2 V) the relative normal velocities of the collisions as rows over the zone's vertices, in order, and
        which of these are of the cage."""
        vertices = sorted(zone.vertices)
        place = {vertex: i for i, vertex in enumerate(vertices)}
        rows = np.zeros((len(zone.collisions), 2 * len(vertices)))
        for row, (k, (n, t)) in zip(rows, zone.collisions.items(), strict=True):
            corners = self.pairs.point[k], self.pairs.start[k], self.pairs.end[k]
            for vertex, share in zip(corners, (1.0, t - 1.0, -t), strict=True):
                i = 2 * place[int(vertex)]
                row[i : i + 2] += share * n[0], share * n[1]
        return rows, np.array([vertex for vertex in vertices if vertex < self.m])
