"""What constraints say of candidate lines."""

from __future__ import annotations

from typing import Protocol

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from .chain import Chain, Lines
from .places import NormalFrame


class LineRule(Protocol):
    """A constraint, as the search for lines sees it; see `nestedcages_core.constraints.Constraint`."""

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The least length of an edge, in the input's units, and angle, in degrees."""

    def distances(self, fine: Mesh) -> FloatArray | None:
        """(L,) distance from each loop of a mesh, in the input's units; None: none."""

    def candidates(self, chain: Chain, at: IntArray, lines: Lines, frame: NormalFrame, shift: float) -> Lines:
        """The candidate lines, or others; see `Constraint`."""

    def reach(self, chain: Chain, lines: Lines, shift: float) -> FloatArray:
        """(2, K) how far these run from their contacts forwards and backwards."""

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """(2, K) how far lines run forwards and backwards, in the units of the frame; negative: not at all."""
