"""Tight, but keeping the shape of the coarse mesh: straight, horizontal and symmetric parts stay so."""

from __future__ import annotations

from dataclasses import dataclass

from ...geometry.mesh import Mesh
from ...parameters import check_not_negative
from ..area import Area
from ..weighted_sum import BoundSum
from .arap import boundary_cells
from .shape_matching import ScaleFit


@dataclass(frozen=True)
class ShapeKeeping:
    """Area + strength · ½ L Σ min |z' - s p'|² over the cells of `BoundaryARAP`, with a scale s per cell.

    Each part of the cage may scale, but not turn, at no cost. The area alone is indefinite and rounding decides to
    which side an edge rolls; this energy keeps a symmetric coarse mesh symmetric.
    """

    strength: float = 3.0
    """Weight relative to the area, at least 0. The default is the smallest that kept symmetric shapes symmetric
    (measured)."""

    def __post_init__(self) -> None:
        check_not_negative(self, "strength")

    def at(self, coarse: Mesh) -> BoundSum:
        """The energy of a cage whose rest shape is the coarse mesh."""
        return BoundSum(((1.0, Area()), (self.strength, boundary_cells(coarse, ScaleFit()))))
