"""What constraints say of candidate lines."""

from __future__ import annotations

from typing import Protocol

from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from .chain import Lines
from .places import NormalFrame


class LineRule(Protocol):
    """A constraint, as the search for lines sees it; see `nestedcages_core.constraints.Constraint`."""

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The least length of an edge, in the input's units, and angle, in degrees."""

    def distances(self, fine: Mesh) -> FloatArray | None:
        """(L,) distance from each loop of a mesh, in the input's units; None: none."""

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """(2, K) how far lines run forwards and backwards, in the units of the frame; negative: not at all."""
