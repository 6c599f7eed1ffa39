"""How far lines run before they meet an outline: rays among blocks of edges."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.broad_phase import position_in_group
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import dot, norm
from .outline import Lines, Outline

BLOCK_EDGES, BLOCK_LINES = 16, 32
"""Consecutive edges that rays look at together; consecutive lines that look for these together."""

MANY_BLOCKS, NEAR = 256, 5.0
"""Number of blocks from which rays are followed as far as this many mean radii of blocks at first: most end there."""

CHUNK = 2**14
"""Pairs of a block of lines and one of edges that are looked at together, which bounds the memory."""


class Obstacles:
    """All loops of a mesh, in blocks of edges with circles around them."""

    def __init__(self, outline: Outline, regions: IntArray) -> None:
        """regions: (L,) the empty region that each loop bounds."""
        # the last vertex of each loop is repeated, so that no block has edges of two loops
        counts = -(-outline.sizes // BLOCK_EDGES)
        along = (BLOCK_EDGES * position_in_group(counts))[:, None] + np.arange(BLOCK_EDGES + 1)
        size, begin = np.repeat(outline.sizes, counts)[:, None], np.repeat(outline.begins, counts)[:, None]
        points = outline.vertices[begin + np.where(along < size, along, 0)]
        self.regions, self.region = regions, np.repeat(regions, BLOCK_EDGES * counts)
        self.starts, self.ends = points[:, :-1].reshape(-1, 2), points[:, 1:].reshape(-1, 2)
        self.centres: FloatArray = points.mean(axis=1)
        self.radii: FloatArray = norm(points - self.centres[:, None]).max(axis=1) + ROUND_OFF
        self.x, self.y = np.moveaxis(points, 2, 0).copy()  # (B, BLOCK_EDGES + 1)

    def free(self, lines: Lines, reach: FloatArray, loop: IntArray, distance: FloatArray) -> FloatArray:
        """(2, K) how far each line runs from its point forwards and backwards, at most its reach (K,).

        loop: (K,) that of each, ascending. distance: (K,) that it keeps from all edges; 0: it meets none. Negative
        where the point lies in the solid, too close to it, or in another empty region.
        """
        free, waiting = np.tile(reach, (2, 1)), np.arange(len(lines))
        far = NEAR * float(self.radii.mean()) if len(self.radii) > MANY_BLOCKS else np.inf
        step = max(1, CHUNK // len(self.radii))
        while len(waiting):
            begins = np.flatnonzero(position_in_group(np.bincount(loop[waiting])) % BLOCK_LINES == 0)
            begins, left = np.append(begins, len(waiting)), []
            for first in range(0, len(begins) - 1, step):
                some = begins[first : first + step + 1]
                k = waiting[some[0] : some[-1]]
                limit = np.minimum(reach[k], far)
                met = self._within(lines.take(k), limit, loop[k], distance[k], some[:-1] - some[0])
                free[:, k] = np.where(met < limit, met, reach[k])
                left.append(k[(limit < reach[k]) & (met >= limit).any(axis=0)])
            waiting, far = np.concatenate(left), np.inf
        return free

    def _within(
        self, lines: Lines, reach: FloatArray, loop: IntArray, distance: FloatArray, begins: IntArray
    ) -> FloatArray:
        """`free` of lines in blocks that begin with some of them."""
        origin, (u, v) = lines.point, lines.direction.T
        k, block = self._near(lines, reach + distance, distance, begins)
        level = (v * origin[:, 0] - u * origin[:, 1]).take(k)[:, None]
        heights = level - v.take(k)[:, None] * self.x.take(block, axis=0)
        heights += u.take(k)[:, None] * self.y.take(block, axis=0)
        left = heights > 0.0
        hit, edge = np.divmod(np.flatnonzero(left[:, :-1] != left[:, 1:]), BLOCK_EDGES)
        here, there, left = heights[hit, edge], heights[hit, edge + 1], left[hit, edge]
        ray, edge = k[hit], block[hit] * BLOCK_EDGES + edge
        start = self.starts[edge]
        crossing = start + (self.ends[edge] - start) * (here / (here - there))[:, None]
        along = dot(crossing - origin[ray], lines.direction[ray])
        way, length = (along < 0.0).astype(np.int64), np.abs(along)
        free, leaving = np.tile(reach, (2, 2, 1))
        np.minimum.at(free, (way, ray), length)
        out = (left == (along < 0.0)) | (self.region[edge] != self.regions[loop[ray]])
        np.minimum.at(leaving, (way[out], ray[out]), length[out])
        inside = ((leaving <= free) & (leaving < reach)).any(axis=0)
        if distance.any():
            free = np.minimum(free, self._to_distance(distance, lines, k, block, heights))
        return np.where(inside, -1.0, free)

    def _near(
        self, lines: Lines, reach: FloatArray, distance: FloatArray, begins: IntArray
    ) -> tuple[IntArray, IntArray]:
        """Pairs of a line and a block that it can meet within its reach."""
        low, high = (each.reduceat(lines.point, begins) for each in (np.minimum, np.maximum))
        around = 0.5 * norm(high - low) + np.maximum.reduceat(reach, begins)
        away = 0.5 * (low + high)[:, None] - self.centres
        group, block = np.nonzero(norm(away) <= around[:, None] + self.radii)
        counts = np.diff(begins, append=len(lines))[group]
        k, block = np.repeat(begins[group], counts) + position_in_group(counts), np.repeat(block, counts)
        (x, y), (u, v), radius = self.centres.T, lines.direction.T, self.radii.take(block)
        x, y = x.take(block) - lines.point[:, 0].take(k), y.take(block) - lines.point[:, 1].take(k)
        u, v = u.take(k), v.take(k)
        met = np.abs(v * x - u * y) <= radius + distance.take(k)
        met &= np.abs(u * x + v * y) <= reach.take(k) + radius
        return k[met], block[met]

    def _to_distance(
        self, distance: FloatArray, lines: Lines, k: IntArray, block: IntArray, heights: FloatArray
    ) -> FloatArray:
        """(2, K) how far each line keeps its distance d forwards and backwards; -1 where its point does not.

        k, block: (P,) lines and blocks that can meet; heights: (P, BLOCK_EDGES + 1) of ends of edges over the lines.
        Those points of a line that are closer than d to an edge end at a + (d² - h²)½, for the point of the edge, at
        the place a along the line and the height h, where this is largest: at an end of the edge, or where
        h = d cos α, with its angle α to the line. They begin likewise.
        """
        here, there = heights[:, :-1], heights[:, 1:]
        bound = distance[k, None]
        row, edge = np.nonzero((np.minimum(here, there) < bound) & (np.maximum(here, there) > -bound))
        d = distance[k[row]]
        here, there, k, edge = here[row, edge], there[row, edge], k[row], block[row] * BLOCK_EDGES + edge
        start = dot(self.starts[edge] - lines.point[k], lines.direction[k])
        run, rise = dot(self.ends[edge] - self.starts[edge], lines.direction[k]), there - here
        low, high = np.minimum(here, there), np.maximum(here, there)
        steepest, level = d * np.copysign(run, run * rise) / np.maximum(np.hypot(run, rise), TINY), rise == 0.0
        bounds = []
        for sign in (-1.0, 1.0):
            height = np.clip(sign * steepest, low, high)
            part = np.where(level, sign * run > 0.0, (height - here) / np.where(level, 1.0, rise))
            bounds.append(start + part * run + sign * np.sqrt(np.maximum(d**2 - height**2, 0.0)))
        begin, end = bounds
        kept = np.full((2, len(lines)), np.inf)
        for way, first, last in ((0, begin, end), (1, -end, -begin)):
            ahead = last > 0.0
            np.minimum.at(kept[way], k[ahead], np.where(first > 0.0, first, -1.0)[ahead])
        return kept
