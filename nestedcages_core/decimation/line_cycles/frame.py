"""The frame of the search: an outline's own position, direction and size, so that none of these matters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.loops import Loops
from ...geometry.vectors import norm


@dataclass(frozen=True)
class Frame:
    """Units of an outline: diameter 1, centre at the origin, its first vertex on the x axis."""

    centre: FloatArray
    scale: float
    axis: FloatArray
    """(2,) unit vector to the first vertex."""

    @classmethod
    def of(cls, outline: Loops) -> Frame:
        """The frame of an outline in canonical order: it starts with a vertex far from the centre."""
        first = outline.vertices[0] - outline.centre
        return cls(outline.centre, outline.diameter, first / norm(first))

    def into(self, points: FloatArray) -> FloatArray:
        """Points (K, 2) of the input in this frame."""
        x, y = (points - self.centre).T / self.scale
        c, s = self.axis
        return np.stack((c * x + s * y, c * y - s * x), axis=1)

    def out_of(self, points: FloatArray) -> FloatArray:
        """Points (K, 2) of this frame in the input's units."""
        x, y = points.T
        c, s = self.axis
        moved: FloatArray = self.centre + self.scale * np.stack((c * x - s * y, s * x + c * y), axis=1)
        return moved
