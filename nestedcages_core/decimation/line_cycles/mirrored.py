"""The search around a loop across the axis of a mirror: shortest paths of one half, from the axis to the axis.

A symmetric cycle crosses the axis twice: with a line that is its own image, or with a vertex between a line and its
image. Without a first line to fix, one program finds the best cycles of all numbers of lines.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from .chain import Chain, Lines
from .images import Halves
from .shortest_cycles import Paths
from .turns import Turns, turns


class MirrorSearch:
    """The best symmetric cycles around one loop; like `LoopSearch`."""

    def __init__(
        self, chain: Chain, lines: Lines, free: FloatArray, *, width: int, sizes: range, halves: Halves
    ) -> None:
        """free: (2, K) what is free of each line. sizes: the possible numbers of lines."""
        self.chain, self.lines, self.free, self.sizes, self.halves = chain, lines, free, sizes, halves
        self.turns: Turns = turns(chain, lines, free, width)
        self.totals: FloatArray = np.zeros(0)

    def solve(self, through: int | None = None) -> Iterator[list[Paths]]:
        """Search from scratch, after changes of `free`. Yields in between."""
        image, rank = self.halves.image, self.halves.rank
        areas, (source, target) = self.turns.within(self.free), (self.turns.source, self.turns.target)
        begins, ends = self.halves.begins.copy(), self.halves.ends.copy()
        first = (source == image[target]) & ~np.isfinite(begins[target]) & (rank[target] > 0)
        begins[target[first]] = areas[first]
        last = (target == image[source]) & ~np.isfinite(ends[source]) & (rank[source] >= 0)
        ends[source[last]] = areas[last]
        self.begins, self.ends = begins, ends
        onward = np.flatnonzero((rank[source] >= 0) & (rank[target] > rank[source]) & np.isfinite(areas))
        self.source, self.target, self.areas = source[onward], target[onward], 2.0 * areas[onward]
        reached, at = np.unique(self.target, return_index=True)
        most = max(1, (self.sizes.stop + 1) // 2)
        at_axis = self.halves.begins == 0.0, self.halves.ends == 0.0
        self.least = np.full((2, most, len(self.lines)), np.inf)
        self.totals = np.full(self.sizes.stop, np.inf)
        self.found: dict[int, tuple[int, int, int]] = {}
        for line_first in (0, 1):
            yield []
            least = self.least[line_first]
            least[0] = np.where(at_axis[0] == bool(line_first), begins, np.inf)
            for k in range(most):
                if k and len(reached):
                    least[k, reached] = np.minimum.reduceat(least[k - 1, self.source] + self.areas, at)
                for line_last in (0, 1):
                    number = 2 * (k + 1) - line_first - line_last
                    closed = np.where(at_axis[1] == bool(line_last), least[k] + self.ends, np.inf)
                    end = int(closed.argmin())
                    if number in self.sizes and closed[end] < self.totals[number]:
                        self.totals[number], self.found[number] = closed[end], (line_first, k, end)

    def refine(self, number: int) -> Iterator[list[Paths]]:
        """The search knows no better cycle."""
        return iter(())

    def cycle(self, number: int) -> IntArray:
        """(number,) the lines of the best cycle, ascending."""
        line_first, k, line = self.found[number]
        path = [line]
        for step in range(k - 1, -1, -1):
            onto = slice(*np.searchsorted(self.target, (path[-1], path[-1] + 1)).tolist())
            path.append(
                int(self.source[onto][(self.least[line_first, step, self.source[onto]] + self.areas[onto]).argmin()])
            )
        half = np.array(path)
        lines: IntArray = np.unique(np.concatenate((half, self.halves.image[half])))
        return lines

    def share(self) -> None:
        """What is free of a line is free of its image."""
        self.free = np.minimum(self.free, self.free[::-1, self.halves.image])
