"""A loop in units of its size, areas between it and chords, and what rays from its convex vertices meet first."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

FULL = 2.0 * np.pi
SAME_ANGLE = 1e-13
"""Radians between two vertices, seen from a third, below which rays between them are not tried."""
WIDER = 1e-10
"""By how many radians all intervals of directions are widened."""
FARTHER = 1e-7
"""By which fraction what a ray reaches is raised."""
LOWER = 1e-9
"""By how much all areas are lowered, in units of the squared size; also a length, in units of the size."""
PARALLEL = 1e-11
"""Cross product of a direction and an edge below which no point of intersection is computed."""


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products of vectors (…, 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def direction(angle: np.ndarray) -> np.ndarray:
    """Unit vectors (…, 2)."""
    return np.stack((np.cos(angle), np.sin(angle)), axis=-1)


def ranges(first: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row and value of all of first … end - 1, row by row."""
    count = np.maximum(end - first, 0)
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)


class Sight(NamedTuple):
    """Intervals of directions from convex vertices within which rays first meet one edge, or none (-1)."""

    vertex: np.ndarray
    low: np.ndarray
    """Angles from the direction of the edge before the vertex."""
    high: np.ndarray
    edge: np.ndarray

    @property
    def key(self) -> np.ndarray:
        """Sorted by vertex and angle; angles are below 4."""
        return 4.0 * self.vertex + self.low


class Seen(NamedTuple):
    """What cells of directions see: pieces of edges, and the farthest that a ray of each cell comes."""

    cell: np.ndarray
    edge: np.ndarray
    low: np.ndarray
    """Parameters of edges."""
    high: np.ndarray
    reach: np.ndarray
    """For each cell."""


class Outline:
    """A simple loop (n, 2), counter-clockwise."""

    def __init__(self, points: np.ndarray) -> None:
        self.size = float(np.hypot(*np.ptp(points, axis=0)))
        self.points = (points - points.mean(axis=0)) / self.size
        self.edges = np.roll(self.points, -1, axis=0) - self.points
        triangles = 0.5 * cross(self.points, np.roll(self.points, -1, axis=0))
        self.swept = np.concatenate(([0.0], np.cumsum(triangles)))
        self.area = float(self.swept[-1])
        heading = np.arctan2(self.edges[:, 1], self.edges[:, 0])
        self.before = np.roll(heading, 1)
        """Direction of the edge before each vertex."""
        self.turn = (heading - self.before + np.pi) % FULL - np.pi
        self.turned = np.cumsum(self.turn) - self.turn
        """Sum of the turns before each vertex."""
        self.convex = np.flatnonzero(self.turn > 0.0)
        self.sights = self._sight(0.0), self._sight(np.pi)

    def __len__(self) -> int:
        return len(self.points)

    def on(self, edge: np.ndarray, parameter: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (k, 2) of edges, and the area swept about the origin from vertex 0 along the outline to them."""
        points = self.points[edge] + parameter[:, None] * self.edges[edge]
        return points, self.swept[edge] + 0.5 * cross(self.points[edge], points)

    def pocket(
        self, a: np.ndarray, swept_a: np.ndarray, b: np.ndarray, swept_b: np.ndarray, wraps: np.ndarray
    ) -> np.ndarray:
        """Area to the left of chords a-b (k, 2) and outside the outline; wraps: whether they pass vertex 0."""
        return np.asarray(0.5 * cross(a, b) - (swept_b - swept_a + wraps * self.area))

    def _sight(self, back: float) -> Sight:
        vertices, lows, highs, edges = [], [], [], []
        for a in self.convex:
            away, turn = self.points - self.points[a], self.turn[a]
            seen = (np.arctan2(away[:, 1], away[:, 0]) - back - self.before[a]) % FULL
            seen[a] = FULL
            bounds = np.unique(np.concatenate(([0.0], seen[seen < turn], [turn])))
            bounds = bounds[np.concatenate(([True], np.diff(bounds) > SAME_ANGLE))]
            bounds = bounds if len(bounds) > 1 else np.array([0.0, turn])
            ray = direction(self.before[a] + back + 0.5 * (bounds[1:] + bounds[:-1]))[:, None]
            with np.errstate(all="ignore"):
                sine = cross(ray, self.edges[None])
                far, parameter = cross(away, self.edges)[None] / sine, cross(away[None], ray) / sine
            met = (far > 0.0) & (parameter >= -PARALLEL) & (parameter <= 1.0 + PARALLEL)
            met[:, [a - 1, a]] = False
            far = np.where(met, far, np.inf)
            vertices.append(np.full(len(bounds) - 1, a))
            lows.append(bounds[:-1])
            highs.append(bounds[1:])
            edges.append(np.where(np.isfinite(far.min(axis=1)), far.argmin(axis=1), -1))
        return Sight(*map(np.concatenate, (vertices, lows, highs, edges)))

    def seen(self, ahead: bool, vertex: np.ndarray, low: np.ndarray, high: np.ndarray) -> Seen:
        """What rays from vertices, in intervals of directions, meet first: ahead along an edge of a cage, or behind."""
        sight = self.sights[0 if ahead else 1]
        back = 0.0 if ahead else np.pi
        first = np.searchsorted(sight.key, 4.0 * vertex + low - SAME_ANGLE, "right") - 1
        first = np.maximum(first, np.searchsorted(sight.vertex, vertex))
        end = np.searchsorted(sight.key, 4.0 * vertex + high + SAME_ANGLE)
        end = np.clip(end, first + 1, np.searchsorted(sight.vertex, vertex, "right"))
        cell, piece = ranges(first, end)
        edge, origin = sight.edge[piece], self.points[vertex[cell]]
        to = self.points[edge] - origin
        farthest = np.maximum(np.hypot(*to.T), np.hypot(*(to + self.edges[edge]).T))
        ends, reaches = [], []
        for angle, otherwise in ((np.maximum(sight.low[piece], low[cell]), 0.0),
                                 (np.minimum(sight.high[piece], high[cell]), 1.0)):  # fmt: skip
            ray = direction(self.before[vertex[cell]] + angle + back)
            with np.errstate(all="ignore"):
                sine = cross(ray, self.edges[edge])
                parameter, far = cross(to, ray) / sine, cross(to, self.edges[edge]) / sine
            grazing = ~(np.abs(sine) > PARALLEL)
            ends.append(np.where(grazing, otherwise, np.clip(parameter, 0.0, 1.0)))
            reaches.append(np.where(grazing | (far < 0.0) | (far > farthest), farthest, far))
        reach = np.zeros(len(vertex))
        np.maximum.at(reach, cell, np.where(edge < 0, np.inf, np.maximum(*reaches)))
        met = edge >= 0
        low_end, high_end = np.minimum(*ends)[met] - LOWER, np.maximum(*ends)[met] + LOWER
        return Seen(cell[met], edge[met], np.clip(low_end, 0.0, 1.0), np.clip(high_end, 0.0, 1.0),
                    reach * (1.0 + FARTHER) + LOWER)  # fmt: skip
