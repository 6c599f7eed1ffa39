"""Between the units of the input and those of the solvers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.precision import ROUNDING_ULPS
from ..geometry.vectors import bounds
from ..tightening.tightening import CLEARANCE_MARGIN

Method = TypeVar("Method")


@runtime_checkable
class AbsoluteLengths(Protocol):
    """A flow or contact that may have lengths in the units of the input."""

    def scaled(self, factor: float) -> Any:
        """The same method for meshes scaled by a factor."""


@dataclass(frozen=True)
class SolverUnits:
    """Units of the solvers: the fine mesh's bounding box has its centre at the origin and a diagonal of 1."""

    centre: FloatArray
    """(2,)."""
    scale: float
    rounding: float
    """Bound on what rounding takes from a clearance, in the units of the input."""

    @classmethod
    def of(cls, fine: Mesh, room: float = 0.0) -> SolverUnits:
        """The units for a mesh; room: what rounding to the numbers that a cage is stored in may take."""
        low, high = bounds(fine.vertices)
        rounding = ROUNDING_ULPS * float(np.finfo(float).eps) * float(np.abs(fine.vertices).max())
        return cls(low + 0.5 * (high - low), fine.diagonal, rounding + room)

    def from_input(self, mesh: Mesh) -> Mesh:
        """A mesh of the input in the units of the solvers."""
        return mesh.moved(self.points(mesh.vertices))

    def points(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) of the input in the units of the solvers."""
        return (points - self.centre) / self.scale

    def to_input(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) in the units of the input."""
        return points * self.scale + self.centre

    def method(self, method: Method) -> Method:
        """A flow or contact with its lengths in the units of the solvers, if it has absolute ones."""
        return method.scaled(1.0 / self.scale) if isinstance(method, AbsoluteLengths) else method

    def clearance(self, length: float) -> float:
        """A clearance of the input in the units of the solvers, with a margin for rounding."""
        return (length * (1.0 + CLEARANCE_MARGIN) + self.rounding) / self.scale
