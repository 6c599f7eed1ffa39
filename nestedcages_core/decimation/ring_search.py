"""The search around one outline: shortest cycles through several lines, since each program fixes the first one."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from copy import copy
from typing import Any, Self

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.convex_hull import convex_hull
from ..geometry.precision import ROUND_OFF
from .outline import Lines, Outline
from .shortest_cycles import Paths, run_batched
from .turns import Turns, turns

MAX_STARTS, APART = 4, 0.1
"""Number of lines through which a first cycle is sought; part of the outline in which no second such line lies."""

SUPPORTING = 1e6
"""Preference of lines that have the whole outline on one side: a cage is likely to follow one of them."""

CHEAP_WORK = 3e5
"""Turns times lines of the cage up to which there is time for one more search."""

MAX_ACROSS, MAX_MORE = 4, 6
"""Number of searches through the opposite line of the best cycle, and through lines between two lines of it
(docs/ablation.md: line cycles: searches through other lines)."""

MAX_MORE_IN_PARTS = 60
"""The same where rotations leave few lines to each part, so that the first one decides."""

MAX_MORE_IF_THOROUGH = 30
"""The same around convex outlines, where one of the lines between two of a cycle is in the best one (Aggarwal, Chang &
Yap 1985): of 1,540 random convex cages, 30 and 60 find the best to 0.1 %, and MAX_MORE misses 21 by up to 4.7 %."""

IMPROVED = 1e-3
"""Relative gain from which a search counts as one that improved something."""

SPARE = 3
"""Lines that a later search allows beyond those wanted."""

BAND = 24
"""Number of lines by which a cycle may run ahead of evenly spread ones or fall behind, where its number is known."""


class RingSearch:
    """The best cycles around one outline: `totals`, the least area for each number of lines, and which lines they are.

    Methods that search are generators of programs, which `run_together` runs with those of other outlines.
    """

    def __init__(
        self,
        outline: Outline,
        lines: Lines,
        free: FloatArray,
        *,
        width: int,
        sizes: range,
        expected: float,
        parts: int = 1,
        thorough: bool = False,
        known: bool = False,
    ) -> None:
        """free: (2, K) what is free of each line. sizes: the possible numbers of lines. expected: the likely one.

        parts: of the outline that rotations take to each other; lines are counted and sought in the first one.
        thorough: whether cycles are sought through all lines between two of a cycle, as far as these are few.
        known: whether cycles of the largest number alone matter.
        """
        self.outline, self.lines, self.free, self.sizes, self.expected = outline, lines, free, sizes, expected
        self.parts, self.count, self.most = parts, len(lines) // parts, sizes.stop - 1
        self.more = MAX_MORE_IN_PARTS if parts > 1 else MAX_MORE_IF_THOROUGH if thorough else MAX_MORE
        self.even = [k * self.count // self.most for k in range(self.most)] if known else None
        self.turns: Turns = turns(outline, lines, free, width)
        if parts > 1:
            self.turns = self.turns.of_part(self.count, len(lines))
        self.first: IntArray = np.searchsorted(self.turns.target, np.arange(self.count + 1))
        self.totals: FloatArray = np.full(sizes.stop, np.inf)
        self.found: dict[int, Any] = {}
        """What tells the best cycle of each number of lines."""

    def copy(self) -> Self:
        """The search as it is now, to go on from without changing it."""
        other = copy(self)
        other.free, other.totals, other.found = self.free.copy(), self.totals.copy(), dict(self.found)
        return other

    def solve(self, through: int | None = None) -> Iterator[list[Paths]]:
        """Search from scratch, after changes of `free`; through: a line that good cycles had."""
        self.areas = self.turns.within(self.free)
        self.totals, self.found = np.full(self.sizes.stop, np.inf), {}
        if through is not None:
            yield from self._search(through)
        if not self.found:
            yield from self._first_cycles()
        if not self.found:
            return
        spare = CHEAP_WORK / (len(self.areas) * self.sizes.stop)
        for _ in range(min(int(spare), MAX_ACROSS)):
            if not (yield from self._search(self._across(self.usual))):
                break
        more = self.more if self.more > MAX_MORE else min(int(spare), MAX_MORE)
        if more:
            cycle = self._part(self.usual)
            gaps = np.mod(np.roll(cycle, -1) - cycle - 1, self.count) + 1
            g = int(gaps.argmin())
            steps = np.unique(np.linspace(0, gaps[g], more + 2)[1:-1].astype(np.int64)).tolist()
            yield from self._search(*(int((cycle[g] + step) % self.count) for step in steps))

    def refine(self, number: int) -> Iterator[list[Paths]]:
        """Search once more through another line of the best cycle of a number of lines, near this cycle."""
        start = self._across(number)
        corridor = np.sort(np.mod(self._part(number) - start, self.count)).tolist()
        paths = Paths(self.turns, self.areas, self.first, start, min(number + SPARE, self.most), corridor)
        yield [paths]
        self._keep(paths)

    @property
    def usual(self) -> int:
        """The number of lines, of those found, that is closest to the expected one."""
        return min(self.found, key=lambda k: abs(k - self.expected))

    def cycle(self, number: int) -> IntArray:
        """(parts * number,) the lines of the best cycle, ascending."""
        return np.asarray((self._part(number) + self.count * np.arange(self.parts)[:, None]).ravel())

    def symmetrise(self) -> None:
        """Let what is free of a line be free of its images."""
        least = self.free.reshape(2, self.parts, self.count).min(axis=1)
        self.free = np.tile(least, self.parts)

    def _part(self, number: int) -> IntArray:
        return np.asarray(self.found[number].cycle(number))

    def _first_cycles(self) -> Iterator[list[Paths]]:
        """Search through the lines that most cycles are likely to have, until there is a cycle."""
        outline, lines = self.outline, self.lines.take(np.arange(self.count))
        open_ = np.isfinite(self.areas)
        onto, off = (np.bincount(ends[open_], minlength=self.count) for ends in (self.turns.target, self.turns.source))
        hull = outline.vertices[np.unique(np.floor(lines.place).astype(np.int64))]
        hull = hull[convex_hull(hull)] if len(hull) > 1 else hull
        above = (lines.right @ hull.T).max(axis=1) - (lines.right * lines.point).sum(axis=1)
        supports = (above <= ROUND_OFF * outline.length) & (not outline.is_hole)
        score = off * onto * np.where(supports, SUPPORTING, 1.0)
        for _ in range(MAX_STARTS):
            start = int(score.argmax())
            if self.found or score[start] <= 0.0:
                return
            yield from self._search(start)
            half = 0.5 * outline.size
            away = np.mod(lines.place - lines.place[start] + half, outline.size) - half
            score[np.abs(away) < APART * outline.size] = -1.0

    def _search(self, *starts: int) -> Generator[list[Paths], None, bool]:
        """Search cycles through some lines; whether one is better than before."""
        several = [Paths(self.turns, self.areas, self.first, start, self.most, self.even, BAND) for start in starts]
        yield several
        kept = [self._keep(paths) for paths in several]
        return any(kept)

    def _keep(self, paths: Paths) -> bool:
        better = np.flatnonzero(paths.totals < self.totals[: len(paths.totals)])
        improved = False
        for k in better[better >= self.sizes.start].tolist():
            improved |= bool(paths.totals[k] < (1.0 - IMPROVED) * self.totals[k])
            self.totals[k], self.found[k] = paths.totals[k], paths
        return improved

    def _across(self, number: int) -> int:
        """The line opposite of the one that the best cycle of a number of lines was sought through."""
        cycle = self._part(number)
        own = int(np.searchsorted(cycle, self.found[number].start))
        return int(np.roll(cycle, -own)[number // 2])


def run_together(searches: Sequence[Iterator[list[Paths]]]) -> None:
    """Run what searches around several outlines ask for, all at once."""
    while searches:
        asked = [(search, programs) for search in searches if (programs := next(search, None)) is not None]
        run_batched([paths for _, programs in asked for paths in programs])
        searches = [search for search, _ in asked]


def least_sums(totals: list[FloatArray], count: int, copies: list[int]) -> tuple[FloatArray, list[IntArray]]:
    """(n,) the least sum of areas of 0, 1, … lines in all, at most `count`, and the lines of each outline for those.

    totals: for each outline the least area of each number of lines. copies: of each outline.
    """
    least, picks = np.zeros(1), list[IntArray]()
    for total, times in zip(totals, copies, strict=True):
        sums = np.full((len(total), min(count + 1, len(least) + times * (len(total) - 1))), np.inf)
        for k in np.flatnonzero(np.isfinite(total)).tolist():
            part = least[: max(0, sums.shape[1] - times * k)]
            sums[k, times * k : times * k + len(part)] = total[k] + part
        picks.append(sums.argmin(axis=0))
        least = sums.min(axis=0)
    return least, picks


def allocate(totals: list[FloatArray], count: int, copies: list[int]) -> list[int] | None:
    """Lines of each outline, together at most `count`, of the least sum of areas; None if there are none."""
    least, picks = least_sums(totals, count, copies)
    if not np.isfinite(least.min()):
        return None
    left, numbers = int(least.argmin()), []
    for pick, times in zip(reversed(picks), reversed(copies), strict=True):
        numbers.append(int(pick[left]))
        left -= times * numbers[-1]
    return numbers[::-1]
