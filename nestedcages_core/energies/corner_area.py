"""The weighted area between a convex cage and its hull, corner by corner."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..decimation.outline import Outline
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE
from ..geometry.vectors import cross, norm, rotated_right
from .base import Blocks, CageEnergy


class Corners(NamedTuple):
    """What the edges before and after each vertex of a cage touch."""

    before: FloatArray
    """(m, 2) p, a point of the hull."""
    after: FloatArray
    """(m, 2) q."""
    weight: FloatArray
    """(m,) w, the mean weight of the hull from p to q."""
    inside: FloatArray
    """(m,) twice the area between p q and the hull."""


@dataclass(frozen=True, eq=False)
class CornerArea(CageEnergy):
    """½ Σ w ((v - p) × (q - v) - A) over the vertices v: the area between cage and hull, as line cycles weigh it."""

    cage: Mesh
    outlines: tuple[Outline, ...]
    """The hulls, loop by loop, with their weights."""
    weighted: CageEnergy
    """The weighted energy of other cages, for grids."""

    @classmethod
    def of(
        cls, cage: Mesh, hull: Mesh, weight_at: Callable[[FloatArray], FloatArray], weighted: CageEnergy
    ) -> CornerArea:
        """The energy of a cage whose loops are around those of a hull; weights (P,) at points (P, 2)."""
        loops = [hull.vertices[loop] for loop in hull.loops]
        return cls(cage, tuple(Outline.of(loop, weight_at(loop)) for loop in loops), weighted)

    def corners(self, cage: FloatArray) -> Corners:
        """What the edges of a cage (m, 2) touch."""
        at = Corners(np.empty_like(cage), np.empty_like(cage), np.empty(len(cage)), np.empty(len(cage)))
        for loop, outline in zip(self.cage.loops, self.outlines, strict=True):
            place, point = _touched(outline, cage[loop])
            begin, start = np.roll(place, 1), np.roll(point, 1, axis=0)
            swept = _swept(outline, place, point)
            way = swept - np.roll(swept, 1) + np.where(place < begin, outline.areas[0], 0.0)
            at.before[loop], at.after[loop], at.weight[loop] = start, point, outline.mean_weight(begin, place)
            at.inside[loop] = way - cross(start - outline.vertices[0], point - outline.vertices[0])
        return at

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """A length²."""
        at = self.corners(vertices)
        return 0.5 * float(at.weight @ (cross(vertices - at.before, at.after - vertices) - at.inside))

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) that of other cages."""
        return self.weighted.on_edge(vertex, start, end)

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        at = self.corners(vertices)
        gradient: FloatArray = 0.5 * at.weight[:, None] * rotated_right(at.after - at.before)
        return gradient

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """None, as long as edges touch the same points."""
        return Blocks.sum([])


def _swept(outline: Outline, place: FloatArray, point: FloatArray) -> FloatArray:
    """(k,) twice the area swept from the first vertex of a outline to points (k, 2) at places (k,)."""
    edge = place.astype(np.int64)
    start = outline.vertices[edge] - outline.vertices[0]
    return np.asarray(outline.swept[edge] + cross(start, point - outline.vertices[0]))


def _touched(outline: Outline, cage: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(k,) places on a convex outline that the edges of a cage (k, 2) around it touch, the middle of an edge that lies
    along one, and (k, 2) the points there."""
    along = np.roll(cage, -1, axis=0) - cage
    height = rotated_right(along / norm(along)[:, None]) @ outline.vertices.T
    touched = height >= height.max(axis=1)[:, None] - NEGLIGIBLE * outline.length
    first = np.argmax(touched & ~np.roll(touched, 1, axis=1), axis=1)
    place = np.mod(first + 0.5 * (touched.sum(axis=1) - 1), outline.size)
    edge = place.astype(np.int64)
    return place, outline.vertices[edge] + (place - edge)[:, None] * outline.edges[edge]
