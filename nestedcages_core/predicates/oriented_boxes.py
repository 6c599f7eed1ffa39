"""Boxes turned along their segments: they tell long slanted segments side by side apart, which upright ones do not."""

from __future__ import annotations

from contextlib import AbstractContextManager

import numpy as np

from .._types import BoolArray, FloatArray, IntArray

ROUNDING = 1e-13
"""Share of the largest coordinate that a separation must exceed to be believed; some 900 roundings of a double."""

LEAST_SEPARATION = 1e-290
"""Separation, in input units, below which underflow could pretend it."""


class OrientedBoxes:
    """Boxes of one level of a tree: middle (N, 2), unit axis (N, 2), half length along it and half width across, (N,).

    Each box has the direction of the longest segment in it. longest: (N,) the length of that segment.
    """

    def __init__(self, middle: FloatArray, axis: FloatArray, half: FloatArray, longest: FloatArray) -> None:
        self.middle, self.axis, self.half, self.longest = middle, axis, half, longest
        self.slack = ROUNDING * float(np.abs(middle).max(initial=0.0) + half.max(initial=0.0)) + LEAST_SEPARATION

    @classmethod
    def of_segments(cls, starts: FloatArray, ends: FloatArray) -> OrientedBoxes:
        """The flat box of each segment (E, 2) -> (E, 2)."""
        with _beyond_range():
            along = 0.5 * ends - 0.5 * starts
            half_length = np.hypot(*along.T)
            axis = along / np.where(half_length > 0.0, half_length, 1.0)[:, None]
            axis[~np.isfinite(axis).all(axis=1) | ~axis.any(axis=1)] = (1.0, 0.0)
            half = np.stack((half_length, np.zeros(len(starts))), axis=1)
            return cls(0.5 * starts + 0.5 * ends, axis, half, half_length)

    def parents(self, fanout: int) -> OrientedBoxes:
        """The boxes around `fanout` consecutive boxes each."""
        with _beyond_range():
            begins = np.arange(0, len(self.longest), fanout)
            missing = -len(self.longest) % fanout
            longest = np.concatenate((self.longest, np.full(missing, -1.0))).reshape(-1, fanout)
            lead = begins + longest.argmax(axis=1)
            axis = self.axis[lead]
            owner = np.arange(len(self.longest)) // fanout
            offset = self.middle - self.middle[lead][owner]
            low, high = [], []
            for direction in (axis[owner], _across(axis)[owner]):
                place = (offset * direction).sum(axis=1)
                reach = self.reach(np.arange(len(owner)), direction)
                low.append(np.minimum.reduceat(place - reach, begins))
                high.append(np.maximum.reduceat(place + reach, begins))
            centre = [0.5 * (a + b) for a, b in zip(low, high, strict=True)]
            middle = self.middle[lead] + centre[0][:, None] * axis + centre[1][:, None] * _across(axis)
            half = np.stack([0.5 * (b - a) for a, b in zip(low, high, strict=True)], axis=1)
            return OrientedBoxes(middle, axis, half, longest.max(axis=1))

    def reach(self, nodes: IntArray, direction: FloatArray) -> FloatArray:
        """Half the extent of boxes (K,) along unit directions (K, 2)."""
        axis, half = self.axis[nodes], self.half[nodes]
        across = _across(axis)
        along_axis, along_across = np.abs((axis * direction).sum(axis=1)), np.abs((across * direction).sum(axis=1))
        return np.asarray(half[:, 0] * along_axis + half[:, 1] * along_across)

    def gap(self, i: IntArray, other: OrientedBoxes, j: IntArray) -> FloatArray:
        """How far the boxes i of this level and j of the other are apart across their axes, at least, (K,)."""
        with _beyond_range():
            offset = other.middle[j] - self.middle[i]
            gap = np.full(len(i), -np.inf)
            for boxes, nodes in ((self, i), (other, j)):
                direction = _across(boxes.axis[nodes])
                reach = self.reach(i, direction) + other.reach(j, direction)
                np.fmax(gap, np.abs((offset * direction).sum(axis=1)) - reach - self.slack - other.slack, out=gap)
            return gap

    def may_hold(self, nodes: IntArray, points: FloatArray) -> BoolArray:
        """Whether boxes (K,) hold points (K, 2), across both their axes, (K,)."""
        with _beyond_range():
            offset = points - self.middle[nodes]
            axis, half = self.axis[nodes], self.half[nodes]
            slack = self.slack + ROUNDING * np.abs(points).max(axis=1)
            outside = np.abs((offset * axis).sum(axis=1)) - half[:, 0] > slack
            outside |= np.abs((offset * _across(axis)).sum(axis=1)) - half[:, 1] > slack
            return np.asarray(~outside)


def _beyond_range() -> AbstractContextManager[None]:
    """Beyond the range of a double nothing is told apart, which is safe, so numpy need not warn."""
    return np.errstate(over="ignore", under="ignore", invalid="ignore")


def _across(axis: FloatArray) -> FloatArray:
    return np.stack((-axis[:, 1], axis[:, 0]), axis=1)
