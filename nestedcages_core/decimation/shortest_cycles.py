"""Shortest cycles: dynamic programming over lines, for all numbers of lines at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import CACHED_PAIRS
from .turns import SingleArray


class Graph(NamedTuple):
    """K lines around an outline, and the turns between them that are open, sorted by the second line."""

    source: IntArray
    """(P,) the line that is left."""
    target: IntArray
    """(P,) the line that is taken."""
    areas: SingleArray
    """(P,) infinite for a turn that is blocked."""
    first: IntArray
    """(K + 1,) the first turn onto each line."""
    reached: IntArray
    """(R,) the lines that there are turns onto."""

    @classmethod
    def of(cls, source: IntArray, target: IntArray, areas: SingleArray, count: int) -> Graph:
        """That of so many lines."""
        first = np.searchsorted(target, np.arange(count + 1))
        return cls(source, target, areas, first, np.flatnonzero(np.diff(first)))


class Paths:
    """The best paths of 1, 2, … turns from one line once around to all lines."""

    areas: SingleArray
    """(P,) infinite for a turn that passes that line."""
    least: SingleArray
    """(most, K) least area of a path of this many turns, once the program has run."""
    totals: FloatArray
    """(most + 1,) the least area of a cycle of each number of lines."""

    def __init__(
        self, graph: Graph, start: int, most: int, corridor: Sequence[int] | None = None, reach: int = 0
    ) -> None:
        """most: the largest number of lines of a cycle.

        corridor: positions of the lines of a cycle after the start; each line is sought between those `reach` turns
        away.
        """
        self.graph, self.start, self.most, self.corridor, self.reach = graph, start, most, corridor, reach

    def cycle(self, number: int) -> IntArray:
        """(number,) the lines of the best cycle, ascending."""
        path = [self.start]
        for k in range(number - 1, -1, -1):
            onto = slice(*self.graph.first[path[-1] : path[-1] + 2].tolist())
            areas = (self.areas if k < number - 1 else self.graph.areas)[onto]
            sources = self.graph.source[onto]
            path.append(int(sources[(self.least[k, sources] + areas).argmin()]))
        return np.sort(path[1:])

    def close(self) -> None:
        """Find the totals."""
        home = slice(*self.graph.first[self.start : self.start + 2].tolist())
        self.totals = np.full(self.most + 1, np.inf)
        if home.start < home.stop:
            self.totals[1:] = (self.least[:, self.graph.source[home]] + self.graph.areas[home]).min(axis=1)

    def run_in_corridor(self) -> None:
        """Run the program where each line is sought in a part of the outline."""
        assert self.corridor is not None
        graph, count = self.graph, len(self.graph.first) - 1
        self.areas = _without_passing(graph.source, graph.target, graph.areas.copy(), self.start)
        self.least = np.full((self.most, count), np.inf, np.float32)
        self.least[0, self.start] = 0.0
        reached, begins = graph.reached, np.append(graph.first[graph.reached], len(graph.source))
        ends = [*self.corridor, *[count] * (self.most + self.reach)]
        last = len(self.corridor) - 1
        low = np.array([ends[max(min(k - self.reach, last), 0)] for k in range(1, self.most)], np.int64) + self.start
        high = np.array(ends[self.reach + 1 : self.reach + self.most], np.int64) + self.start
        # parts before and beyond the last line, where the numbers begin again
        parts = np.minimum((low, high), count), np.maximum((low - count, high - count), 0)
        for k, each in enumerate(np.searchsorted(reached, np.array(parts)).transpose(2, 0, 1).tolist(), start=1):
            for one, other in each:
                if one < other:
                    some = slice(begins[one], begins[other])
                    part = self.least[k - 1].take(graph.source[some]) + self.areas[some]
                    self.least[k, reached[one:other]] = np.minimum.reduceat(part, begins[one:other] - begins[one])
        self.close()


def run_batched(several: Sequence[Paths]) -> None:
    """Run several programs, small ones as one, which saves calls of numpy."""
    batch: list[Paths] = []
    size = 0
    for paths in sorted(several, key=lambda each: -each.most):
        if paths.corridor is not None:
            paths.run_in_corridor()
            continue
        if batch and size + len(paths.graph.source) > CACHED_PAIRS:
            _run_as_one(batch)
            batch, size = [], 0
        batch.append(paths)
        size += len(paths.graph.source)
    if batch:
        _run_as_one(batch)


def _run_as_one(batch: Sequence[Paths]) -> None:
    """Run programs, those for the most lines first."""
    graphs, starts = [paths.graph for paths in batch], [paths.start for paths in batch]
    turns, counts, lines = np.array(
        [[len(graph.source), len(graph.reached), len(graph.first) - 1] for graph in graphs]
    ).T
    offsets, firsts = (np.cumsum(each) - each for each in (lines, turns))
    source, target, areas = (np.concatenate([graph[part] for graph in graphs]) for part in range(3))
    _without_passing(source, target, areas, np.repeat(starts, turns))
    source += np.repeat(offsets, turns)
    reached = np.concatenate([graph.reached for graph in graphs]) + np.repeat(offsets, counts)
    begins = np.concatenate([graph.first[graph.reached] for graph in graphs]) + np.repeat(firsts, counts)
    least = np.full((batch[0].most, lines.sum()), np.inf, np.float32)
    least[0, offsets + starts] = 0.0
    through = np.empty(len(source), np.float32)
    active = np.searchsorted([-paths.most for paths in batch], -np.arange(len(least)))  # those for more than k lines
    sizes = zip(
        np.append(0, np.cumsum(turns))[active].tolist(), np.append(0, np.cumsum(counts))[active].tolist(), strict=True
    )
    for k, (some, onto) in enumerate(sizes):
        if k and onto:
            part = through[:some]
            np.take(least[k - 1], source[:some], out=part, mode="clip")
            part += areas[:some]
            least[k, reached[:onto]] = np.minimum.reduceat(part, begins[:onto])
    for paths, offset, count, begin, size in zip(batch, offsets, lines, firsts, turns, strict=True):
        paths.least, paths.areas = least[: paths.most, offset : offset + count], areas[begin : begin + size]
        paths.close()


def _without_passing(source: IntArray, target: IntArray, areas: SingleArray, start: IntArray | int) -> SingleArray:
    """(P,) the areas, made infinite for turns onto or over the start."""
    behind, beyond = source < start, target >= start
    areas[(behind & beyond) | ((source >= target) & (behind | beyond))] = np.inf
    return areas
