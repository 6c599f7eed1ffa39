"""Contours of a field on a grid by marching squares (Lorensen & Cline 1987 in the plane)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from nestedcages_core.geometry.arrays import BoolArray, FloatArray, IntArray
from nestedcages_core.geometry.mesh import Mesh
from nestedcages_core.geometry.signed_distance import SignedDistance

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
        used, joined = np.unique(_segments(inside, self._middles < level), return_inverse=True)
        return Mesh(self._points(used, level), joined.reshape(-1, 2))

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


def _segments(inside: BoolArray, middle: BoolArray) -> IntArray:
    """(S, 2) numbers of the grid edges at the ends of the segments of the contour."""
    corners = np.stack((inside[:-1, :-1], inside[1:, :-1], inside[1:, 1:], inside[:-1, 1:]))
    crossed = corners != np.roll(corners, -1, axis=0)
    edges, twice = _edges(inside.shape), crossed.sum(axis=0) == 2
    pairs: list[IntArray] = [edges[:, twice].T[crossed[:, twice].T]]
    for shift, joined in enumerate((middle == corners[0], middle != corners[0])):  # opposite corners inside
        pairs.append(np.roll(edges[:, crossed.all(axis=0) & joined], shift, axis=0).T.ravel())
    return np.concatenate(pairs).reshape(-1, 2)
