"""The search around one outline: shortest cycles through several lines, since each program fixes the first one."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from copy import copy
from typing import Self

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import dot
from ..progress import Tick, no_tick
from .outline import Lines
from .shortest_cycles import Graph, Paths, run_batched
from .turns import Turns

MAX_STARTS, APART = 4, 0.1
"""Number of lines through which a first cycle is sought; part of all lines among which no second such line lies."""

SUPPORTING = 1e6
"""Preference of lines that have the whole outline on one side: a cage is likely to follow one of them."""

CORNERS = 32
"""Directions whose extreme vertices tell that."""

CHEAP_WORK = 1e6
"""Turns times lines of the cage up to which there is time for one more search."""

MAX_ACROSS, MAX_MORE = 4, 6
"""Number of searches through the opposite line of the best cycle, and through lines between two lines of it
(docs/numbers.md: line cycles: searches through other lines)."""

ROUGH_ACROSS = 2
"""The first of these where an estimate is enough: it is within about 1 %."""

MAX_MORE_IN_PARTS = 60
"""The same where rotations leave few lines to each part, so that the first one decides."""

MAX_MORE_IF_THOROUGH = 30
"""The same around convex outlines, where one of the lines between two of a cycle is in the best one (Aggarwal, Chang &
Yap 1985): of 1,540 random convex cages, 30 and 60 find the best to 0.1 %, and MAX_MORE misses 21 by up to 4.7 %."""

IMPROVED = 1e-3
"""Relative gain from which a search counts as one that improved something."""

SPARE = 3
"""Lines that a later search allows beyond those wanted."""

MAX_REFINED, REROUTED = 3, 3
"""Number of searches near the best cycle, one after the other; of lines that it is sought through after changes."""

USUAL_REACH, WIDE_REACH = 2, 8
"""Turns by which a cycle near another one may run ahead of it or fall behind; the same after lines were shortened."""

BAND = 24
"""Number of lines by which a cycle may run ahead of evenly spread ones or fall behind, where its number is known."""


class RingSearch:
    """The best cycles around one outline: `totals`, the least area for each number of lines, and which lines they are.

    Methods that search are generators of programs, which `run_together` runs with those of other outlines.
    """

    totals: FloatArray
    found: dict[int, Paths]
    """What tells the best cycle of each number of lines."""
    improved: int
    """Number of lines up to which cycles were sought through further lines."""
    tried: int
    """The same, roughly."""

    def __init__(
        self,
        lines: Lines,
        free: FloatArray,
        found: Turns,
        minimum: int,
        most: int,
        parts: int = 1,
        *,
        thorough: bool = False,
        known: bool = False,
    ) -> None:
        """free: (2, K) what is free of each line. found: the turns between them. minimum: of the number of lines.

        most: the largest number that is sought at first. parts: of the outline that rotations take to each other; lines
        are counted and sought in the first one. thorough: whether cycles are sought through all lines between two of a
        cycle, as far as these are few. known: whether cycles of the largest number alone matter.
        """
        self.lines, self.free, self.minimum = lines, free, minimum
        self.parts, self.count = parts, len(lines) // parts
        self.most = min(most, self.count)
        self.more = MAX_MORE_IN_PARTS if parts > 1 else MAX_MORE_IF_THOROUGH if thorough else MAX_MORE
        self.even = [k * self.count // self.most for k in range(self.most)] if known else None
        self.turns: Turns = found if parts == 1 else found.of_part(self.count, len(lines))
        self.graph = Graph.of(self.turns.source, self.turns.target, self.turns.within(free), self.count)
        self._forget()

    def copy(self) -> Self:
        """The search as it is now, to go on from without changing it."""
        other = copy(self)
        other.free, other.totals, other.found = self.free.copy(), self.totals.copy(), dict(self.found)
        return other

    def solve(self) -> Iterator[list[Paths]]:
        """Search from scratch through the lines that most cycles are likely to have, until there is a cycle."""
        self._forget()
        lines, points = self.lines.take(slice(self.count)), self.lines.point
        open_ = np.isfinite(self.graph.areas)
        onto, off = (np.bincount(ends[open_], minlength=self.count) for ends in (self.turns.target, self.turns.source))
        turn = 2.0 * np.pi / CORNERS * np.arange(CORNERS)
        corners = points[np.unique((points @ np.stack((np.cos(turn), np.sin(turn)))).argmax(axis=0))]
        above = (lines.right @ corners.T).max(axis=1) - dot(lines.right, lines.point)
        score = off * onto * np.where(above <= ROUND_OFF, SUPPORTING, 1.0)
        for _ in range(MAX_STARTS):
            start = int(score.argmax())
            if self.found or score[start] <= 0.0:
                return
            yield from self._search(self.most, start)
            near = int(APART * self.count)
            score[np.arange(start - near, start + near + 1) % self.count] = -1.0

    def improve(self, number: int, *, roughly: bool = False) -> Iterator[list[Paths]]:
        """Search through other lines of the best cycle of a number of lines, as long as that takes little time.

        roughly: whether through few of them.
        """
        if number <= (self.tried if roughly else self.improved):
            return
        self.tried = most = min(number + SPARE, self.most)
        spare = int(CHEAP_WORK / (len(self.graph.areas) * (most + 1)))
        for _ in range(min(spare, ROUGH_ACROSS if roughly else MAX_ACROSS)):
            if not (yield from self._search(most, self._across(number))):
                break
        if roughly:
            return
        self.improved = most
        more = self.more if self.more > MAX_MORE else min(spare, MAX_MORE)
        if more:
            cycle = self._part(number) if self.parts == 1 else np.zeros(1, np.int64)  # any line of a part
            gaps = np.mod(np.roll(cycle, -1) - cycle - 1, self.count) + 1
            g = int(gaps.argmin())
            steps = np.unique(np.linspace(0, gaps[g], more + 2)[1:-1].astype(np.int64)).tolist()
            yield from self._search(most, *(int((cycle[g] + step) % self.count) for step in steps))

    def refine(self, number: int) -> Iterator[list[Paths]]:
        """Search through other lines of the best cycle of a number of lines, near this cycle, as long as that helps."""
        for _ in range(MAX_REFINED):
            if not (yield from self._near(self._part(number), [self._across(number)], USUAL_REACH)):
                return

    def reroute(self, number: int) -> Iterator[list[Paths]]:
        """Search near the best cycle of a number of lines after changes of `free`; from scratch if there is none."""
        cycle = self._part(number)
        self.graph = self.graph._replace(areas=self.turns.within(self.free))
        self._forget()
        starts = cycle[np.unique(np.linspace(0, number, REROUTED, endpoint=False).astype(np.int64))]
        yield from self._near(cycle, starts.tolist(), WIDE_REACH)
        if not self.found:
            yield from self.solve()

    def _near(self, cycle: IntArray, starts: Sequence[int], reach: int) -> Generator[list[Paths], None, bool]:
        """Search through some lines near a cycle; whether one is better than before."""
        most, several = min(len(cycle) + SPARE, self.most), []
        for start in starts:
            corridor = np.sort(np.mod(cycle - start, self.count)).tolist()
            several.append(Paths(self.graph, start, most, corridor, reach))
        return (yield from self._run(several))

    def extend(self, most: int) -> bool:
        """Let cycles have twice as many lines, at most a number; whether they may have more than before."""
        before, self.most = self.most, max(self.most, min(2 * self.most, most, self.count))
        return self.most > before

    def cycle(self, number: int) -> IntArray:
        """(parts * number,) the lines of the best cycle, ascending."""
        return np.asarray((self._part(number) + self.count * np.arange(self.parts)[:, None]).ravel())

    def symmetrise(self) -> None:
        """Let what is free of a line be free of its images."""
        least = self.free.reshape(2, self.parts, self.count).min(axis=1)
        self.free = np.tile(least, self.parts)

    def _forget(self) -> None:
        self.totals, self.found, self.improved, self.tried = np.full(self.most + 1, np.inf), {}, 0, 0

    def _part(self, number: int) -> IntArray:
        return np.asarray(self.found[number].cycle(number))

    def _search(self, most: int, *starts: int) -> Generator[list[Paths], None, bool]:
        """Search cycles of at most a number of lines through some lines; whether one is better than before."""
        return (yield from self._run([Paths(self.graph, start, most, self.even, BAND) for start in starts]))

    def _run(self, several: list[Paths]) -> Generator[list[Paths], None, bool]:
        yield several
        kept = [self._keep(paths) for paths in several]
        return any(kept)

    def _keep(self, paths: Paths) -> bool:
        better = np.flatnonzero(paths.totals < self.totals[: len(paths.totals)])
        improved = False
        for k in better[better >= self.minimum].tolist():
            improved |= bool(paths.totals[k] < (1.0 - IMPROVED) * self.totals[k])
            self.totals[k], self.found[k] = paths.totals[k], paths
        return improved

    def _across(self, number: int) -> int:
        """The line opposite of the one that the best cycle of a number of lines was sought through."""
        cycle = self._part(number)
        own = int(np.searchsorted(cycle, self.found[number].start))
        return int(np.roll(cycle, -own)[number // 2])


def run_together(searches: Sequence[Iterator[list[Paths]]], tick: Tick = no_tick) -> None:
    """Run what searches around several outlines ask for, all at once."""
    while searches:
        tick(0.0)
        asked = [(search, programs) for search in searches if (programs := next(search, None)) is not None]
        run_batched([paths for _, programs in asked for paths in programs])
        searches = [search for search, _ in asked]


def least_sums(totals: list[FloatArray], count: int, copies: list[int]) -> list[FloatArray]:
    """For the first 0, 1, … outlines (n,) the least sum of areas of 0, 1, … lines in all, at most `count`.

    totals: for each outline the least area of each number of lines. copies: of each outline.
    """
    sums = [np.zeros(1)]
    for total, times in zip(totals, copies, strict=True):
        sums.append(np.full(min(count + 1, len(sums[-1]) + times * (len(total) - 1)), np.inf))
        for k in np.flatnonzero(np.isfinite(total)).tolist():
            room = sums[-1][times * k :]
            part = sums[-2][: len(room)] + total[k]
            np.minimum(room[: len(part)], part, out=room[: len(part)])
    return sums


def allocate(totals: list[FloatArray], count: int, copies: list[int]) -> list[int] | None:
    """Lines of each outline, together at most `count`, of the least sum of areas; None if there are none."""
    sums = least_sums(totals, count, copies)
    left = int(sums[-1].argmin())
    if not np.isfinite(sums[-1][left]):
        return None
    numbers = []
    for total, times, before in zip(reversed(totals), reversed(copies), sums[-2::-1], strict=True):
        fewest = max(0, -(-(left - len(before) + 1) // times))
        most = min(len(total) - 1, left // times)
        rest = left - times * np.arange(fewest, most + 1)
        numbers.append(fewest + int((before[rest] + total[fewest : most + 1]).argmin()))
        left -= times * numbers[-1]
    return numbers[::-1]
