"""How far a step may go before anything could meet: three filters to choose from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from ..geometry.arrays import FloatArray
from .ccd import SAFETY, largest_safe_step
from .pairs import Pairs


class StepFilter(Protocol):
    """Bounds a motion before the line search tries it."""

    @property
    def safe(self) -> bool:
        """Whether nothing can meet in what it lets through; otherwise every state has to be tested."""

    def fraction(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> float:
        """Part of ``motion`` (m + n, 2) from x that may be taken, at most 1.

        pairs: all that can meet; distance: (K,) their distances at x.
        """


@dataclass(frozen=True)
class NoFilter:
    """Any step: the paper's way, where only the infinite energy of a crossing refuses it afterwards."""

    safe: ClassVar[bool] = False

    def fraction(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> float:
        """1."""
        return 1.0


@dataclass(frozen=True)
class SmallestDistance:
    """The smallest distance, known from the energy at x, over the fastest approach: no quadratic is solved.

    What the paper describes as further work, after Smith & Schaefer 2015 and Li et al. 2020. No pair can close a gap
    that is wider than the longest motions of two vertices together.
    """

    safe: ClassVar[bool] = True

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
    """The first time at which a point meets an edge, from the roots of a quadratic for each pair: the longest steps."""

    safe: ClassVar[bool] = True

    def fraction(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> float:
        """SAFETY times the first time of impact, at most 1."""
        return largest_safe_step(pairs, x, motion, distance)
