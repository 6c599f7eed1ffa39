"""The distances that a cage must keep from the fine mesh and from itself."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from .pairs import Pairs


@dataclass(frozen=True)
class WantedDistances:
    """Distances to keep; both lengths."""

    clearance: float
    """Between cage and fine mesh."""
    own: float
    """Between parts of the cage."""
    apart: float = field(default=0.0, kw_only=True)
    """Between loops of the cage, if that is more."""
    loop: IntArray | None = field(default=None, kw_only=True)
    """(m,) the loop of each vertex of the cage, where it matters."""

    @property
    def largest(self) -> float:
        """The largest of them."""
        return max(self.clearance, self.own, self.apart)

    def of(self, pairs: Pairs) -> FloatArray:
        """(K,) wanted distance of each pair."""
        wanted = np.full(len(pairs), self.clearance)
        own = pairs.cage_cage
        wanted[own] = self.own
        if self.loop is not None:
            between = self.loop[pairs.point[own]] != self.loop[pairs.start[own]]
            wanted[own] = np.where(between, max(self.own, self.apart), self.own)
        return wanted
