"""What decimations are told of the places on a shape that matter."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.loops import Loops


class ImportanceMap(Protocol):
    """What a need says of a shape to a decimation, in input units."""

    @property
    def weights(self) -> FloatArray | None: ...
    def at(self, points: FloatArray) -> FloatArray:
        """(P,) weight at the closest place on the shape to each of the points (P, 2)."""

    def pinned(self, outline: Loops) -> BoolArray:
        """(n,) the vertices of an outline that the decimation keeps."""

    def with_vertices(self, outline: Loops, most: float = np.inf) -> Loops:
        """The outline with additional vertices at places that keep one, as long as it has at most so many."""
