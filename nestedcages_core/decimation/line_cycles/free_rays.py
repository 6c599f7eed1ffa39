"""Free rays: how far lines run outside of the solid, forwards and backwards from their contact."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.precision import ROUND_OFF
from ...geometry.vectors import norm
from .chain import Lines

BLOCK_EDGES = 16
"""Consecutive edges that rays look at together."""


class Obstacles:
    """All loops of an outline, in blocks of edges with circles around them. Unit: the outline's diameter."""

    def __init__(self, loops: list[FloatArray]) -> None:
        # the last edge of each loop is repeated, so that no block has edges of two loops
        padded = [np.minimum(np.arange(-(-len(loop) // BLOCK_EDGES) * BLOCK_EDGES), len(loop) - 1) for loop in loops]
        self.starts = np.concatenate([loop[order] for loop, order in zip(loops, padded, strict=True)])
        self.ends = np.concatenate([loop[(order + 1) % len(loop)] for loop, order in zip(loops, padded, strict=True)])
        blocks = np.stack((self.starts.reshape(-1, BLOCK_EDGES, 2), self.ends.reshape(-1, BLOCK_EDGES, 2)), axis=1)
        self.blocks: FloatArray = blocks.reshape(-1, 2 * BLOCK_EDGES, 2)
        self.centres: FloatArray = self.blocks.mean(axis=1)
        self.radii: FloatArray = norm(self.blocks - self.centres[:, None]).max(axis=1) + ROUND_OFF

    def free(self, lines: Lines, reach: float) -> FloatArray:
        """(2, K) how far each line runs from its point forwards and backwards, at most the reach.

        Negative where the point lies in the solid.
        """
        right, origin = lines.right, lines.point
        level = (right * origin).sum(axis=1)
        # the blocks that a ray of any of these lines can reach
        middle = 0.5 * (origin.min(axis=0) + origin.max(axis=0))
        around = float(norm(origin - middle).max()) + reach
        close = np.flatnonzero(norm(self.centres - middle) <= around + self.radii)
        k, block = np.nonzero(np.abs(level[:, None] - right @ self.centres[close].T) <= self.radii[close])
        block = close[block]
        near = self.blocks[block]
        heights = level[k, None] - (right[k, 0, None] * near[:, :, 0] + right[k, 1, None] * near[:, :, 1])
        left = heights > 0.0
        hit, edge = np.nonzero(left[:, :BLOCK_EDGES] != left[:, BLOCK_EDGES:])
        here, there, left = heights[hit, edge], heights[hit, BLOCK_EDGES + edge], left[hit, edge]
        k, edge = k[hit], block[hit] * BLOCK_EDGES + edge
        start = self.starts[edge]
        crossing = start + (self.ends[edge] - start) * (here / (here - there))[:, None]
        along = ((crossing - origin[k]) * lines.direction[k]).sum(axis=1)
        way, length = (along < 0.0).astype(np.int64), np.abs(along)
        free, leaving = np.full((2, 2, len(lines)), reach)
        np.minimum.at(free, (way, k), length)
        out = left == (along < 0.0)
        np.minimum.at(leaving, (way[out], k[out]), length[out])
        inside = ((leaving <= free) & (leaving < reach)).any(axis=0)
        return np.where(inside, -1.0, free)
