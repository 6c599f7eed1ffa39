"""The proof that nothing flips or touches while joints turn: intervals of angles, halved until a bound decides.

Points move by at most d_i from where they are at the middle of an interval, seen from a frame that turns along with
them. Twice the area of a triangle then changes by at most Σ d_i |edge opposite to i| + Σ_{i<j} d_i d_j, and the
distance of a point from an edge by at most d_0 + max(d_1, d_2). Where the value at the middle is larger, it stays
positive in the whole interval. `Skin.speed` bounds d_i in closed form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.distance import point_edge
from ...geometry.precision import ROUND_OFF
from .skinning import Complex, Skin

POSED_ROUNDING = 2.0**-20
"""How far off posed places may be that a program computes in float32, in the largest coordinate: three times what
Blender was seen to be."""

ANGLE_STEP = 1e-3
"""Least width of an interval, in radians: where one so narrow does not decide, the range ends."""

Test = Callable[[IntArray, FloatArray, FloatArray], tuple[BoolArray, BoolArray]]
"""Which of items (M,) are certain in boxes of angles from (M, A) to (M, A), and which fail at their middle."""


def safe_part(test: Test, count: int, extent: FloatArray) -> float:
    """The largest part of a box in which all of `count` items are certain, from 0 to 1, to within `ANGLE_STEP`.

    extent: (A,) signed angles in radians: the box reaches from rest to these; parts of it are scaled alike.
    """
    axes = len(extent)
    item, low, high = np.arange(count), np.zeros((count, axes)), np.ones((count, axes))
    limit = 1.0
    while len(item):
        one, other = low * extent, high * extent
        certain, fails = test(item, np.minimum(one, other), np.maximum(one, other))
        limit = min(limit, float((0.5 * (low + high))[fails].max(axis=1).min(initial=1.0)))
        open_ = ~certain
        item, low, high = item[open_], low[open_], high[open_]
        width = (high - low) * np.abs(extent)
        tiny = (width < ANGLE_STEP).all(axis=1)
        limit = min(limit, float(low[tiny].max(axis=1).min(initial=1.0)))
        kept = ~tiny & (low.max(axis=1) < limit)
        item, low, high, width = item[kept], low[kept], high[kept], width[kept]
        row, widest = np.arange(len(item)), width.argmax(axis=1)
        middle = 0.5 * (low[row, widest] + high[row, widest])
        nearer, farther = high.copy(), low.copy()
        nearer[row, widest] = farther[row, widest] = middle
        item, low, high = np.tile(item, 2), np.concatenate((low, farther)), np.concatenate((nearer, high))
    return limit


@dataclass(frozen=True, eq=False)
class OneJoint:
    """Triples of points (T, 3) that one joint moves."""

    place: Complex
    """(T, 3) at rest, relative to the joint."""
    weight: FloatArray
    """(T, 3) of the bone after the joint."""
    skin: Skin
    rounding: float
    """How far off each place may be."""

    def moved(self, item: IntArray, low: FloatArray, high: FloatArray) -> tuple[Complex, FloatArray]:
        """Where the triples are in the middle of intervals (M, 1), and how far they may be from there in them."""
        place, weight = self.place[item], self.weight[item]
        rate = weight.mean(axis=1, keepdims=True)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        reach = half * self.skin.speed(weight, rate, low, high) * np.abs(place)
        return place * self.skin.multiplier(weight, middle), reach + self.rounding


@dataclass(frozen=True, eq=False)
class TwoJoints:
    """Triples of points (T, 3) that two joints move, seen from the bone between them."""

    place: Complex
    """(T, 3) at rest, relative to the joint that moves each point."""
    joint: Complex
    """(T, 3) that joint."""
    weight: FloatArray
    """(T, 3) of the bone after that joint."""
    of_second: BoolArray
    """(T, 3) whether that joint is the second one."""
    skin: Skin
    rounding: float
    with_first: float = 1.0
    """1 if the bone from which they are seen turns with the first joint, 0 if it carries both."""

    def moved(self, item: IntArray, low: FloatArray, high: FloatArray) -> tuple[Complex, FloatArray]:
        """Where the triples are in the middle of boxes (M, 2), and how far they may be from there in them."""
        place, weight, second = self.place[item], self.weight[item], self.of_second[item]
        low, high = (np.where(second, ends[:, 1:], ends[:, :1]) for ends in (low, high))
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        rate = np.where(second, 0.0, self.with_first)
        turned = self.skin.multiplier(weight, middle) * np.exp(-1j * rate * middle)
        reach = half * self.skin.speed(weight, rate, low, high) * np.abs(place)
        return self.joint[item] + place * turned, reach + self.rounding


def unfolded(triples: OneJoint | TwoJoints) -> Test:
    """Certain where triangles keep their orientation."""

    def test(item: IntArray, low: FloatArray, high: FloatArray) -> tuple[BoolArray, BoolArray]:
        p, d = triples.moved(item, low, high)
        edge = np.roll(p, 1, axis=1) - np.roll(p, -1, axis=1)
        doubled = np.imag(np.conj(p[:, 1] - p[:, 0]) * (p[:, 2] - p[:, 0]))
        change = (d * np.abs(edge)).sum(axis=1) + (d * np.roll(d, -1, axis=1)).sum(axis=1)
        return doubled > change * (1.0 + ROUND_OFF), doubled <= 0.0

    return test


def apart(triples: OneJoint) -> Test:
    """Certain where the first point of each triple stays off the edge between the two others."""

    def test(item: IntArray, low: FloatArray, high: FloatArray) -> tuple[BoolArray, BoolArray]:
        p, d = triples.moved(item, low, high)
        points = np.stack((p.real, p.imag), axis=2)
        gap = point_edge(points[:, 0], points[:, 1], points[:, 2]).distance
        return gap > (d[:, 0] + d[:, 1:].max(axis=1)) * (1.0 + ROUND_OFF), gap <= 0.0

    return test
