"""Tight without losing the drawing's own shape: straight stays straight, corners keep their angles."""

from __future__ import annotations

from dataclasses import dataclass

from ..mesh import Mesh
from .arap import boundary_cells
from .area import Area
from .weighted_sum import BoundSum


@dataclass(frozen=True)
class ShapeKeeping:
    """Area + strength · ½ L Σ min |z' - s p'|² over the cells of `BoundaryARAP`, each with a rotation and a scale s.

    Every part of the cage may shrink, grow and turn, but what is symmetric in the coarse mesh is pulled back to that:
    area alone is indefinite, so that round-off decides to which side an edge rolls.
    """

    strength: float = 1.0
    """How much change of shape weighs against area."""

    def at(self, coarse: Mesh) -> BoundSum:
        """The energy of a cage whose shape is that of the coarse mesh."""
        return BoundSum(((1.0, Area()), (self.strength, boundary_cells(coarse, similar=True))))
