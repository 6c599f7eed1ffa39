"""Contours of a field on a grid by marching squares (Lorensen & Cline 1987 in the plane)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
import scipy

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.signed_distance import SignedDistance

END_MARGIN = 0.01
"""Distance of contour points from the ends of their grid edge, as a fraction of it, so that no two coincide."""


@dataclass(frozen=True, eq=False)
class Field:
    """Values on the points of a square grid."""

    origin: FloatArray
    """(2,) the point of value [0, 0]."""
    cell: float
    """Distance between neighbouring points."""
    values: FloatArray
    """(X, Y)."""

    @classmethod
    def signed_distance(cls, mesh: Mesh, cell: float, pad: float) -> Field:
        """Signed distance to a mesh on a grid padded by ``pad``; -cell deep inside."""
        origin = mesh.vertices.min(axis=0) - pad
        size = np.ceil((mesh.vertices.max(axis=0) + pad - origin) / cell).astype(np.int64) + 1
        x, y = (origin[axis] + cell * np.arange(size[axis]) for axis in (0, 1))
        points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        distance = SignedDistance.of(mesh)
        outside = distance.winding(points) == 0
        wanted = scipy.ndimage.binary_dilation(outside.reshape(size), np.ones((3, 3))).ravel()
        values = np.full(len(points), -cell)
        values[wanted] = distance.at(points[wanted]).distance
        return cls(origin, cell, values.reshape(size))

    def contour(self, level: float) -> Mesh | None:
        """The boundary of the region below a level, as a mesh; None if that is empty.

        The level must be below all values on the rim of the grid.
        """
        inside = self.values < level
        if not inside.any():
            return None
        starts, ends = _segments(inside, self._middles < level)
        used, joined = np.unique(np.concatenate((starts, ends)), return_inverse=True)
        return Mesh(self._points(used, level), joined.reshape(2, -1).T)

    @cached_property
    def _middles(self) -> FloatArray:
        """(X - 1, Y - 1) values at the cell centres, which resolve ambiguous cells."""
        v = self.values
        middles: FloatArray = 0.25 * (v[:-1, :-1] + v[1:, :-1] + v[:-1, 1:] + v[1:, 1:])
        return middles

    def _points(self, edges: IntArray, level: float) -> FloatArray:
        """(K, 2) points at the level on edges of the grid, numbered as by `_edges`."""
        rows = self.values.shape[1]
        upright = edges % 2
        x, y = np.divmod(edges // 2, rows)
        here, there = self.values[x, y], self.values[x + (1 - upright), y + upright]
        t = np.clip((level - here) / (there - here), END_MARGIN, 1.0 - END_MARGIN)
        steps = np.stack((x + t * (1 - upright), y + t * upright), axis=1)
        points: FloatArray = self.origin + self.cell * steps
        return points


def _edges(shape: tuple[int, ...]) -> IntArray:
    """(4, X - 1, Y - 1) numbers of the lower, right, upper and left edge of each cell.

    The edge from point (x, y) to the right has the number 2 (x Y + y), the one upwards the next.
    """
    point = np.arange(shape[0] * shape[1]).reshape(shape)
    return np.stack((2 * point[:-1, :-1], 2 * point[1:, :-1] + 1, 2 * point[:-1, 1:], 2 * point[:-1, :-1] + 1))


LOWER, RIGHT, UPPER, LEFT = range(4)

Turns: TypeAlias = tuple[tuple[int, int], ...]

TURNS: dict[int, Turns] = {
    1: ((LOWER, LEFT),),
    2: ((RIGHT, LOWER),),
    3: ((RIGHT, LEFT),),
    4: ((UPPER, RIGHT),),
    6: ((UPPER, LOWER),),
    7: ((UPPER, LEFT),),
    8: ((LEFT, UPPER),),
    9: ((LOWER, UPPER),),
    11: ((RIGHT, UPPER),),
    12: ((LEFT, RIGHT),),
    13: ((LOWER, RIGHT),),
    14: ((LEFT, LOWER),),
}
"""For each case (corners inside: 1 lower left, 2 lower right, 4 upper right, 8 upper left) the edges where the contour
enters and leaves, with the inside on its left."""

SADDLES: dict[tuple[int, bool], Turns] = {
    (5, True): ((LOWER, RIGHT), (UPPER, LEFT)),
    (5, False): ((LOWER, LEFT), (UPPER, RIGHT)),
    (10, True): ((LEFT, LOWER), (RIGHT, UPPER)),
    (10, False): ((RIGHT, LOWER), (LEFT, UPPER)),
}
"""The same for opposite corners inside, with the centre inside or not."""


def _segments(inside: BoolArray, middle: BoolArray) -> tuple[IntArray, IntArray]:
    """(S,) numbers of the grid edges at the start and the end of the segments of the contour."""
    case = inside[:-1, :-1] + 2 * inside[1:, :-1] + 4 * inside[1:, 1:] + 8 * inside[:-1, 1:]
    edges = _edges(inside.shape)
    starts, ends = [], []
    chosen = [(case == number, turns) for number, turns in TURNS.items()]
    chosen += [((case == number) & (middle == joined), turns) for (number, joined), turns in SADDLES.items()]
    for where, turns in chosen:
        for start, end in turns:
            starts.append(edges[start][where])
            ends.append(edges[end][where])
    return np.concatenate(starts), np.concatenate(ends)
