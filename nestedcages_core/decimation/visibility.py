"""How far lines run before they meet an outline: rays among blocks of edges."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import dot, norm
from .outline import Lines

BLOCK_EDGES = 16
"""Consecutive edges that rays look at together."""


class Obstacles:
    """All loops of a mesh, in blocks of edges with circles around them."""

    def __init__(self, loops: list[FloatArray], regions: IntArray) -> None:
        """regions: (L,) the empty region that each loop bounds."""
        # the last edge of each loop is repeated, so that no block has edges of two loops
        padded = [np.minimum(np.arange(-(-len(loop) // BLOCK_EDGES) * BLOCK_EDGES), len(loop) - 1) for loop in loops]
        self.region = np.repeat(regions, [len(order) for order in padded])
        self.starts = np.concatenate([loop[order] for loop, order in zip(loops, padded, strict=True)])
        self.ends = np.concatenate([loop[(order + 1) % len(loop)] for loop, order in zip(loops, padded, strict=True)])
        blocks = np.stack((self.starts.reshape(-1, BLOCK_EDGES, 2), self.ends.reshape(-1, BLOCK_EDGES, 2)), axis=1)
        self.blocks: FloatArray = blocks.reshape(-1, 2 * BLOCK_EDGES, 2)
        self.centres: FloatArray = self.blocks.mean(axis=1)
        self.radii: FloatArray = norm(self.blocks - self.centres[:, None]).max(axis=1) + ROUND_OFF

    def free(self, lines: Lines, reach: FloatArray, region: int, distance: float) -> FloatArray:
        """(2, K) how far each line runs from its point forwards and backwards, at most its reach (K,).

        distance: that it keeps from all edges; 0: it meets none. Negative where the point lies in the solid, too close
        to it, or in another empty region.
        """
        right, origin = lines.right, lines.point
        level = dot(right, origin)
        k, block = self._near(lines, reach + distance, level, distance)
        near = self.blocks[block]
        heights = level[k, None] - (right[k, 0, None] * near[:, :, 0] + right[k, 1, None] * near[:, :, 1])
        left = heights > 0.0
        hit, edge = np.nonzero(left[:, :BLOCK_EDGES] != left[:, BLOCK_EDGES:])
        here, there, left = heights[hit, edge], heights[hit, BLOCK_EDGES + edge], left[hit, edge]
        ray, edge = k[hit], block[hit] * BLOCK_EDGES + edge
        start = self.starts[edge]
        crossing = start + (self.ends[edge] - start) * (here / (here - there))[:, None]
        along = dot(crossing - origin[ray], lines.direction[ray])
        way, length = (along < 0.0).astype(np.int64), np.abs(along)
        free, leaving = np.tile(reach, (2, 2, 1))
        np.minimum.at(free, (way, ray), length)
        out = (left == (along < 0.0)) | (self.region[edge] != region)
        np.minimum.at(leaving, (way[out], ray[out]), length[out])
        inside = ((leaving <= free) & (leaving < reach)).any(axis=0)
        if distance > 0.0:
            free = np.minimum(free, self._to_distance(distance, lines, k, block, heights))
        return np.where(inside, -1.0, free)

    def _near(self, lines: Lines, reach: FloatArray, level: FloatArray, distance: float) -> tuple[IntArray, IntArray]:
        """Pairs of a line and a block that it can meet within its reach."""
        middle = 0.5 * (lines.point.min(axis=0) + lines.point.max(axis=0))
        around = float(norm(lines.point - middle).max() + reach.max())
        close = np.flatnonzero(norm(self.centres - middle) <= around + self.radii)
        centres, radii = self.centres[close], self.radii[close]
        k, block = np.nonzero(np.abs(level[:, None] - lines.right @ centres.T) <= radii + distance)
        within = np.abs(dot(centres[block] - lines.point[k], lines.direction[k])) <= reach[k] + radii[block]
        return k[within], close[block[within]]

    def _to_distance(self, d: float, lines: Lines, k: IntArray, block: IntArray, heights: FloatArray) -> FloatArray:
        """(2, K) how far each line keeps a distance d forwards and backwards; -1 where its point does not.

        k, block: (P,) lines and blocks that can meet; heights: (P, 2 * BLOCK_EDGES) of the starts and ends of the edges
        of these over the lines. Those points of a line that are closer than d to an edge end at a + (d² - h²)½, for the
        point of the edge, at the place a along the line and the height h, where this is largest: at an end of the edge,
        or where h = d cos α, with its angle α to the line. They begin likewise.
        """
        here, there = heights[:, :BLOCK_EDGES], heights[:, BLOCK_EDGES:]
        row, edge = np.nonzero((np.minimum(here, there) < d) & (np.maximum(here, there) > -d))
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
