"""Which edges of a cage, between points that are free themselves, keep their distance from a fine mesh."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import CACHED_PAIRS, near_pairs, split_by
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.vectors import cross, dot

FIRST_TESTED = 8
"""Number of the nearest parts of the fine mesh that edges are tested against first; then twice as many each time."""

MOST_TESTS = 1_000_000_000
"""Tests of an edge against a fine vertex or edge in one search: some ten seconds."""


class Near(NamedTuple):
    """What an edge of the cage may meet."""

    line: FloatArray
    """(2, 2) where it is in a cage that meets nothing."""
    corners: IntArray
    """(C,) fine vertices, nearest first."""
    lines: IntArray
    """(L,) fine edges by their starts."""


class FreeEdges:
    """The search among edges of one cage."""

    def __init__(self, cage: Mesh, fine: Mesh, clearance: float, wanted: str) -> None:
        """wanted: what the error says was not found."""
        self.cage, self.fine, self.clearance, self.wanted, self.tests = cage, fine, clearance, wanted, 0

    def near(self, starts: FloatArray, far: FloatArray) -> list[Near]:
        """What each edge may meet whose ends are within distances (m,) of the vertices (m, 2) of a cage."""
        fine, successor = self.fine, self.cage.successor
        m, n, ends = len(starts), len(fine.vertices), starts[successor]
        far = np.maximum(far, far[successor])
        radius = float(far.max()) + 2.0 * self.clearance
        corner, edge = near_pairs(fine.vertices, starts, ends, radius)
        distance = point_edge(fine.vertices[corner], starts[edge], ends[edge]).distance
        close = np.flatnonzero(distance <= far[edge] + 2.0 * self.clearance)
        close = close[np.argsort(distance[close], kind="stable")]
        corner, edge = corner[close], edge[close]
        point, line = near_pairs(starts, fine.vertices, fine.edge_ends, radius)
        owner = np.concatenate([edge, edge, point, self.cage.predecessor[point]])
        line = np.concatenate([corner, fine.predecessor[corner], line, line])
        owner, line = np.divmod(np.unique(owner * n + line), n)
        corners, lines = split_by(edge, m), split_by(owner, m)
        return [Near(np.stack((starts[k], ends[k])), corner[corners[k]], line[lines[k]]) for k in range(m)]

    def are_free(self, p: FloatArray, q: FloatArray, near: Near) -> BoolArray:
        """(K,) whether an edge between points (K, 2) keeps its distance. Raises NestingError."""
        free = np.arange(len(p))
        for members, meets in ((near.corners, self._meet_corners), (near.lines, self._meet_edges)):
            done, size = 0, FIRST_TESTED  # most edges that are not free meet one of the nearest
            while done < len(members) and len(free):
                part = members[done : done + size]
                self.tests += len(free) * len(part)
                if self.tests > MOST_TESTS:
                    raise NestingError(
                        f"{self.wanted} was found in {MOST_TESTS:,} tests of edges; ask for fewer vertices or a finer "
                        "grid.",
                        code="limit.exceeded",
                        what="grid",
                    )
                free = free[~meets(p[free], q[free], part).any(axis=1)]
                done, size = done + size, min(2 * size, max(1, CACHED_PAIRS // max(1, len(free))))
        for loop in self._passed(near.corners):
            free = free[_stays_beside(p[free], q[free], near.line, self.fine.vertices[self.fine.loops[loop][0]])]
        is_free = np.zeros(len(p), bool)
        is_free[free] = True
        return is_free

    def _meet_corners(self, p: FloatArray, q: FloatArray, corner: IntArray) -> BoolArray:
        """(K, C) whether fine vertices are too close to edges in between their ends."""
        d, away = (q - p)[:, None], self.fine.vertices[corner] - p[:, None]
        squared, ahead = dot(d, d), dot(d, away)
        near = np.abs(cross(d, away)) < self.clearance * np.sqrt(squared)
        return np.asarray(near & (ahead > 0.0) & (ahead < squared))

    def _meet_edges(self, p: FloatArray, q: FloatArray, edge: IntArray) -> BoolArray:
        """(K, L) whether fine edges cross edges."""
        p, d, a, b = p[:, None], (q - p)[:, None], self.fine.vertices[edge], self.fine.edge_ends[edge]
        begin = cross(b - a, p - a)
        apart = cross(d, a - p) * cross(d, b - p) > 0.0
        return np.asarray(~apart & (begin * (begin + cross(b - a, d)) <= 0.0))

    def _passed(self, corners: IntArray) -> Iterator[int]:
        """Fine loops of which all vertices are near an edge: it could pass these by, from side to side."""
        sizes = self.fine.loop_order.sizes
        if len(corners) >= sizes.min():
            counts = np.bincount(self.fine.loop_of_vertex[corners], minlength=len(sizes))
            yield from np.flatnonzero(counts == sizes).tolist()


def _stays_beside(p: FloatArray, q: FloatArray, line: FloatArray, x: FloatArray) -> BoolArray:
    """(K,) whether a point x stays on its side of an edge that goes from a line (2, 2) to p-q (K, 2)."""
    a, b = np.broadcast_to(line[:, None], (2, *p.shape)) - x
    corners = [a, b, q - x, p - x]
    turns = [np.arctan2(cross(u, v), dot(u, v)) for u, v in zip(corners, [*corners[1:], a], strict=True)]
    return np.asarray(np.abs(np.sum(turns, axis=0)) < np.pi)
