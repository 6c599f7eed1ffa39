"""Which edges of a cage, between points that are free themselves, keep their distance from a fine mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import CACHED_PAIRS, expanded, near_pairs
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number

MOST_TESTS = 1_000_000_000
"""Tests of an edge against a fine vertex or edge in one search: some ten seconds."""


@dataclass(frozen=True, eq=False)
class Lists:
    """For each edge of the cage some parts of the fine mesh."""

    member: IntArray
    """(M,) one list after the other."""
    first: IntArray
    """(m,) where each begins."""
    count: IntArray
    """(m,)."""

    @classmethod
    def of(cls, owner: IntArray, member: IntArray, count: int) -> Lists:
        """Lists of members (M,) by their owners (M,), which ascend."""
        counts = np.bincount(owner, minlength=count)
        return cls(member, np.cumsum(counts) - counts, counts)

    def of_edge(self, edge: int) -> IntArray:
        """One list."""
        return self.member[self.first[edge] : self.first[edge] + self.count[edge]]


class Near(NamedTuple):
    """What edges of the cage may meet."""

    centres: FloatArray
    """(m, 2) a cage that meets nothing."""
    corners: Lists
    """Fine vertices, nearest first."""
    lines: Lists
    """Fine edges by their starts."""


@dataclass(frozen=True, eq=False)
class Segments:
    """Edges of the cage between candidate points."""

    edge: IntArray
    """(P,) which of the cage's edges each is."""
    start: FloatArray
    """(2, P) columns."""
    end: FloatArray

    def take(self, kept: IntArray) -> Segments:
        """Some of them."""
        return Segments(self.edge[kept], self.start[:, kept], self.end[:, kept])


Meets = Callable[["Segments", IntArray, IntArray], IntArray]


@dataclass(eq=False)
class FreeEdges:
    """The search among edges of one cage."""

    cage: Mesh
    fine: Mesh
    clearance: float
    wanted: str
    """What the error says was not found."""

    def __post_init__(self) -> None:
        self.tests = 0
        self.columns = self.fine.vertices.T.copy(), self.fine.edge_ends.T.copy()

    def near(self, starts: FloatArray, far: FloatArray) -> Near:
        """What edges may meet whose ends are within distances (m,) of the vertices (m, 2) of a cage."""
        fine, successor = self.fine, self.cage.successor
        m, n, ends = len(starts), len(fine.vertices), starts[successor]
        far = np.maximum(far, far[successor])
        radius = float(far.max()) + 2.0 * self.clearance
        corner, edge = near_pairs(fine.vertices, starts, ends, radius)
        distance = point_edge(fine.vertices[corner], starts[edge], ends[edge]).distance
        close = distance <= far[edge] + 2.0 * self.clearance
        corner, edge = corner[close], edge[close]
        order = np.lexsort((distance[close], edge))
        corner, edge = corner[order], edge[order]
        point, line = near_pairs(starts, fine.vertices, fine.edge_ends, radius)
        owner = np.concatenate([edge, edge, point, self.cage.predecessor[point]])
        line = np.concatenate([corner, fine.predecessor[corner], line, line])
        owner, line = np.divmod(np.unique(owner * n + line), n)
        return Near(starts, Lists.of(edge, corner, m), Lists.of(owner, line, m))

    def kept(self, segments: Segments, kept: IntArray, near: Near) -> IntArray:
        """Those of some segments (K,), ascending by edge, that keep their distance. Raises NestingError."""
        for lists, meets in ((near.corners, self._meet_corners), (near.lines, self._meet_edges)):
            done, size = 0, 1  # the nearest ones first: most segments that are not free meet one of them
            while True:
                edge = segments.edge[kept]
                count = np.clip(lists.count[edge] - done, 0, size)
                if not count.any():
                    break
                kept = kept[~self._met(segments.take(kept), lists.member, lists.first[edge] + done, count, meets)]
                done, size = done + size, 2 * size
        for k, loop in self._passed(np.unique(segments.edge), near.corners):
            mine = np.flatnonzero(segments.edge[kept] == k)
            p, q = (ends[:, kept[mine]].T for ends in (segments.start, segments.end))
            line = near.centres[k], near.centres[self.cage.successor[k]]
            beside = self._stays_beside(p, q, *line, self.fine.vertices[self.fine.loops[loop][0]])
            kept = np.delete(kept, mine[~beside])
        return kept

    def _met(self, segments: Segments, member: IntArray, first: IntArray, count: IntArray, meets: Meets) -> BoolArray:
        """(P,) whether segments meet any of the members of a list from its first (P,) on. Raises NestingError."""
        met = np.zeros(len(count), bool)
        self.tests += int(count.sum())
        if self.tests > MOST_TESTS:
            raise NestingError(
                f"{self.wanted} was found in {MOST_TESTS:,} tests of edges; ask for fewer vertices or a finer grid.",
                code="limit.exceeded",
                what="grid",
            )
        for part in np.split(np.arange(len(count)), np.flatnonzero(np.diff(np.cumsum(count) // CACHED_PAIRS)) + 1):
            segment, place = expanded(first[part], count[part])
            segment += part[0]
            met[segment[meets(segments, segment, member.take(place))]] = True
        return met

    def _meet_corners(self, segments: Segments, k: IntArray, corner: IntArray) -> IntArray:
        """The pairs of a segment and a fine vertex that are too close in between its ends."""
        (px, py), (qx, qy), (x, y) = segments.start, segments.end, self.columns[0]
        dx, dy = qx - px, qy - py
        squared = dx * dx + dy * dy
        x, y = x.take(corner), y.take(corner)
        x -= px.take(k)
        y -= py.take(k)
        dx, dy = dx.take(k), dy.take(k)
        near = (np.abs(dx * y - dy * x) < (self.clearance * np.sqrt(squared)).take(k)).nonzero()[0]
        ahead = dx.take(near) * x.take(near) + dy.take(near) * y.take(near)
        return np.asarray(near[(ahead > 0.0) & (ahead < squared.take(k.take(near)))])

    def _meet_edges(self, segments: Segments, k: IntArray, edge: IntArray) -> IntArray:
        """The pairs of a segment and a fine edge that cross."""
        p, (a, b) = segments.start, self.columns
        along = segments.end - p
        (px, py), (dx, dy), (ax, ay), (bx, by) = p.take(k, 1), along.take(k, 1), a.take(edge, 1), b.take(edge, 1)
        one = dx * (ay - py) - dy * (ax - px)
        one *= dx * (by - py) - dy * (bx - px)
        near = (one <= 0.0).nonzero()[0]
        px, py, dx, dy, ax, ay, bx, by = (each.take(near) for each in (px, py, dx, dy, ax, ay, bx, by))
        bx -= ax
        by -= ay
        begin, turn = bx * (py - ay) - by * (px - ax), bx * dy - by * dx
        return np.asarray(near[begin * (begin + turn) <= 0.0])

    def _passed(self, edges: IntArray, corners: Lists) -> Iterator[tuple[int, int]]:
        """Edges, and fine loops that lie as a whole next to them: they could pass these by, from side to side."""
        smallest = int(self.fine.loop_order.sizes.min())
        for k in edges[corners.count[edges] >= smallest].tolist():
            loops, counts = np.unique(self.fine.loop_of_vertex[corners.of_edge(k)], return_counts=True)
            for loop in loops[counts == self.fine.loop_order.sizes[loops]].tolist():
                yield k, loop

    def _stays_beside(self, p: FloatArray, q: FloatArray, a: FloatArray, b: FloatArray, x: FloatArray) -> BoolArray:
        """(K,) whether the point x stays on its side of an edge that goes from a-b to p-q (K, 2)."""
        count = len(p)
        corners = np.stack([np.broadcast_to(a, p.shape), np.broadcast_to(b, p.shape), q, p], axis=1)
        # one quadrilateral after the other, each around its own copy of the point, far enough from the others
        step = np.zeros((count, 2))
        step[:, 0] = (
            4.0 * np.arange(count) * max(float(np.ptp(np.concatenate([corners.reshape(-1, 2), x[None]]))), 1e-300)
        )
        moved = corners + step[:, None]
        winding = winding_number(x + step, moved.reshape(-1, 2), np.roll(moved, -1, axis=1).reshape(-1, 2))
        return np.asarray(winding == 0)
