"""Shortest cycles: dynamic programming over lines, for all numbers of lines at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import CACHED_PAIRS
from .turns import SingleArray, Turns


class Paths:
    """The best paths of 1, 2, … turns from one line once around to all lines, among given turns."""

    totals: FloatArray
    """(most + 1,) the least area of a cycle of each number of lines, once the program has run."""
    least: SingleArray
    """(most, K) least area of a path of this many turns."""

    def __init__(
        self,
        turns: Turns,
        areas: SingleArray,
        first: IntArray,
        start: int,
        most: int,
        corridor: list[int] | None = None,
        reach: int = 2,
    ) -> None:
        """first: (K + 1,) the first turn onto each line. most: the largest number of lines of a cycle.

        corridor: positions of the lines of a cycle; each line is sought between those `reach` turns away.
        """
        self.start, self.count, self.most = start, len(first) - 1, most
        self.corridor, self.reach = corridor, reach
        # lines by their positions after the start, so that paths only go on
        cut = int(first[start])
        self.first = np.concatenate((first[start:-1], first[: start + 1] + first[-1])) - first[start]
        self.source: IntArray = np.concatenate((turns.source[cut:], turns.source[:cut])) - start
        self.source[self.source < 0] += self.count
        self.areas: SingleArray = np.concatenate((areas[cut:], areas[:cut]))
        home = slice(0, self.first[1])
        self.home_source, self.home_area = self.source[home], self.areas[home].copy()
        target = np.repeat(np.arange(self.count), np.diff(self.first))
        self.areas[self.source >= target] = np.inf
        self.reached = np.flatnonzero(np.diff(self.first))

    def run_in_corridor(self) -> None:
        """Run the program where each line is sought in a part of the outline."""
        assert self.corridor is not None
        self.least = np.full((self.most, self.count), np.inf, np.float32)
        self.least[0, 0] = 0.0
        reached, begins = self.reached, np.append(self.first[self.reached], len(self.source))
        ends = [*self.corridor, *[self.count] * (self.most + self.reach)]
        between = [(ends[max(min(k - self.reach, len(self.corridor) - 1), 0)], ends[k + self.reach])
                   for k in range(1, self.most)]  # fmt: skip
        for k, (low, high) in enumerate(np.searchsorted(reached, between).reshape(-1, 2).tolist(), start=1):
            if low < high:
                some = slice(begins[low], begins[high])
                part = self.least[k - 1].take(self.source[some]) + self.areas[some]
                self.least[k, reached[low:high]] = np.minimum.reduceat(part, begins[low:high] - begins[low])
        self.close()

    def close(self) -> None:
        """Find the totals."""
        self.totals = np.full(self.most + 1, np.inf)
        if len(self.home_source):
            self.totals[1:] = (self.least[:, self.home_source] + self.home_area).min(axis=1)

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


def run_batched(several: Sequence[Paths]) -> None:
    """Run several programs, small ones as one, which saves calls of numpy."""
    batch: list[Paths] = []
    size = 0
    for paths in several:
        if paths.corridor is not None:
            paths.run_in_corridor()
            continue
        if batch and size + len(paths.source) > CACHED_PAIRS:
            _run_as_one(batch)
            batch, size = [], 0
        batch.append(paths)
        size += len(paths.source)
    if batch:
        _run_as_one(batch)


def _run_as_one(batch: Sequence[Paths]) -> None:
    ends, turns = (np.cumsum(sizes).tolist() for sizes in zip(*((p.count, len(p.source)) for p in batch), strict=True))
    offsets, firsts = [0, *ends[:-1]], [0, *turns[:-1]]
    source = np.concatenate([paths.source + offset for paths, offset in zip(batch, offsets, strict=True)])
    areas = np.concatenate([paths.areas for paths in batch])
    reached = np.concatenate([paths.reached + offset for paths, offset in zip(batch, offsets, strict=True)])
    begins = np.concatenate([paths.first[paths.reached] + first for paths, first in zip(batch, firsts, strict=True)])
    least = np.full((max(paths.most for paths in batch), ends[-1]), np.inf, np.float32)
    least[0, offsets] = 0.0
    through = np.empty(len(source), np.float32)
    for k in range(1, len(least) if len(begins) else 0):
        np.take(least[k - 1], source, out=through, mode="clip")
        through += areas
        least[k, reached] = np.minimum.reduceat(through, begins)
    for paths, offset in zip(batch, offsets, strict=True):
        paths.least = least[: paths.most, offset : offset + paths.count]
        paths.close()
