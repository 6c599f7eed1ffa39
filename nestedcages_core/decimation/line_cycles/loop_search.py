"""The search around one loop: shortest cycles through several lines, since each program fixes the first one."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence

import numpy as np

from ...errors import NestingError
from ...geometry.arrays import FloatArray, IntArray
from ...geometry.broad_phase import CHUNK_PAIRS
from ...geometry.precision import ROUND_OFF
from .chain import Chain, Lines
from .shortest_cycles import Paths
from .turns import Turns, turns

MAX_STARTS = 4
"""Number of lines through which a first cycle is sought."""

APART = 0.1
"""Part of the loop in which no second such line lies."""

SUPPORTING = 1e6
"""Preference of lines that have the whole loop on one side: a cage is likely to follow one of them."""


CHEAP_WORK = 3e5
"""Turns times lines of the cage up to which there is time for one more search."""

MAX_ACROSS, MAX_MORE = 4, 6
"""Number of searches through the opposite line of the best cycle, and through lines between two lines of it
(docs/ablation.md: line cycles: searches through other lines)."""

MAX_MORE_IN_PARTS = 60
"""The same where rotations leave few lines to each part, so that the first one decides."""

MAX_MORE_IF_THOROUGH = 30
"""The same around convex loops, where one of the lines between two of a cycle is in the best one (Aggarwal, Chang & Yap
1985): of 1,540 random convex cages, 30 and 60 find the best to 0.1 %, and MAX_MORE misses 21 by up to 4.7 %."""

IMPROVED = 1e-3
"""Relative gain from which a search counts as one that improved something."""

SPARE = 3
"""Lines that a later search allows beyond those wanted."""

BAND = 64
"""Number of lines by which a cycle may run ahead of evenly spread ones or fall behind, where its number is known: half
of it made the cage around a wheel with teeth on one side looser by a twentieth."""


class NoCyclesError(NestingError):
    """No cycles of lines were found."""

    blocked: Sequence[int] = ()
    """Loops around which there are none."""

    @classmethod
    def around(cls, loops: Sequence[int]) -> NoCyclesError:
        """There are none around some loops."""
        error = cls("There are no such cycles around some loops.", code="count.too_small")
        error.blocked = loops
        return error


class LoopSearch:
    """The best cycles around one loop: `totals`, the least area for each number of lines, and which lines they are."""

    def __init__(
        self,
        chain: Chain,
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

        parts: of the loop that rotations take to each other; lines are counted and sought in the first one.
        thorough: whether cycles are sought through all lines between two of a cycle, as far as these are few.
        known: whether cycles of the largest number alone matter.
        """
        self.chain, self.lines, self.free, self.sizes, self.expected = chain, lines, free, sizes, expected
        self.parts, self.count = parts, len(lines) // parts
        self.more = MAX_MORE_IN_PARTS if parts > 1 else MAX_MORE_IF_THOROUGH if thorough else MAX_MORE
        self.most = sizes.stop - 1
        self.even = [k * self.count // self.most for k in range(self.most)] if known else None
        self.turns: Turns = turns(chain, lines, free, width)
        if parts > 1:
            self.turns = self.turns.of_part(self.count, len(lines))
        self.first: IntArray = np.searchsorted(self.turns.target, np.arange(self.count + 1))
        self.totals: FloatArray = np.zeros(0)
        self.found: dict[int, Paths] = {}

    def solve(self, through: int | None = None) -> Iterator[list[Paths]]:
        """Search from scratch, after changes of `free`; through: a line that good cycles had.

        Yields what is to be run, with that of other loops.
        """
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
            if not (yield from self._search(self._across(self._usual()))):
                break
        more = self.more if self.more > MAX_MORE else min(int(spare), MAX_MORE)
        if more:
            cycle = self._part(self._usual())
            gaps = np.mod(np.roll(cycle, -1) - cycle - 1, self.count) + 1
            g = int(gaps.argmin())
            steps = np.unique(np.linspace(0, gaps[g], more + 2)[1:-1].astype(np.int64)).tolist()
            yield from self._search(*(int((cycle[g] + step) % self.count) for step in steps))

    def refine(self, number: int) -> Iterator[list[Paths]]:
        """Search once more through another line of the best cycle of a number of lines, near this cycle."""
        start = self._across(number)
        corridor = np.sort(np.mod(self._part(number) - start, self.count)).tolist()
        most = min(number + SPARE, self.most)
        paths = Paths(self.turns, self.areas, self.first, start, most, corridor)
        yield [paths]
        self._keep(paths)

    def cycle(self, number: int) -> IntArray:
        """(parts * number,) the lines of the best cycle, ascending."""
        part = self._part(number)
        return np.asarray((part + self.count * np.arange(self.parts)[:, None]).ravel())

    def share(self) -> None:
        """What is free of a line is free of its images."""
        least = self.free.reshape(2, self.parts, self.count).min(axis=1)
        self.free = np.tile(least, self.parts)

    def _part(self, number: int) -> IntArray:
        return self.found[number].cycle(number)

    def _first_cycles(self) -> Iterator[list[Paths]]:
        """Search through the lines that most cycles are likely to have, until there is a cycle."""
        chain, count = self.chain, self.count
        lines = self.lines.take(np.arange(count))
        open_ = np.isfinite(self.areas)
        onto = np.bincount(self.turns.target[open_], minlength=count)
        off = np.bincount(self.turns.source[open_], minlength=count)
        above = np.concatenate([
            (right @ chain.vertices.T).max(axis=1)
            for right in np.array_split(lines.right, -(-count * chain.size // CHUNK_PAIRS))
        ]) - (lines.right * lines.point).sum(axis=1)  # fmt: skip
        supports = (above <= ROUND_OFF * chain.length) & (chain.swept[-1] > 0.0)
        score = off * onto * np.where(supports, SUPPORTING, 1.0)
        for _ in range(MAX_STARTS):
            start = int(score.argmax())
            if self.found or score[start] <= 0.0:
                return
            yield from self._search(start)
            apart = np.mod(lines.place - lines.place[start] + 0.5 * chain.size, chain.size) - 0.5 * chain.size
            score[np.abs(apart) < APART * chain.size] = -1.0

    def _search(self, *starts: int) -> Generator[list[Paths], None, bool]:
        """Search cycles through some lines; whether one is better than before."""
        several = [Paths(self.turns, self.areas, self.first, start, self.most, self.even, BAND) for start in starts]
        yield several
        kept = [self._keep(paths) for paths in several]
        return any(kept)

    def _keep(self, paths: Paths) -> bool:
        totals = paths.totals
        better = np.flatnonzero(totals < self.totals[: len(totals)])
        improved = False
        for k in better[better >= self.sizes.start].tolist():
            improved |= bool(totals[k] < (1.0 - IMPROVED) * self.totals[k])
            self.totals[k], self.found[k] = totals[k], paths
        return improved

    def _usual(self) -> int:
        """The number of lines, of those found, that is closest to the expected one."""
        return min(self.found, key=lambda k: abs(k - self.expected))

    def _across(self, number: int) -> int:
        """The line opposite of the one that the best cycle of a number of lines was sought through."""
        cycle = self._part(number)
        own = int(np.searchsorted(cycle, self.found[number].start))
        return int(np.roll(cycle, -own)[number // 2])


def allocation(totals: list[FloatArray], count: int, copies: list[int]) -> list[int] | None:
    """Lines per loop, each as many times as it has copies, together at most `count`, of the least sum of areas.

    None if there are none.
    """
    least, picks = np.zeros(1), []
    for total, times in zip(totals, copies, strict=True):
        sums = np.full((len(total), min(count + 1, len(least) + times * (len(total) - 1))), np.inf)
        for k in np.flatnonzero(np.isfinite(total)).tolist():
            part = least[: max(0, sums.shape[1] - times * k)]
            sums[k, times * k : times * k + len(part)] = total[k] + part
        picks.append(sums.argmin(axis=0))
        least = sums.min(axis=0)
    if not np.isfinite(least.min()):
        return None
    left, numbers = int(least.argmin()), []
    for pick, times in zip(reversed(picks), reversed(copies), strict=True):
        numbers.append(int(pick[left]))
        left -= times * numbers[-1]
    return numbers[::-1]
