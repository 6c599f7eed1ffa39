"""Outlines: closed loops with their solid on the left, and directed lines that touch them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import position_in_group
from ..geometry.loops import Loops
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import cross, norm, rotated_right

BESIDE_PIN = 1e-3
"""Distance along an outline, in edges, between a pin and the lines through it."""


class Outline:
    """Closed loops with their solid on the left, one after the other.

    Places along them: vertex k is k, the middle of its edge k + ½; those of a loop begin with its first vertex.
    """

    def __init__(
        self,
        loops: Loops,
        weights: FloatArray | None = None,
        pinned: BoolArray | None = None,
        limits: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """weights, pinned: (S,) weight of each vertex, and whether it keeps a vertex of the cage.

        limits: minimum length of an edge, and minimum angle in degrees.
        """
        self.loops, self.vertices, self.size = loops, loops.vertices, len(loops.vertices)
        self.weights, self.pinned, self.limits = weights, pinned, limits
        self.pins: IntArray = np.zeros(0, np.int64) if pinned is None else np.flatnonzero(pinned)
        self.loop, self.begins, self.sizes = loops.loop, loops.begins, loops.sizes
        self.edges = loops.ends - self.vertices
        self.lengths: FloatArray = norm(self.edges)
        self.perimeters: FloatArray = np.add.reduceat(self.lengths, self.begins)
        """(L,)"""
        self.angles: FloatArray = np.arctan2(self.edges[:, 1], self.edges[:, 0])
        self.origins: FloatArray = self.vertices[self.begins]
        """(L, 2) the first vertex of each loop."""
        swept = np.cumsum(cross(self.vertices - self.origins[self.loop], self.edges))
        self.areas: FloatArray = np.diff(swept[self.begins + self.sizes - 1], prepend=0.0)
        """(L,) twice the area in each loop, negative in holes."""
        self.swept: FloatArray = np.concatenate(([0.0], swept[:-1]))
        self.swept -= self.swept[self.begins][self.loop]
        """(S,) twice the area swept from the first vertex of a loop to each one, seen from there."""
        if weights is not None:
            self.edge_weights: FloatArray = 0.5 * (weights + weights[loops.ahead])

    @classmethod
    def of(cls, ring: FloatArray, weights: FloatArray | None = None) -> Outline:
        """One loop (k, 2)."""
        return cls(Loops.of(ring, [len(ring)]), weights)

    def vertices_of(self, loops: Sequence[int]) -> IntArray:
        """The vertices of some of the loops."""
        return np.repeat(self.begins[loops], self.sizes[loops]) + position_in_group(self.sizes[loops])

    def only(self, loops: Sequence[int]) -> Outline:
        """Some of the loops."""
        if len(loops) == len(self.sizes):
            return self
        own = self.vertices_of(loops)
        weights = None if self.weights is None else self.weights[own]
        pinned = None if self.pinned is None else self.pinned[own]
        return Outline(Loops.of(self.vertices[own], self.sizes[loops]), weights, pinned, self.limits)

    @property
    def twice(self) -> IntArray:
        """(2 S,) each loop's vertices twice; vertex k of loop l, or one beyond its end, is number k + begins[l]."""
        sizes = np.repeat(self.sizes, 2)
        return position_in_group(sizes) + np.repeat(np.repeat(self.begins, 2), sizes)

    @property
    def length(self) -> float:
        """Length of all loops."""
        return float(self.perimeters.sum())

    @property
    def diameters(self) -> FloatArray:
        """(L,) diameter of a circle that holds each loop."""
        low, high = (each.reduceat(self.vertices, self.begins) for each in (np.minimum, np.maximum))
        return norm(high - low)

    @property
    def is_convex(self) -> BoolArray:
        """(L,) whether each loop is a convex polygon."""
        turns_left = cross(self.edges[self.loops.back], self.edges) >= 0.0
        return np.logical_and.reduceat(turns_left, self.begins) & (self.areas > 0.0)

    @property
    def is_hole(self) -> BoolArray:
        """(L,) whether the solid lies around it."""
        return self.areas < 0.0

    def loop_at(self, place: FloatArray) -> IntArray:
        """(K,) the loop of each place."""
        return self.loop[place.astype(np.int64)]

    def wrapped(self, place: FloatArray, loop: IntArray) -> FloatArray:
        """(K,) places of loops (K,) that were passed beyond the end of these."""
        begin = self.begins[loop]
        return np.asarray(begin + np.mod(place - begin, self.sizes[loop]))

    def turned(self, place: FloatArray | IntArray, direction: FloatArray) -> FloatArray:
        """(K,) angles in [-π, π) from the edge before each place to a direction (K, 2)."""
        edge = place.astype(np.int64)
        before = self.angles[np.where(edge == place, self.loops.back[edge], edge)]
        angle: FloatArray = np.mod(np.arctan2(direction[:, 1], direction[:, 0]) - before + np.pi, 2.0 * np.pi) - np.pi
        return angle

    def mean_weight(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """(P,) the mean weight from place to place of the same loop; both (P,)."""
        places, loop = np.arange(self.size + 1.0), self.loop_at(start)
        around = np.where(end < start, 1.0, 0.0)
        sums = []
        for density in (self.edge_weights * self.lengths, self.lengths):
            total = np.concatenate(([0.0], np.cumsum(density)))
            part = np.interp(end, places, total) - np.interp(start, places, total)
            sums.append(part + (around + NEGLIGIBLE) * np.add.reduceat(density, self.begins)[loop])
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
    def joined(cls, parts: Sequence[Lines]) -> Lines:
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

    def take(self, which: IntArray | BoolArray | slice) -> Lines:
        """Some of the lines."""
        return Lines(*(each[which] for each in self.arrays))

    def shifted(self, distance: FloatArray | float) -> Lines:
        """The lines moved away from the solid, by one distance or by (K,)."""
        return self.but(point=self.point + np.reshape(distance, (-1, 1)) * self.right)

    def ordered(self, outline: Outline) -> Lines:
        """The lines by place, and at one place by direction, without doubles."""
        turned = outline.turned(self.place, self.direction)
        lines = self.take(np.lexsort((-self.skipped, turned, self.place)))
        height = cross(lines.direction, lines.point - outline.vertices[0])
        change = np.diff(lines.place) + np.abs(np.diff(lines.direction, axis=0)).max(axis=1) + np.abs(np.diff(height))
        return lines.take(np.concatenate(([True], change > NEGLIGIBLE))[: len(lines.place)])

    def beside_pins(self, outline: Outline) -> Lines:
        """The lines with those at pins twice, before and behind the pin, so that it lies between the two."""
        at_pin = np.isin(self.place, outline.pins)
        there = self.take(at_pin)
        loop = outline.loop_at(there.place)
        moved = [there.but(place=outline.wrapped(there.place + way * BESIDE_PIN, loop)) for way in (-1.0, 1.0)]
        lines = Lines.joined([self.take(~at_pin), *moved])
        return lines.take(np.lexsort((outline.turned(lines.place, lines.direction), lines.place)))

    def meeting(self) -> FloatArray:
        """(K, 2) where each line meets the one before it in the cycle."""
        point, direction = np.roll(self.point, 1, axis=0), np.roll(self.direction, 1, axis=0)
        step = cross(self.point - point, self.direction) / cross(direction, self.direction)
        ring: FloatArray = point + step[:, None] * direction
        return ring


def largest(value: FloatArray, group: IntArray, number: IntArray) -> BoolArray:
    """(K,) whether each value is among the `number` (G,) largest of its group (K,), the first of equal ones."""
    order = np.lexsort((-value, group))
    chosen = np.zeros(len(value), bool)
    chosen[order] = position_in_group(np.bincount(group, minlength=len(number))) < number[group[order]]
    return chosen


def without_doubles(ring: FloatArray) -> FloatArray:
    """The ring (k, 2) without vertices at the place of the one before."""
    away = norm(ring - np.roll(ring, 1, axis=0))
    distinct: FloatArray = ring[away > ROUND_OFF * away.sum()]
    return distinct
