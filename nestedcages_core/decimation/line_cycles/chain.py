"""A loop as a chain of edges, and directed lines along it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.precision import NEGLIGIBLE, ROUND_OFF
from ...geometry.vectors import cross, norm, rotated_right

BESIDE_PIN = 1e-3
"""Distance along a loop, in edges, between a pin and the lines through it."""


class Chain:
    """A closed loop with its solid on the left. Places along it: vertex k is k, the middle of its edge k + ½."""

    def __init__(
        self,
        vertices: FloatArray,
        weights: FloatArray | None = None,
        pinned: BoolArray | None = None,
        limits: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """weights, pinned: (S,) how much each vertex matters, and whether it keeps a vertex of the cage.

        limits: the least length of an edge, and angle in degrees.
        """
        self.vertices = vertices
        """(S, 2)."""
        self.size = len(vertices)
        self.edges = np.roll(vertices, -1, axis=0) - vertices
        self.lengths: FloatArray = norm(self.edges)
        self.length = float(self.lengths.sum())
        self.angles: FloatArray = np.arctan2(self.edges[:, 1], self.edges[:, 0])
        self.swept: FloatArray = np.concatenate(([0.0], np.cumsum(cross(vertices - vertices[0], self.edges))))
        """(S + 1,) twice the area swept from vertex 0 to vertex k, seen from vertex 0."""
        self.weights = weights
        self.limits = limits
        self.pins: IntArray = np.flatnonzero(pinned) if pinned is not None else np.zeros(0, np.int64)
        if weights is not None:
            self.edge_weights: FloatArray = 0.5 * (weights + np.roll(weights, -1))
            self._weighed = np.concatenate(([0.0], np.cumsum(self.edge_weights * self.lengths)))
            self._along = np.concatenate(([0.0], np.cumsum(self.lengths)))

    @property
    def is_convex(self) -> bool:
        """Whether the loop is a convex polygon."""
        return self.swept[-1] > 0.0 and bool((cross(np.roll(self.edges, 1, axis=0), self.edges) >= 0.0).all())

    def turned(self, place: FloatArray | IntArray, direction: FloatArray) -> FloatArray:
        """(K,) angles in [-π, π) from the edge before each place to a direction (K, 2)."""
        before = self.angles[np.ceil(place).astype(np.int64) - 1]
        angle: FloatArray = np.mod(np.arctan2(direction[:, 1], direction[:, 0]) - before + np.pi, 2.0 * np.pi) - np.pi
        return angle

    def mean_weight(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """(P,) the mean weight from place to place; both (P,)."""
        places = np.arange(self.size + 1.0)
        around = np.where(end < start, 1.0, 0.0)
        sums = [
            np.interp(end, places, each) - np.interp(start, places, each) + around * each[-1] + NEGLIGIBLE * scale
            for each, scale in ((self._weighed, self._weighed[-1]), (self._along, self.length))
        ]
        mean: FloatArray = sums[0] / sums[1]
        return mean


class Lines(NamedTuple):
    """K directed lines in the order of their places along a chain."""

    point: FloatArray
    """(K, 2) a point of each line, its contact with the chain."""
    place: FloatArray
    """(K,) where on the chain that is."""
    direction: FloatArray
    """(K, 2) unit vectors; the solid lies to the left."""
    passed: FloatArray
    """(K,) how much of the chain before the contact each line passes over, in vertices; 0 unless over a pocket."""

    @classmethod
    def of(cls, point: FloatArray, place: FloatArray, direction: FloatArray) -> Lines:
        """Lines that pass over nothing."""
        return cls(point, place, direction, np.zeros(len(place)))

    def __len__(self) -> int:
        return len(self.place)

    @classmethod
    def joined(cls, parts: list[Lines]) -> Lines:
        """All lines of several sets."""
        return cls(
            np.concatenate([part.point for part in parts]),
            np.concatenate([part.place for part in parts]),
            np.concatenate([part.direction for part in parts]),
            np.concatenate([part.passed for part in parts]),
        )

    @property
    def right(self) -> FloatArray:
        """(K, 2) unit vectors away from the solid."""
        return rotated_right(self.direction)

    def take(self, which: IntArray | BoolArray) -> Lines:
        """Some of the lines."""
        return Lines(self.point[which], self.place[which], self.direction[which], self.passed[which])

    def shifted(self, distance: float) -> Lines:
        """The lines moved away from the solid."""
        return Lines(self.point + distance * self.right, self.place, self.direction, self.passed)

    def ordered(self, chain: Chain) -> Lines:
        """The lines by place, and at one place by direction, without doubles."""
        lines = Lines(self.point, np.mod(self.place, chain.size), self.direction, self.passed)
        lines = lines.take(np.lexsort((-lines.passed, chain.turned(lines.place, lines.direction), lines.place)))
        height = cross(lines.direction, lines.point - chain.vertices[0])
        change = np.diff(lines.place) + np.abs(np.diff(lines.direction, axis=0)).max(axis=1) + np.abs(np.diff(height))
        return lines.take(np.concatenate(([True], change > NEGLIGIBLE))[: len(lines.place)])

    def beside_pins(self, chain: Chain) -> Lines:
        """The lines with those at pins twice, before and behind the pin, so that it lies between the two."""
        at_pin = np.isin(self.place, chain.pins)
        there = self.take(at_pin)
        moved = [
            Lines(there.point, np.mod(there.place + way * BESIDE_PIN, chain.size), there.direction, there.passed)
            for way in (-1.0, 1.0)
        ]
        lines = Lines.joined([self.take(~at_pin), *moved])
        return lines.take(np.lexsort((chain.turned(lines.place, lines.direction), lines.place)))

    def meeting(self) -> FloatArray:
        """(K, 2) where each line meets the one before it in the cycle."""
        point, direction = np.roll(self.point, 1, axis=0), np.roll(self.direction, 1, axis=0)
        step = cross(self.point - point, self.direction) / cross(direction, self.direction)
        ring: FloatArray = point + step[:, None] * direction
        return ring


def without_doubles(ring: FloatArray) -> FloatArray:
    """The ring (k, 2) without vertices at the place of the one before."""
    away = norm(ring - np.roll(ring, 1, axis=0))
    distinct: FloatArray = ring[away > ROUND_OFF * away.sum()]
    return distinct
