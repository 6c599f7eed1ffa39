"""Which pairs are looked at: all of them, as in the paper, or those that cells find near each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from .pairs import Bodies, CandidateList, Pairs, find_pairs

MOST_PAIRS = 20_000_000
"""Number of pairs beyond which looking at all of them does not fit into the memory of a small machine."""


class PairSource(Protocol):
    """Gives the pairs to look at."""

    def within(self, x: FloatArray, reach: float, skin: float) -> Pairs:
        """Pairs that contain all those closer than ``reach`` at x; a list that is kept also covers ``skin`` on top."""


class BroadPhase(Protocol):
    """A choice of broad phase before the bodies are known."""

    def candidates(self, bodies: Bodies) -> PairSource:
        """The candidates of one reinflation."""


@dataclass(frozen=True)
class AllPairs:
    """Every point with every edge, at every evaluation: the paper's way."""

    def candidates(self, bodies: Bodies) -> PairSource:
        """All pairs. Raises: NestedCagesError where they would not fit into memory."""
        count = bodies.m * (2 * bodies.n + bodies.m)
        if count > MOST_PAIRS:
            raise NestedCagesError(f"AllPairs() cannot hold {count} pairs; use UniformGrid() for meshes of this size.")
        return _Everything(find_pairs(bodies, np.zeros((bodies.m + bodies.n, 2)), np.inf))


@dataclass(frozen=True)
class UniformGrid:
    """Pairs that are found near each other, kept while nothing has moved far."""

    def candidates(self, bodies: Bodies) -> PairSource:
        """A list that is built anew when its skin is used up."""
        return CandidateList(bodies)


Cells = UniformGrid
"""Former name."""


@dataclass(frozen=True, eq=False)
class _Everything:
    pairs: Pairs

    def within(self, x: FloatArray, reach: float, skin: float) -> Pairs:
        return self.pairs
