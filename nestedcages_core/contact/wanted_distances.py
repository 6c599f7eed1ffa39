"""The distances that a cage must keep from the fine mesh and from itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from .pairs import Pairs


@dataclass(frozen=True)
class WantedDistances:
    """Distances to keep; both lengths."""

    clearance: float
    """Between cage and fine mesh."""
    own: float
    """Between parts of the cage."""

    def of(self, pairs: Pairs) -> FloatArray:
        """(K,) wanted distance of each pair."""
        wanted = np.full(len(pairs), self.clearance)
        wanted[pairs.cage_cage] = self.own
        return wanted
