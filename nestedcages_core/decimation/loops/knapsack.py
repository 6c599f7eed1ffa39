"""The best split of vertices over a tree of outlines, each of which may be kept, filled, or joined with others.

An option knows the least area for each number of vertices: of an outline from its search, of a filled hole with no
vertices at all, of several options together by distributing the vertices, of alternatives the smaller one.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from .parts import Hole, Kind, Part


class Option:
    """What may become of a part of the drawing."""

    least: FloatArray
    """(K,) the least area that a cage of exactly 0, 1, … vertices adds; infinite where there is none."""

    kept: Sequence[Kind] = ()
    """The outlines that it keeps of its own."""

    def split(self, count: int) -> list[tuple[Option, int]]:
        """The options that the best cage of a number of vertices takes, and their numbers."""
        return []

    def chosen(self, count: int) -> list[Kind]:
        """The outlines that the best cage of a number of vertices keeps."""
        kept, left = list[Kind](), [(self, count)]
        while left:
            option, number = left.pop()
            kept += option.kept
            left += reversed(option.split(number))
        return kept


@dataclass(eq=False)
class KeptLoop(Option):
    """An outline with a loop of the cage."""

    what: Kind
    price: float
    """Area that each loop costs in addition."""

    def __post_init__(self) -> None:
        self.least, self.kept = self.what.table + self.what.added + self.price, (self.what,)


@dataclass(eq=False)
class Filled(Option):
    """A hole that is filled, with all that is in it."""

    hole: Hole

    def __post_init__(self) -> None:
        self.least = np.array([self.hole.open_area])


class Together(Option):
    """Several options at once."""

    def __init__(self, options: Sequence[Option], most: int) -> None:
        """most: vertices of all together."""
        self.options, self.picks = options, list[IntArray]()
        self.least = np.zeros(1)
        for option in options:
            size = min(most + 1, len(self.least) + len(option.least) - 1)
            sums = np.full((len(option.least), max(size, 1)), np.inf)
            for k in np.flatnonzero(np.isfinite(option.least[:size])).tolist():
                part = self.least[: sums.shape[1] - k]
                sums[k, k : k + len(part)] = option.least[k] + part
            self.picks.append(sums.argmin(axis=0))
            self.least = sums.min(axis=0)

    def split(self, count: int) -> list[tuple[Option, int]]:
        parts = list[tuple[Option, int]]()
        for option, pick in zip(reversed(self.options), reversed(self.picks), strict=True):
            parts.append((option, int(pick[count])))
            count -= parts[-1][1]
        return parts


class Either(Option):
    """The better one of two options."""

    def __init__(self, first: Option, second: Option) -> None:
        self.options = first, second
        self.least = np.full(max(len(first.least), len(second.least)), np.inf)
        for option in self.options:
            self.least[: len(option.least)] = np.minimum(self.least[: len(option.least)], option.least)

    def split(self, count: int) -> list[tuple[Option, int]]:
        first, second = self.options
        is_first = count < len(first.least) and first.least[count] == self.least[count]
        return [(first if is_first else second, count)]


Making: TypeAlias = Generator["Making", Option, Option]
"""Makes an option from others, each of which it asks for: parts may lie in each other deeper than Python calls."""


class Tree:
    """All that may become of a drawing."""

    def __init__(self, most: int, price: float = 0.0) -> None:
        """most: vertices of all outlines together. price: area that each loop costs in addition to its own."""
        self.most, self.price = most, price

    def of_parts(self, parts: Sequence[Part]) -> Option:
        """Some parts and their holes."""
        made: Option | None = None
        stack = [self._of_parts(parts)]
        while stack:
            try:
                stack.append(next(stack[-1]) if made is None else stack[-1].send(made))
                made = None
            except StopIteration as end:
                stack.pop()
                made = end.value
        assert made is not None
        return made

    def _of_parts(self, parts: Sequence[Part]) -> Making:
        holes = [hole for part in parts for hole in part.holes]
        return self._together([*map(self._of_part, parts), *map(self._of_hole, holes)])

    def _together(self, making: Sequence[Making], *options: Option) -> Making:
        made = list(options)
        for each in making:
            made.append((yield each))
        return Together(made, self.most)

    def _of_part(self, part: Part) -> Making:
        """The outline of a part, or those of the parts that share it."""
        kept = KeptLoop(part, self.price)
        return Either(kept, (yield self._together([*map(self._of_part, part.joined)]))) if part.joined else kept

    def _of_hole(self, hole: Hole) -> Making:
        """A hole and the parts in it, or nothing of it."""
        return Either(Filled(hole), (yield self._within(hole)))

    def _within(self, hole: Hole) -> Making:
        """The outline of a hole and what may become of the parts in it, and of those joined to it."""
        inside = self._of_parts(hole.parts), *map(self._of_hole, hole.inner)
        kept = yield self._together(inside, KeptLoop(hole, self.price))
        return kept if hole.before is None else Either(kept, (yield self._within(hole.before)))
