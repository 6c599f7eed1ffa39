"""Shortest cycles: dynamic programming over lines, for all numbers of lines at once."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from .turns import SingleArray, Turns


class Paths:
    """The best paths of 1, 2, … turns from one line once around to all lines, among given turns."""

    def __init__(self, turns: Turns, areas: SingleArray, first: IntArray, start: int, most: int) -> None:
        """first: (K + 1,) the first turn onto each line. most: the largest number of lines of a cycle."""
        self.start, self.count = start, len(first) - 1
        # lines by their positions after the start, so that paths only go on
        cut = int(first[start])
        self.source: IntArray = np.concatenate((turns.source[cut:], turns.source[:cut]))
        self.target: IntArray = np.concatenate((turns.target[cut:], turns.target[:cut]))
        self.areas: SingleArray = np.concatenate((areas[cut:], areas[:cut]))
        self.first = np.concatenate((first[start:-1], first[: start + 1] + first[-1])) - first[start]
        self.source, self.target = self.source - start, self.target - start
        self.source[self.source < 0] += self.count
        self.target[self.target < 0] += self.count
        home = slice(0, self.first[1])
        self.home_source, self.home_area = self.source[home], self.areas[home].copy()
        self.areas = np.where(self.source < self.target, self.areas, np.float32(np.inf))
        self.least: SingleArray = np.full((most, self.count), np.inf, np.float32)
        """(most, K) least area of a path of this many turns."""
        self.least[0, 0] = 0.0

    def run(self, corridor: list[int] | None = None) -> FloatArray:
        """(most + 1,) the least area of a cycle of each number of lines.

        corridor: positions of the lines of a cycle; each line is sought between those two turns away.
        """
        reached = np.flatnonzero(np.diff(self.first))
        begins = self.first[reached]
        through = np.empty(len(self.source), np.float32)
        for k in range(1, len(self.least)):
            low, high = 0, len(reached)
            if corridor is not None:
                before, after = min(k - 2, len(corridor) - 1), k + 2
                low = int(np.searchsorted(reached, corridor[max(before, 0)]))
                high = int(np.searchsorted(reached, corridor[after])) if after < len(corridor) else high
            if low >= high:
                continue
            some = slice(begins[low], begins[high] if high < len(reached) else len(self.source))
            part = np.take(self.least[k - 1], self.source[some], out=through[some], mode="clip")
            part += self.areas[some]
            self.least[k, reached[low:high]] = np.minimum.reduceat(part, begins[low:high] - begins[low])
        if len(self.home_source) == 0:
            return np.full(len(self.least) + 1, np.inf)
        closed = (self.least[:, self.home_source] + self.home_area).min(axis=1)
        return np.concatenate(([np.inf], closed))

    def cycle(self, number: int) -> IntArray:
        """(number,) the lines of the best cycle, ascending."""
        last = int((self.least[number - 1, self.home_source] + self.home_area).argmin())
        path = [int(self.home_source[last])]
        for k in range(number - 2, -1, -1):
            onto = slice(self.first[path[-1]], self.first[path[-1] + 1])
            sources = self.source[onto]
            path.append(int(sources[(self.least[k, sources] + self.areas[onto]).argmin()]))
        lines: IntArray = np.sort((np.array(path) + self.start) % self.count)
        return lines
