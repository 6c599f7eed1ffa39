"""Shortest cycles: dynamic programming over lines, for all numbers of lines at once."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.broad_phase import CACHED_PAIRS
from .turns import SingleArray, Turns


class Paths:
    """The best paths of 1, 2, … turns from one line once around to all lines, among given turns."""

    totals: FloatArray
    """(most + 1,) the least area of a cycle of each number of lines, once it has run."""

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
        self.source: IntArray = np.concatenate((turns.source[cut:], turns.source[:cut]))
        self.areas: SingleArray = np.concatenate((areas[cut:], areas[:cut]))
        self.source -= start
        self.source[self.source < 0] += self.count
        home = slice(0, self.first[1])
        self.home_source, self.home_area = self.source[home], self.areas[home].copy()
        target = np.repeat(np.arange(self.count), np.diff(self.first))
        self.areas[self.source >= target] = np.inf
        self.reached = np.flatnonzero(np.diff(self.first))
        self.least: SingleArray = np.zeros((0, 0), np.float32)
        """(most, K) least area of a path of this many turns."""

    def run(self) -> FloatArray:
        """The totals."""
        self.least = np.full((self.most, self.count), np.inf, np.float32)
        self.least[0, 0] = 0.0
        reached, begins = self.reached, self.first[self.reached]
        through = np.empty(len(self.source), np.float32)
        between = np.array([self._between(k) for k in range(1, self.most)], np.int64).reshape(-1, 2)
        for k, (low, high) in enumerate(np.searchsorted(reached, between).tolist(), start=1):
            if low >= high:
                continue
            some = slice(begins[low], begins[high] if high < len(reached) else len(self.source))
            part = np.take(self.least[k - 1], self.source[some], out=through[some], mode="clip")
            part += self.areas[some]
            self.least[k, reached[low:high]] = np.minimum.reduceat(part, begins[low:high] - begins[low])
        return self._close()

    def _between(self, turn: int) -> tuple[int, int]:
        """The positions first .. last - 1 that are sought with a turn."""
        if self.corridor is None:
            return 0, self.count
        before, after = min(turn - self.reach, len(self.corridor) - 1), turn + self.reach
        return self.corridor[max(before, 0)], self.corridor[after] if after < len(self.corridor) else self.count

    def _close(self) -> FloatArray:
        if len(self.home_source):
            closed = (self.least[:, self.home_source] + self.home_area).min(axis=1)
            self.totals = np.concatenate(([np.inf], closed))
        else:
            self.totals = np.full(self.most + 1, np.inf)
        return self.totals

    @staticmethod
    def run_all(several: list[Paths]) -> None:
        """Run several programs, small ones as one, which saves calls of numpy."""
        some: list[Paths] = []
        for paths in several:
            if some and sum(len(each.source) for each in some) + len(paths.source) > CACHED_PAIRS:
                Paths._run_as_one(some)
                some = []
            some.append(paths)
        if some:
            Paths._run_as_one(some)

    @staticmethod
    def _run_as_one(several: list[Paths]) -> None:
        if len(several) == 1:
            several[0].run()
            return
        ends = np.cumsum([paths.count for paths in several])
        offsets = (ends - [paths.count for paths in several]).tolist()
        turns = np.cumsum([0, *(len(paths.source) for paths in several)]).tolist()
        source = np.concatenate([paths.source + offset for paths, offset in zip(several, offsets, strict=True)])
        areas = np.concatenate([paths.areas for paths in several])
        reached = np.concatenate([paths.reached + offset for paths, offset in zip(several, offsets, strict=True)])
        begins = np.concatenate(
            [paths.first[paths.reached] + turn for paths, turn in zip(several, turns, strict=False)]
        )
        of_reached = np.repeat(np.arange(len(several)), [len(paths.reached) for paths in several])
        bounded = any(paths.corridor is not None for paths in several)
        least = np.full((max(paths.most for paths in several), ends[-1]), np.inf, np.float32)
        least[0, offsets] = 0.0
        through = np.empty(len(source), np.float32)
        for k in range(1, len(least)):
            np.take(least[k - 1], source, out=through, mode="clip")
            np.add(through, areas, out=through)
            best = np.minimum.reduceat(through, begins) if len(begins) else through
            if bounded:
                low, high = (np.array([paths._between(k) for paths in several]).T + offsets)[:, of_reached]
                best[(reached < low) | (reached >= high)] = np.inf
            least[k, reached] = best
        for paths, offset in zip(several, offsets, strict=True):
            paths.least = least[: paths.most, offset : offset + paths.count]
            paths._close()

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
