"""Simple nested cages (in Sellán et al. 2022): a level set, decimated, at the smallest offset that encloses the mesh.

The level set is shapely's round buffer instead of a contour on a grid. Holes may close and parts may merge, as there.
`edge_collapse` makes the coarse meshes of Nested Cages (2015) as well.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from nestedcages_core import InvalidMeshError, Mesh, NestingError
from peers import corners, searched, solid

POINTS_PER_VERTEX = 8  # maximum number of contour points per wanted vertex that are collapsed
FIRST_OFFSET, OFFSET_GROWTH, BISECTIONS = 2e-3, 1.6, 6
"""In diagonals; factor to the next while none encloses; halvings between the last that did not and the first."""
MIDPOINT_WEIGHT = 1e-3
"""Weight of the distance to the middle of an edge, relative to that of its lines: decides for parallel lines."""


@dataclass(frozen=True)
class Decimation:
    """One of the two functions below as a decimation."""

    make: Callable[[Mesh, int], Mesh]

    def decimate(self, fine: Mesh, count: int, *, clearance: float = 0.0) -> Mesh:
        return self.make(fine, count)


def level_set(fine: Mesh, count: int) -> Mesh:
    """A coarse mesh that encloses the fine one; its loops may be others. Raises NestingError."""
    shape = solid(fine)

    def enclosing(offset: float) -> Mesh | None:
        contour = shape.buffer(offset, quad_segs=16)
        most = POINTS_PER_VERTEX * count
        if corners(contour) > most:
            contour = searched(contour.simplify, most, 1e-6 * fine.diagonal, 0.1 * fine.diagonal)
        try:
            coarse = edge_collapse(Mesh.from_geometry(contour), count)
        except (InvalidMeshError, NestingError):
            return None
        return coarse if solid(coarse).contains_properly(shape) else None

    below, offset = 0.0, FIRST_OFFSET * fine.diagonal
    while (found := enclosing(offset)) is None:
        below, offset = offset, OFFSET_GROWTH * offset
        if offset > 2.0 * fine.diagonal:
            raise NestingError(f"No level set encloses the mesh with {count} vertices.", code="count.too_small")
    for _ in range(BISECTIONS):
        middle = 0.5 * (below + offset)
        tighter = enclosing(middle)
        below, offset, found = (middle, offset, found) if tighter is None else (below, middle, tighter)
    return found


def edge_collapse(fine: Mesh, count: int) -> Mesh:
    """The fine mesh with so many vertices near it, loop k on loop k (Garland & Heckbert 1997). Raises NestingError."""
    state = _Collapsing(fine)
    made = True
    while state.total > count and made:
        made, heap = False, [move for v in np.flatnonzero(state.alive) if (move := state.move(v))]
        heapq.heapify(heap)
        while state.total > count and heap:
            _, v, stamp, place = heapq.heappop(heap)
            if state.stamp[v] == stamp and state.alive[v] and state.make(v, np.array(place)):
                made = True
                heap_moves = (state.move(u) for u in state.around(v))
                for move in filter(None, heap_moves):
                    heapq.heappush(heap, move)
    if state.total > count:
        raise NestingError(f"The loops block each other at {state.total} vertices.", code="count.too_small")
    return Mesh.from_loops(state.loops())


class _Collapsing:
    """Vertices in linked loops. The move of b in a chain a, b, c, d makes b and c one vertex, where the sum of their
    quadrics, Σ l (n · (x - p))² over the fine edges that came together in them, is least."""

    def __init__(self, fine: Mesh) -> None:
        self.centre, self.size = fine.vertices.mean(axis=0), fine.diagonal
        self.x = (fine.vertices - self.centre) / self.size
        self.next, self.before = fine.successor.copy(), fine.predecessor.copy()
        self.alive, self.stamp = np.ones(len(self.x), bool), np.zeros(len(self.x), int)
        self.starts = [loop[0] for loop in fine.loops]
        self.left = np.zeros(len(self.x), int)
        self.loop_of = np.zeros(len(self.x), int)
        for k, loop in enumerate(fine.loops):
            self.loop_of[loop], self.left[k] = k, len(loop)
        edge = self.x[self.next] - self.x
        length = np.hypot(edge[:, 0], edge[:, 1])
        nx, ny = edge[:, 1] / length, -edge[:, 0] / length
        off = nx * self.x[:, 0] + ny * self.x[:, 1]
        of_edge = length * np.stack((nx * nx, nx * ny, ny * ny, -off * nx, -off * ny, off * off))
        self.quadric = (of_edge + of_edge[:, self.before]).T

    @property
    def total(self) -> int:
        return int(self.alive.sum())

    def around(self, v: int) -> tuple[int, ...]:
        a = self.before[v]
        return self.before[a], a, v, self.next[v]

    def move(self, b: int) -> tuple[float, int, int, tuple[float, float]] | None:
        """Cost, vertex, stamp and place."""
        self.stamp[b] += 1
        c = self.next[b]
        if self.left[self.loop_of[b]] <= 3:
            return None
        xx, xy, yy, x1, y1, one = self.quadric[b] + self.quadric[c]
        anchor, middle = MIDPOINT_WEIGHT * (xx + yy), 0.5 * (self.x[b] + self.x[c])
        matrix = np.array([[xx + anchor, xy], [xy, yy + anchor]])
        at = np.linalg.solve(matrix, anchor * middle - [x1, y1])
        cost = xx * at[0] ** 2 + 2.0 * xy * at[0] * at[1] + yy * at[1] ** 2 + 2.0 * (x1 * at[0] + y1 * at[1]) + one
        return float(cost), int(b), int(self.stamp[b]), (float(at[0]), float(at[1]))

    def make(self, b: int, at: np.ndarray) -> bool:
        """Collapse unless something lies between the chains, or the new edges touch something."""
        a, c = self.before[b], self.next[b]
        d = self.next[c]
        if not self.is_free(a, b, c, d, at):
            return False
        self.quadric[b] += self.quadric[c]
        self.x[b], self.alive[c] = at, False
        self.next[b], self.before[d] = d, b
        k = self.loop_of[b]
        self.left[k] -= 1
        self.starts[k] = b
        return True

    def is_free(self, a: int, b: int, c: int, d: int, at: np.ndarray) -> bool:
        points, ends = self.x, self.x[self.next]
        A, B, C, D = points[[a, b, c, d]]
        others = self.alive.copy()
        others[[a, b, c, d]] = False
        for one, two in ((A, B), (B, C), (C, D)):
            sides = np.stack([_side(one, two, points), _side(two, at, points), _side(at, one, points)])
            if (others & ((sides >= 0.0).all(axis=0) | (sides <= 0.0).all(axis=0))).any():
                return False
        edges = self.alive.copy()
        edges[[a, b, c]] = False
        for own, shared in ((A, self.before[a]), (D, d)):  # an edge that the new one continues may not fold back
            apart = edges.copy()
            apart[shared] = False
            far = points[shared] if shared != d else ends[d]
            if abs(_side(own, at, far[None])[0]) < 1e-14 and (at - own) @ (far - own) > 0.0:
                return False
            crossed = (_side(own, at, points) * _side(own, at, ends) <= 0.0) & (
                (_side_of(points, ends, own) * _side_of(points, ends, at)) <= 0.0
            )
            if (apart & crossed).any():
                return False
        return abs(_side(A, at, D[None])[0]) > 1e-14 or (at - A) @ (D - at) > 0.0

    def loops(self) -> list[np.ndarray]:
        found = []
        for start in self.starts:
            loop, v = [start], self.next[start]
            while v != start:
                loop.append(v)
                v = self.next[v]
            found.append(self.x[loop] * self.size + self.centre)
        return found


def _side(a: np.ndarray, b: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Twice the areas of the triangles a, b, point."""
    return (b[0] - a[0]) * (points[:, 1] - a[1]) - (b[1] - a[1]) * (points[:, 0] - a[0])


def _side_of(starts: np.ndarray, ends: np.ndarray, point: np.ndarray) -> np.ndarray:
    edge, away = ends - starts, point - starts
    return edge[:, 0] * away[:, 1] - edge[:, 1] * away[:, 0]
