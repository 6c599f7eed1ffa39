"""Outlines: one closed loop with its solid on the left, and directed lines that touch it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import cross, norm, rotated_right

BESIDE_PIN = 1e-3
"""Distance along an outline, in edges, between a pin and the lines through it."""


class Outline:
    """A closed loop with its solid on the left. Places along it: vertex k is k, the middle of its edge k + ½."""

    def __init__(
        self,
        vertices: FloatArray,
        weights: FloatArray | None = None,
        pinned: BoolArray | None = None,
        limits: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """weights, pinned: (S,) weight of each vertex, and whether it keeps a vertex of the cage.

        limits: minimum length of an edge, and minimum angle in degrees.
        """
        self.vertices, self.size, self.weights, self.limits = vertices, len(vertices), weights, limits
        self.edges = np.roll(vertices, -1, axis=0) - vertices
        self.lengths: FloatArray = norm(self.edges)
        self.length = float(self.lengths.sum())
        self.angles: FloatArray = np.arctan2(self.edges[:, 1], self.edges[:, 0])
        self.swept: FloatArray = np.concatenate(([0.0], np.cumsum(cross(vertices - vertices[0], self.edges))))
        """(S + 1,) twice the area swept from vertex 0 to vertex k, seen from vertex 0."""
        self.pins: IntArray = np.flatnonzero(pinned) if pinned is not None else np.zeros(0, np.int64)
        if weights is not None:
            self.edge_weights: FloatArray = 0.5 * (weights + np.roll(weights, -1))

    @property
    def is_convex(self) -> bool:
        """Whether it is a convex polygon."""
        return self.swept[-1] > 0.0 and bool((cross(np.roll(self.edges, 1, axis=0), self.edges) >= 0.0).all())

    @property
    def diameter(self) -> float:
        """Diameter of a circle that holds it."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return float(np.hypot(*(high - low)))

    @property
    def is_hole(self) -> bool:
        """Whether the solid lies around it."""
        return bool(self.swept[-1] < 0.0)

    def turned(self, place: FloatArray | IntArray, direction: FloatArray) -> FloatArray:
        """(K,) angles in [-π, π) from the edge before each place to a direction (K, 2)."""
        before = self.angles[np.ceil(place).astype(np.int64) - 1]
        angle: FloatArray = np.mod(np.arctan2(direction[:, 1], direction[:, 0]) - before + np.pi, 2.0 * np.pi) - np.pi
        return angle

    def mean_weight(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """(P,) the mean weight from place to place; both (P,)."""
        places = np.arange(self.size + 1.0)
        around = np.where(end < start, 1.0, 0.0)
        sums = []
        for density in (self.edge_weights * self.lengths, self.lengths):
            total = np.concatenate(([0.0], np.cumsum(density)))
            part = np.interp(end, places, total) - np.interp(start, places, total)
            sums.append(part + (around + NEGLIGIBLE) * total[-1])
        mean: FloatArray = sums[0] / sums[1]
        return mean


@dataclass(frozen=True, eq=False)
class Lines:
    """K directed lines in the order of their places along an outline."""

    point: FloatArray
    """(K, 2) a point of each line, its contact with the outline."""
    place: FloatArray
    """(K,) where on the outline that is."""
    direction: FloatArray
    """(K, 2) unit vectors; the solid lies to the left."""
    skipped: FloatArray
    """(K,) vertices of the outline before the contact that each line skips; 0 unless it spans a pocket."""
    span: FloatArray
    """(K,) length of the edge or pocket that each line runs along; 0 for a tangent."""

    @classmethod
    def of(
        cls, point: FloatArray, place: FloatArray | IntArray, direction: FloatArray, span: FloatArray | float = 0.0
    ) -> Lines:
        """Lines that skip nothing."""
        none = np.zeros(len(place))
        return cls(point, np.asarray(place, np.float64), direction, none, none + span)

    def __len__(self) -> int:
        return len(self.place)

    @classmethod
    def joined(cls, parts: list[Lines]) -> Lines:
        """All lines of several sets."""
        return cls(*(np.concatenate(each) for each in zip(*(part.arrays for part in parts), strict=True)))

    @property
    def arrays(self) -> tuple[FloatArray, ...]:
        """Contacts, places, directions, skipped vertices and spans."""
        return self.point, self.place, self.direction, self.skipped, self.span

    def but(self, **changed: Any) -> Lines:
        """The same with other arrays."""
        return replace(self, **changed)

    @property
    def right(self) -> FloatArray:
        """(K, 2) unit vectors away from the solid."""
        return rotated_right(self.direction)

    def take(self, which: IntArray | BoolArray) -> Lines:
        """Some of the lines."""
        return Lines(*(each[which] for each in self.arrays))

    def shifted(self, distance: float) -> Lines:
        """The lines moved away from the solid."""
        return self.but(point=self.point + distance * self.right)

    def ordered(self, outline: Outline) -> Lines:
        """The lines by place, and at one place by direction, without doubles."""
        lines = self.but(place=np.mod(self.place, outline.size))
        lines = lines.take(np.lexsort((-lines.skipped, outline.turned(lines.place, lines.direction), lines.place)))
        height = cross(lines.direction, lines.point - outline.vertices[0])
        change = np.diff(lines.place) + np.abs(np.diff(lines.direction, axis=0)).max(axis=1) + np.abs(np.diff(height))
        return lines.take(np.concatenate(([True], change > NEGLIGIBLE))[: len(lines.place)])

    def beside_pins(self, outline: Outline) -> Lines:
        """The lines with those at pins twice, before and behind the pin, so that it lies between the two."""
        at_pin = np.isin(self.place, outline.pins)
        there = self.take(at_pin)
        moved = [there.but(place=np.mod(there.place + way * BESIDE_PIN, outline.size)) for way in (-1.0, 1.0)]
        lines = Lines.joined([self.take(~at_pin), *moved])
        return lines.take(np.lexsort((outline.turned(lines.place, lines.direction), lines.place)))

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
