"""Inelastic impact zones (Harmon et al. 2008, section 4; Brochu & Bridson 2009): equalities, zone by zone.

Collisions that share a vertex form a zone. A zone loses the relative normal velocities J v of all its collisions at
once, by the smallest change of the velocities of the cage that does so,

    v ← v - β Jᵀ (J Jᵀ)⁻¹ J v,

and its collisions are detected again. New collisions enlarge zones, which begin again with the velocities before, until
there are no collisions. Where a zone has more collisions than unknowns, no velocity may satisfy all of them, and it
fails. The equalities also hold back pairs that could separate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...contact.pairs import Pairs
from ...geometry.arrays import FloatArray, IntArray
from .impulses import COLLISION_DISTANCE, Vector, meeting

PROJECTION = 0.8
"""β: the part of the change that is made before collisions are detected again."""

MAX_PROJECTIONS = 20
"""Cap on the projections of one zone."""

MAX_ROUNDS = 50
"""Cap on the rounds in which zones grow; the original has none."""

UNSOLVED = 1e-6
"""Relative normal velocity left, relative to the largest one, from which a zone counts as unsolvable."""


@dataclass
class _Zone:
    """Collisions that share vertices: pair -> (normal, parameter)."""

    collisions: dict[int, tuple[Vector, float]]
    vertices: set[int]
    solved: bool = False


@dataclass(frozen=True)
class InelasticZones:
    """Filters velocities of cage vertices, the first m of all."""

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
