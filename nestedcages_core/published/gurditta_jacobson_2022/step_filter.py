"""Step filters: the fraction of a step that is free of collisions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...contact.ccd import SAFETY, largest_safe_step
from ...contact.pairs import Pairs
from ...geometry.arrays import FloatArray

__all__ = ["NoFilter", "SmallestDistance", "StepFilter", "TimeOfImpact"]


class StepFilter(Protocol):
    """Bounds a motion before the line search."""

    def fraction(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> float:
        """Fraction of ``motion`` (m + n, 2) from x that may be taken, at most 1.

        pairs: a superset of those that can meet; distance: (K,) their distances at x.
        """


@dataclass(frozen=True)
class NoFilter:
    """No bound, as in the paper: only the infinite energy of a crossing rejects a step afterwards."""

    def fraction(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> float:
        """1."""
        return 1.0


@dataclass(frozen=True)
class SmallestDistance:
    """Smallest distance over fastest approach, without solving a quadratic.

    Named as further work by the paper, after Smith & Schaefer 2015 and Li et al. 2020.
    """

    def fraction(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> float:
        """SAFETY · d_min / (largest motion of a point + largest motion of an edge), at most 1."""
        if len(pairs) == 0:
            return 1.0
        speed = np.sqrt(motion[:, 0] ** 2 + motion[:, 1] ** 2)
        approach = speed.take(pairs.point).max() + max(speed.take(pairs.start).max(), speed.take(pairs.end).max())
        bound = SAFETY * float(distance.min())
        return 1.0 if bound >= approach else bound / float(approach)


@dataclass(frozen=True)
class TimeOfImpact:
    """First time of impact over all pairs, from the roots of a quadratic: allows the longest steps."""

    def fraction(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> float:
        """SAFETY times the first time of impact, at most 1."""
        return largest_safe_step(pairs, x, motion, distance)
