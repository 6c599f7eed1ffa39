"""Choices of broad phase: all pairs, as in the paper, or those that a uniform grid finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...contact.pairs import Bodies, CandidateList, Pairs, find_pairs
from ...errors import NestedCagesError
from ...geometry.arrays import FloatArray

__all__ = ["AllPairs", "BroadPhase", "UniformGrid"]

MAX_PAIRS = 20_000_000
"""Maximum number of pairs stored: more would not fit into the memory of a small machine."""


class PairSource(Protocol):
    """Finds candidate pairs during one reinflation."""

    def within(self, x: FloatArray, reach: float, skin: float) -> Pairs:
        """A superset of the pairs closer than ``reach`` at x; a cached list also covers ``skin`` on top."""


class BroadPhase(Protocol):
    """A choice of broad phase, made before the meshes are known."""

    def candidates(self, bodies: Bodies) -> PairSource:
        """The search for one reinflation."""


@dataclass(frozen=True)
class AllPairs:
    """Every point with every edge, at every evaluation, as in the paper."""

    def candidates(self, bodies: Bodies) -> PairSource:
        """All pairs. Raises: NestedCagesError if they do not fit into memory."""
        count = bodies.m * (2 * bodies.n + bodies.m)
        if count > MAX_PAIRS:
            raise NestedCagesError(
                f"AllPairs() cannot hold {count} pairs; use UniformGrid() for meshes of this size.",
                code="setting.invalid",
            )
        return _Everything(find_pairs(bodies, np.zeros((bodies.m + bodies.n, 2)), np.inf))


@dataclass(frozen=True)
class UniformGrid:
    """Pairs found near each other on a uniform grid, kept while nothing moves far."""

    def candidates(self, bodies: Bodies) -> PairSource:
        """A list that is rebuilt when its skin is used up."""
        return CandidateList(bodies)


@dataclass(frozen=True, eq=False)
class _Everything:
    pairs: Pairs

    def within(self, x: FloatArray, reach: float, skin: float) -> Pairs:
        return self.pairs
