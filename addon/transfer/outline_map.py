"""Places of the vertices of a new outline along an old one, so that values of the old vertices carry over."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..core import core, distance
from ..errors import FloatArray

IntArray: TypeAlias = NDArray[np.int64]

# Smallest overlap of the boxes of two loops on each axis, as a fraction of their common range, to compare them in
# place; otherwise the new loop is first scaled into the box of the old one.
SHARED_RANGE = 0.5
# Distances that are computed at once.
CHUNK = 2_000_000


@dataclass(frozen=True)
class OutlineMap:
    """For each new vertex, the ends (m,) of the edge of the old outline that it lies on, and its parameter there."""

    first: IntArray
    second: IntArray
    part: FloatArray

    @classmethod
    def identity(cls, count: int) -> OutlineMap:
        """The identity."""
        return cls(np.arange(count), np.arange(count), np.zeros(count))

    def of(self, values: NDArray[Any]) -> FloatArray:
        """Values (n, ...) of the old vertices at the new ones, (m, ...)."""
        part = self.part.reshape(-1, *(1 for _ in values.shape[1:]))
        mixed: FloatArray = (1.0 - part) * values[self.first] + part * values[self.second]
        return mixed

    def nearest(self, points: FloatArray, old: int) -> int:
        """The new vertex nearest to an old one along the old outline with vertices (n, 3)."""
        return int(((self.of(points) - points[old]) ** 2).sum(axis=1).argmin())


@dataclass(frozen=True)
class Outline:
    """Vertices (n, 3), edges (m, 2) from each vertex to the next, with the inside on the left, and the loop (n,) of
    each vertex. Edges that make no outline are one loop without sides.
    """

    points: FloatArray
    edges: IntArray
    loop: IntArray
    sided: bool

    @classmethod
    def of(cls, points: FloatArray, edges: IntArray) -> Outline:
        """The outline of any edges."""
        try:
            mesh = core.Mesh(points[:, :2], edges)
        except core.NestedCagesError:
            return cls(points, edges, np.zeros(len(points), np.int64), False)
        loop = np.zeros(len(points), np.int64)
        for number, vertices in enumerate(mesh.loops):
            loop[np.asarray(vertices)] = number
        ends = np.column_stack([np.arange(len(points)), np.asarray(mesh.successor)])
        return cls(points, ends, loop, True)

    def box(self, loop: int) -> FloatArray:
        """Lower and upper corner (2, 2) of a loop."""
        points = self.points[self.loop == loop, :2]
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def turns_left(self, loop: int) -> bool:
        """Whether the loop bounds an area, not a hole."""
        own = self.edges[self.loop[self.edges[:, 0]] == loop]
        start, end = self.points[own[:, 0], :2], self.points[own[:, 1], :2]
        return float((start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]).sum()) > 0.0

    @property
    def directions(self) -> FloatArray:
        """Unit directions (m, 2) of the edges."""
        along = self.points[self.edges[:, 1], :2] - self.points[self.edges[:, 0], :2]
        units: FloatArray = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(float).tiny)
        return units


def outline_map(old: Outline, new: Outline) -> OutlineMap:
    """Maps each new vertex to the nearest point of the old outline, loop by loop, on an edge that faces the same way.

    Loops are matched by their boxes if there are equally many, otherwise all old loops are searched.
    """
    if not len(old.edges):
        same = np.array([((old.points - point) ** 2).sum(axis=1).argmin() for point in new.points], dtype=np.int64)
        return OutlineMap(same, same, np.zeros(len(same)))
    if not (old.sided and new.sided):
        return _nearest(old, np.ones(len(old.edges), bool), new.points[:, :2], None)
    first, second, part = np.empty(len(new.points), int), np.empty(len(new.points), int), np.empty(len(new.points))
    matched = _matched(old, new)
    tangents = np.zeros((len(new.points), 2))
    for side in (0, 1):
        np.add.at(tangents, new.edges[:, side], new.directions)
    for number, partner in enumerate(matched):
        chosen = new.loop == number
        points, among = new.points[chosen, :2], np.ones(len(old.edges), bool)
        if partner is not None:
            among = old.loop[old.edges[:, 0]] == partner
            points = _into(points, new.box(number), old.box(partner))
        nearest = _nearest(old, among, points, tangents[chosen])
        first[chosen], second[chosen], part[chosen] = nearest.first, nearest.second, nearest.part
    return OutlineMap(first, second, part)


def _matched(old: Outline, new: Outline) -> list[int | None]:
    """The old loop for each new one: the nearest box among unused loops of the same direction."""
    count = int(new.loop.max()) + 1
    if count != int(old.loop.max()) + 1:
        return [None] * count
    distances = np.array(
        [
            [
                np.linalg.norm(new.box(i) - old.box(j)) if new.turns_left(i) == old.turns_left(j) else np.inf
                for j in range(count)
            ]
            for i in range(count)
        ]
    )
    matched: list[int | None] = [None] * count
    for _ in range(count):
        i, j = np.unravel_index(np.argmin(distances), distances.shape)
        if not np.isfinite(distances[i, j]):
            break
        matched[int(i)] = int(j)
        distances[i], distances[:, j] = np.inf, np.inf
    return matched


def _into(points: FloatArray, box: FloatArray, other: FloatArray) -> FloatArray:
    """Points (k, 2) of a box (2, 2), scaled into another one if these overlap little."""
    common = np.minimum(box[1], other[1]) - np.maximum(box[0], other[0])
    whole = np.maximum(box[1], other[1]) - np.minimum(box[0], other[0])
    if (common >= SHARED_RANGE * whole).all():
        return points
    size = np.maximum(box[1] - box[0], np.finfo(float).tiny)
    scaled: FloatArray = other[0] + (points - box[0]) / size * (other[1] - other[0])
    return scaled


def _nearest(old: Outline, among: NDArray[np.bool_], points: FloatArray, tangents: FloatArray | None) -> OutlineMap:
    """The nearest points on some edges, on those in the direction of the tangents (k, 2) if there are any."""
    edges, directions = old.edges[among], old.directions[among]
    start, end = (old.points[edges[:, side], :2] for side in (0, 1))
    chosen, part = np.empty(len(points), int), np.empty(len(points))
    step = max(1, CHUNK // len(edges))
    for begin in range(0, len(points), step):
        rows = slice(begin, begin + step)
        near = distance.point_edge(points[rows, None], start, end)
        apart = near.distance
        if tangents is not None:
            facing = tangents[rows] @ directions.T > 0.0
            facing |= ~facing.any(axis=1, keepdims=True)
            apart = np.where(facing, apart, np.inf)
        best = np.argmin(apart, axis=1)
        chosen[rows], part[rows] = best, near.parameter[np.arange(len(best)), best]
    return OutlineMap(edges[chosen, 0], edges[chosen, 1], part)
