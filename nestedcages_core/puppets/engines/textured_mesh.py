"""What the mesh of a painted part has: its hull, points inside, triangles, weights of bones, and pixels."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...formats.pictures.png import Pixels
from ...geometry.arrays import FloatArray, IntArray
from .bending import FINEST_WEIGHT

MOST_BONES = 4
"""Bones of a point that engines take."""


@dataclass(frozen=True)
class Placement:
    """Where the canvas lies in the puppet's coordinates: pixels, y pointing up, 0 below the middle of the canvas."""

    width: int
    height: int

    def up(self, canvas: FloatArray) -> FloatArray:
        """Points (n, 2) of the canvas, whose y points down, in the puppet."""
        return np.asarray((canvas - (0.5 * self.width, self.height)) * (1.0, -1.0))

    def down(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) of the puppet on the canvas."""
        return np.asarray(points * (1.0, -1.0) + (0.5 * self.width, self.height))


@dataclass(frozen=True, eq=False)
class PartMesh:
    """A textured mesh that bones move."""

    name: str
    part: str
    """Path of the layer: its groups and name, with slashes between."""
    points: FloatArray
    """(n, 2) pixels, y pointing up; the hull first, in order."""
    hull: int
    """Number of points on the hull."""
    triangles: IntArray
    """(T, 3), counter-clockwise."""
    weights: FloatArray = field(repr=False)
    """(n, B) of all bones, rows of sum 1, at most four not 0."""
    left: int
    top: int
    pixels: Pixels = field(repr=False)
    """(h, w, 4) at this place on the canvas; opacity is in them."""
    blend: str = "normal"
    is_visible: bool = True

    @property
    def strongest(self) -> int:
        """The bone that moves the mesh most."""
        return int(self.weights.sum(axis=0).argmax())


def engine_weights(weights: FloatArray) -> FloatArray:
    """Weights (n, B) as engines take them: not negative, at most four in a row, rows of sum 1 in float32 too."""
    kept = np.maximum(weights, 0.0)
    order = np.argsort(-kept, axis=1, kind="stable")
    np.put_along_axis(kept, order[:, MOST_BONES:], 0.0, axis=1)
    kept = np.round(kept / kept.sum(axis=1, keepdims=True) / FINEST_WEIGHT) * FINEST_WEIGHT
    rows = np.arange(len(kept))
    kept[rows, order[:, 0]] += 1.0 - kept.sum(axis=1)
    return np.asarray(kept)
