"""A grid: the multiples of a length, each rounded to the nearest double, as when reading decimals."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from .arrays import FloatArray, IntArray

EXACT_INTEGERS = 2**53
"""Whole numbers below this are doubles."""

MAX_PLACE = 10**15
"""Largest k: every decimal of 15 digits is read and written without loss."""


@dataclass(frozen=True)
class Grid:
    """The numbers k · spacing, k whole, each as the nearest double.

    The spacing stands for the shortest decimal that reads as this double: 0.01 is one hundredth exactly. So a grid
    point equals the double that its decimals read as.
    """

    spacing: float
    """A length above 0."""

    @classmethod
    def of_decimals(cls, decimals: int) -> Grid:
        """The numbers with a given number of decimals; 0 for whole numbers."""
        return cls(float(Fraction(1, 10**decimals)))

    @cached_property
    def ratio(self) -> Fraction:
        """The exact spacing: its shortest decimal, or the double itself if that is the simpler fraction."""
        given, written = Fraction(self.spacing), Fraction(repr(self.spacing))
        return min(written, given, key=lambda ratio: ratio.numerator)

    def resolves(self, points: FloatArray) -> bool:
        """Whether doubles at points (..., 2) are dense enough to separate grid points."""
        return float(np.abs(points).max(initial=0.0)) <= MAX_PLACE * self.spacing

    def places(self, points: FloatArray) -> IntArray:
        """The k of the grid point next to each coordinate."""
        places: IntArray = np.rint(np.asarray(points, dtype=np.float64) / self.spacing).astype(np.int64)
        return places

    def points(self, places: IntArray) -> FloatArray:
        """The grid point of each k: the double nearest to k · spacing."""
        over, under = self.ratio.numerator, self.ratio.denominator
        if max(int(np.abs(places).max(initial=0)) * over, under) < EXACT_INTEGERS:  # one division, rounded once
            return np.asarray(places * float(over) / float(under), dtype=np.float64)
        different, which = np.unique(places, return_inverse=True)  # few lines hold many points
        exact = [k * over / under for k in different.tolist()]  # whole numbers of Python, rounded once too
        return np.array(exact, dtype=np.float64)[which].reshape(places.shape)

    def holds(self, points: FloatArray) -> bool:
        """Whether all coordinates are grid points."""
        return self.resolves(points) and bool((self.points(self.places(points)) == points).all())


def as_stored(points: FloatArray, stored: str | None) -> FloatArray:
    """Points (..., 2) as a type of numpy holds them, infinite beyond it; None: as they are."""
    with np.errstate(over="ignore"):
        return points if stored is None else points.astype(stored).astype(np.float64)
