"""Thinning: loops with the vertices that tell most (Ramer 1972, Douglas & Peucker 1973), in whole-array operations.

The significance of a vertex is its distance from the chord that it splits, at most that of the chord's own ends. All
chords of all loops are split at once, in about log2(n) rounds.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arrays import TINY, FloatArray
from .mesh import Mesh
from .precision import NEGLIGIBLE
from .vectors import dot, norm


class Thinning:
    """A mesh, and how much each of its vertices tells."""

    def __init__(self, fine: Mesh) -> None:
        self.fine, self.least = fine, NEGLIGIBLE * fine.diagonal
        self.significance = significance(fine.rings, self.least)

    def tolerance(self, points: int) -> float:
        """The tolerance at which about so many vertices are left."""
        return max(float(np.partition(self.significance, -points)[-points]), self.least)

    def mesh(self, tolerance: float) -> Mesh:
        """The mesh of the vertices that tell more than a tolerance. Raises InvalidMeshError."""
        parts = np.split(self.significance, np.cumsum([len(ring) for ring in self.fine.rings])[:-1])
        few = [ring[part > tolerance] for ring, part in zip(self.fine.rings, parts, strict=True)]
        return Mesh.from_loops(few).validated()


def significance(loops: Sequence[FloatArray], least: float) -> FloatArray:
    """(n,) distances up to which each vertex of loops (k, 2) may be left out; 0 for some below `least`, infinite for
    the extreme vertices of each loop."""
    extremes = [np.unique([*loop.argmin(axis=0), *loop.argmax(axis=0)]) for loop in loops]
    begins = np.cumsum([0, *map(len, loops)])
    # each loop as a path from its first extreme vertex around to that
    paths = [np.append(np.roll(np.arange(len(loop)), -e[0]), e[0]) for loop, e in zip(loops, extremes, strict=True)]
    vertex = np.concatenate([path + begin for path, begin in zip(paths, begins, strict=False)])
    points = np.concatenate(loops)[vertex]
    ends = [np.append(e - e[0], len(loop)) for loop, e in zip(loops, extremes, strict=True)]
    offsets = np.cumsum([0, *map(len, paths)])
    i = np.concatenate([end[:-1] + offset for end, offset in zip(ends, offsets, strict=False)])
    j = np.concatenate([end[1:] + offset for end, offset in zip(ends, offsets, strict=False)])
    found = np.zeros(len(vertex))
    found[i], limit = np.inf, np.full(len(i), np.inf)
    while True:
        split = np.flatnonzero(j - i > 1)
        if len(split) == 0:
            result = np.zeros(begins[-1])
            result[vertex[::-1]] = found[::-1]  # the path's first vertex stands at both of its ends
            return result
        i, j, limit = i[split], j[split], limit[split]
        first = np.cumsum(j - i - 1) - (j - i - 1)
        chord = np.repeat(np.arange(len(i)), j - i - 1)
        at = np.arange(len(chord)) + (i + 1 - first)[chord]
        along, from_start = (points[j] - points[i])[chord], points[at] - points[i][chord]
        part = np.clip(dot(from_start, along) / np.maximum(dot(along, along), TINY), 0.0, 1.0)
        away = norm(from_start - part[:, None] * along)
        farthest = np.maximum.reduceat(away, first)
        at_most = np.flatnonzero(away == farthest[chord])
        middle = at[at_most[np.searchsorted(chord[at_most], np.arange(len(i)))]]
        limit = np.minimum(limit, farthest)
        found[middle] = limit
        apart = farthest > least
        i, j = np.concatenate((i[apart], middle[apart])), np.concatenate((middle[apart], j[apart]))
        limit = np.tile(limit[apart], 2)
