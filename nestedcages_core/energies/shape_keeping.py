"""Tight, but with the coarse mesh's own shape: straight stays straight, level stays level, symmetric symmetric."""

from __future__ import annotations

from dataclasses import dataclass

from ..geometry.mesh import Mesh
from .arap import boundary_cells
from .area import Area
from .shape_matching import ScaleFit
from .weighted_sum import BoundSum


@dataclass(frozen=True)
class ShapeKeeping:
    """Area + strength · ½ L Σ min |z' - s p'|² over the cells of `BoundaryARAP`, each with a scale s of its own.

    Every part of the cage may grow and shrink at no cost but not turn. Area alone is indefinite, so that round-off
    decides to which side an edge rolls; this keeps a symmetric coarse mesh symmetric.
    """

    strength: float = 3.0
    """How much change of shape weighs against area; from here on symmetric shapes stayed so (measured)."""

    def at(self, coarse: Mesh) -> BoundSum:
        """The energy of a cage whose shape is that of the coarse mesh."""
        return BoundSum(((1.0, Area()), (self.strength, boundary_cells(coarse, ScaleFit()))))
