"""A rectangle that the cage stays in."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from .half_planes import HalfPlanes

NORMALS = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])


@dataclass(frozen=True)
class Box(HalfPlanes):
    """No vertex of the cage lies outside of a rectangle along the axes."""

    low: tuple[float, float]
    """The corner of least x and y; infinite: no limit."""
    high: tuple[float, float]
    must: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        try:
            low, high = (np.asarray(corner, np.float64).reshape(2) for corner in (self.low, self.high))
        except (TypeError, ValueError):
            raise invalid_setting(f"Box: {self.low!r} and {self.high!r} must be corners (x, y).") from None
        if not (low < high).all():
            raise invalid_setting(f"Box: {self.low!r} must lie below and left of {self.high!r}.")
        object.__setattr__(self, "low", tuple(low.tolist()))
        object.__setattr__(self, "high", tuple(high.tolist()))

    def planes(self) -> tuple[FloatArray, FloatArray]:
        """The sides that are not infinite."""
        offsets = np.array([self.low[0], -self.high[0], self.low[1], -self.high[1]])
        finite = np.isfinite(offsets)
        return NORMALS[finite], offsets[finite]
