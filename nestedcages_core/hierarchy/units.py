"""Between the units of the input and those of the solvers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .settings import DEFAULT_CLEARANCE

ROUNDING_ALLOWANCE = 1e-7
"""The solvers aim this much, relatively, beyond the wanted clearance, so that going back to the input's units cannot
eat it."""

ROUNDING_ULPS = 8.0
"""And this many roundings of the largest coordinate, which matter for shapes far from the origin."""

SMALLER_CLEARANCE = 0.1
"""Factor on the default clearance where the gaps of the fine mesh leave no room for it."""

LARGEST_CLEARANCE = 1e6
"""Diagonals of the fine mesh beyond which a clearance leaves nothing of its shape to floating-point numbers."""

SMALLEST_DEFAULT_CLEARANCE = 1e-12
"""Fraction of the diagonal below which the default clearance is not lowered any more."""


@dataclass(frozen=True)
class Frame:
    """Units of the solvers: the fine mesh's bounding box has its centre at the origin and a diagonal of 1."""

    centre: FloatArray
    scale: float
    largest: float
    """Largest coordinate of the input, which sets the size of its roundings."""

    @classmethod
    def of(cls, fine: Mesh) -> Frame:
        low, high = fine.vertices.min(axis=0), fine.vertices.max(axis=0)
        return cls(low + 0.5 * (high - low), fine.diagonal, float(np.abs(fine.vertices).max()))

    def inside(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) in the units of the solvers."""
        return (points - self.centre) / self.scale

    def outside(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) in the units of the input."""
        return points * self.scale + self.centre

    def length(self, clearance: float) -> float:
        """A clearance in the units of the solvers, with room for the roundings on the way back."""
        rounding = ROUNDING_ULPS * float(np.finfo(float).eps) * self.largest
        return (clearance * (1.0 + ROUNDING_ALLOWANCE) + rounding) / self.scale


@dataclass(frozen=True)
class Clearance:
    """The clearance in the input's units, and whether it may be lowered."""

    length: float
    negotiable: bool
    diagonal: float

    @classmethod
    def of(cls, wanted: float | None, fine: Mesh) -> Clearance:
        if wanted is None:
            return cls(DEFAULT_CLEARANCE * fine.diagonal, True, fine.diagonal)
        if wanted > LARGEST_CLEARANCE * fine.diagonal:
            raise NestingError(
                f"The clearance {wanted:.6g} is more than {LARGEST_CLEARANCE:.0g} times as long as the diagonal of the "
                f"fine mesh, {fine.diagonal:.6g}; ask for less."
            )
        return cls(wanted, False, fine.diagonal)

    def options(self) -> Iterator[float]:
        """Clearances to try, the wanted one first."""
        length = self.length
        yield length
        while self.negotiable and length * SMALLER_CLEARANCE >= SMALLEST_DEFAULT_CLEARANCE * self.diagonal:
            length *= SMALLER_CLEARANCE
            yield length
