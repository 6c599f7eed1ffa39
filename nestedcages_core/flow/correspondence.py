"""Correspondence: the fine loops are laid along the inside of the coarse ones, vertices in order.

The eroded coarse mesh lies inside the coarse mesh, and a fine loop that visits all its corners in order is the same
curve. So this works for any pair of meshes, with slits of any width, if each coarse loop has one fine loop, with at
least as many vertices.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.distance import SMALLEST_LENGTH
from ..geometry.mesh import Mesh
from ..geometry.vectors import rotated_right
from .containment import Containment
from .erosion import erode
from .loop_matching import Matching

MAX_ASSIGNMENTS = 50_000_000
"""Cap on the pairs of a fine and a coarse vertex of one loop: limits the memory to 200 MB."""

FACING_WEIGHT = 1e-3
"""Weight of 1 - n · n' relative to squared distances in extents of the fine mesh: separates the sides of a slit."""


def lay_along(matching: Matching, distance: float) -> FloatArray | None:
    """Positions (n, 2) of the fine mesh along the coarse boundary, about ``distance`` inside; None on failure."""
    fine, coarse = matching.fine, matching.coarse
    if sorted(matching.partner.tolist()) != list(range(len(coarse.loops))):
        return None
    pairs = [(fine.loops[k], coarse.loops[partner]) for k, partner in enumerate(matching.partner)]
    if any(len(loop) < len(corners) or len(loop) * len(corners) > MAX_ASSIGNMENTS for loop, corners in pairs):
        return None
    itself = Matching(coarse, coarse, np.arange(len(matching.component)), np.arange(len(coarse.loops)))
    eroded = erode(coarse, Containment(itself), distance)
    if eroded is None:
        return None
    fine_normals, coarse_normals = _normals(fine), _normals(coarse)
    laid = np.empty_like(fine.vertices)
    for loop, corners in pairs:
        cost = _Cost(
            fine.vertices[loop] / fine.extent,
            fine_normals[loop],
            coarse.vertices[corners] / fine.extent,
            coarse_normals[corners],
        )
        first, begin = cost.best_pair()
        chosen = _in_order(cost.begun_at(first, begin))
        begun = np.roll(loop, -first)
        laid[begun] = _between(fine, begun, chosen, np.roll(eroded[corners], -begin, axis=0))
    return laid


class _Cost(NamedTuple):
    """Cost of N vertices of a fine loop at M corners of its coarse loop; lengths in extents of the fine mesh."""

    points: FloatArray
    normals: FloatArray
    corners: FloatArray
    corner_normals: FloatArray

    def of(self, corner: int) -> FloatArray:
        """(N,) cost of each vertex for one corner: squared distance and difference of the normals."""
        away = self.points - self.corners[corner]
        facing = self.normals @ self.corner_normals[corner]
        return np.asarray((away * away).sum(axis=1) + FACING_WEIGHT * (1.0 - facing), np.float64)

    def best_pair(self) -> tuple[int, int]:
        """The vertex and the corner of least cost."""
        corner = int(np.argmin([self.of(corner).min() for corner in range(len(self.corners))]))
        return int(self.of(corner).argmin()), corner

    def begun_at(self, first: int, begin: int) -> _Cost:
        """The same with vertices and corners numbered from other ones."""
        shifts = (first, first, begin, begin)
        return _Cost(*(np.roll(array, -shift, axis=0) for array, shift in zip(self, shifts, strict=True)))


def _in_order(cost: _Cost) -> IntArray:
    """(M,) increasing vertices, one per corner, with vertex 0 for corner 0, of least total cost."""
    vertices, corners = len(cost.points), len(cost.corners)
    best = np.full(vertices, np.inf)
    best[0] = 0.0
    origin = np.zeros((corners, vertices), np.int32)
    for corner in range(1, corners):
        least = np.minimum.accumulate(best)
        where = np.maximum.accumulate(np.where(best == least, np.arange(vertices), 0))
        origin[corner, 1:] = where[:-1]
        best = np.append(np.inf, least[:-1]) + cost.of(corner)
        best[vertices - corners + corner + 1 :] = np.inf
    chosen = np.empty(corners, np.int64)
    chosen[-1] = best.argmin()
    for corner in range(corners - 1, 0, -1):
        chosen[corner - 1] = origin[corner, chosen[corner]]
    return chosen


def _between(mesh: Mesh, loop: IntArray, chosen: IntArray, corners: FloatArray) -> FloatArray:
    """(N, 2) positions of a loop with the vertices ``chosen`` at the corners and the others between, by arc length."""
    length = np.concatenate([[0.0], np.cumsum(np.maximum(mesh.edge_lengths[loop], SMALLEST_LENGTH))])
    group = np.searchsorted(chosen, np.arange(len(loop)), side="right") - 1
    begin = length[chosen]
    finish = np.append(begin[1:], length[-1])
    share = (length[:-1] - begin[group]) / (finish - begin)[group]
    following = np.roll(corners, -1, axis=0)
    laid = corners[group] + share[:, None] * (following - corners)[group]
    laid[chosen] = corners
    return np.asarray(laid, np.float64)


def _normals(mesh: Mesh) -> FloatArray:
    """(n, 2) outward unit normals at the vertices, from the chord of both edges."""
    chord = mesh.vertices[mesh.successor] - mesh.vertices[mesh.predecessor]
    length = np.maximum(np.hypot(chord[:, 0], chord[:, 1]), SMALLEST_LENGTH)
    return np.asarray(rotated_right(chord) / length[:, None], np.float64)
