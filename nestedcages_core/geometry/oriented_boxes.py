"""Oriented boxes: unlike axis-aligned ones they separate long, slanted, parallel segments."""

from __future__ import annotations

from contextlib import AbstractContextManager

import numpy as np

from .arrays import FloatArray, IntArray
from .vectors import rotated_left

SEPARATION_ROUNDING = 1e-13
"""Fraction of the largest coordinate that a separation must exceed; some 900 roundings of a double."""

MIN_SEPARATION = 1e-290
"""Separation in input units, below which it may be due to underflow."""


class OrientedBoxes:
    """Boxes of one level of a tree; each has the direction of the longest segment in it.

    middle: (N, 2); axis: (N, 2) unit vectors; half: (N, 2) half of the length along the axis and of the width across;
    longest: (N,) length of the longest segment.
    """

    def __init__(self, middle: FloatArray, axis: FloatArray, half: FloatArray, longest: FloatArray) -> None:
        self.middle, self.axis, self.half, self.longest = middle, axis, half, longest
        self.slack = (
            SEPARATION_ROUNDING * float(np.abs(middle).max(initial=0.0) + half.max(initial=0.0)) + MIN_SEPARATION
        )

    @classmethod
    def of_segments(cls, starts: FloatArray, ends: FloatArray) -> OrientedBoxes:
        """The flat box of each segment (E, 2) -> (E, 2)."""
        with _beyond_range():
            along = ends - starts
            greatest = np.abs(along).max(axis=1, initial=0.0)
            slope = along / greatest[:, None]
            axis = slope / np.hypot(*slope.T)[:, None]
            axis[~np.isfinite(axis).all(axis=1)] = (1.0, 0.0)  # of a point, or of a length beyond the range
            half = np.stack((0.5 * np.hypot(*along.T), np.zeros(len(starts))), axis=1)
            return cls(0.5 * starts + 0.5 * ends, axis, half, half[:, 0])

    def parents(self, fanout: int) -> OrientedBoxes:
        """The boxes around `fanout` consecutive boxes each."""
        with _beyond_range():
            begins = np.arange(0, len(self.longest), fanout)
            missing = -len(self.longest) % fanout
            longest = np.concatenate((self.longest, np.full(missing, -1.0))).reshape(-1, fanout)
            lead = begins + longest.argmax(axis=1)
            axis = self.axis[lead]
            owner = np.arange(len(self.longest)) // fanout
            along, across = _coordinates(self.middle - self.middle[lead][owner], axis[owner])
            cosine, sine = (np.abs(x) for x in _coordinates(self.axis, axis[owner]))
            length, width = self.half.T
            extents = []
            for place, reach in ((along, length * cosine + width * sine), (across, length * sine + width * cosine)):
                low, high = np.minimum.reduceat(place - reach, begins), np.maximum.reduceat(place + reach, begins)
                extents.append((0.5 * (low + high), 0.5 * (high - low)))
            (shift, length), (shift_across, width) = extents
            middle = self.middle[lead] + shift[:, None] * axis + shift_across[:, None] * rotated_left(axis)
            return OrientedBoxes(middle, axis, np.stack((length, width), axis=1), longest.max(axis=1))

    def gap(self, i: IntArray, other: OrientedBoxes, j: IntArray) -> FloatArray:
        """Lower bound of the distance between boxes i of this level and j of the other, across their axes, (K,)."""
        with _beyond_range():
            offset, axis, other_axis = other.middle[j] - self.middle[i], self.axis[i], other.axis[j]
            (length, width), (other_length, other_width) = self.half[i].T, other.half[j].T
            cosine, sine = (np.abs(x) for x in _coordinates(other_axis, axis))
            gap = np.abs(_coordinates(offset, axis)[1]) - width - other_length * sine - other_width * cosine
            other_gap = np.abs(_coordinates(offset, other_axis)[1]) - other_width - length * sine - width * cosine
            return np.asarray(np.fmax(np.fmax(gap, other_gap), -np.inf) - self.slack - other.slack)


def _beyond_range() -> AbstractContextManager[None]:
    """No warnings: beyond the range of a double no boxes are separated, which is safe."""
    return np.errstate(all="ignore")


def _coordinates(vectors: FloatArray, axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Components of vectors (K, 2) along unit axes (K, 2) and across them, (K,), (K,)."""
    (x, y), (u, v) = vectors.T, axis.T
    return x * u + y * v, y * u - x * v
