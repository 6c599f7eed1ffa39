"""The best split of vertices over a tree of outlines, each of which may be kept, filled, or joined with others.

An option knows the least area for each number of vertices: of an outline from its search, of a filled hole with no
vertices at all, of several options together by distributing the vertices, of alternatives the smaller one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from .parts import Hole, Kind, Part


class Option:
    """What may become of a part of the drawing."""

    least: FloatArray
    """(K,) the least area that a cage of exactly 0, 1, … vertices adds; infinite where there is none."""

    def chosen(self, count: int) -> list[Kind]:
        """The outlines that the best cage of a number of vertices keeps."""
        raise NotImplementedError


@dataclass(eq=False)
class KeptLoop(Option):
    """An outline with a loop of the cage."""

    what: Kind
    price: float
    """Area that each loop costs in addition."""

    def __post_init__(self) -> None:
        self.least = self.what.table + self.what.added + self.price

    def chosen(self, count: int) -> list[Kind]:
        return [self.what]


@dataclass(eq=False)
class Filled(Option):
    """A hole that is filled, with all that is in it."""

    hole: Hole

    def __post_init__(self) -> None:
        self.least = np.array([self.hole.open_area])

    def chosen(self, count: int) -> list[Kind]:
        return []


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

    def chosen(self, count: int) -> list[Kind]:
        kept: list[Kind] = []
        for option, pick in zip(reversed(self.options), reversed(self.picks), strict=True):
            number = int(pick[count])
            kept += option.chosen(number)
            count -= number
        return kept


class Either(Option):
    """The better one of two options."""

    def __init__(self, first: Option, second: Option) -> None:
        self.options = first, second
        self.least = np.full(max(len(first.least), len(second.least)), np.inf)
        for option in self.options:
            self.least[: len(option.least)] = np.minimum(self.least[: len(option.least)], option.least)

    def chosen(self, count: int) -> list[Kind]:
        first, second = self.options
        is_first = count < len(first.least) and first.least[count] == self.least[count]
        return (first if is_first else second).chosen(count)


class Tree:
    """All that may become of a drawing."""

    def __init__(self, most: int, price: float = 0.0) -> None:
        """most: vertices of all outlines together. price: area that each loop costs in addition to its own."""
        self.most, self.price = most, price

    def of_parts(self, parts: Sequence[Part]) -> Option:
        """Some parts and their holes."""
        holes = [hole for part in parts for hole in part.holes]
        return Together([*map(self._of_part, parts), *map(self._of_hole, holes)], self.most)

    def _of_part(self, part: Part) -> Option:
        """The outline of a part, or those of the parts that share it."""
        kept = KeptLoop(part, self.price)
        return Either(kept, Together([*map(self._of_part, part.joined)], self.most)) if part.joined else kept

    def _of_hole(self, hole: Hole) -> Option:
        """A hole and the parts in it, or nothing of it."""
        return Either(Filled(hole), self._within(hole))

    def _within(self, hole: Hole) -> Option:
        """The outline of a hole and what may become of the parts in it, and of those joined to it."""
        inner = map(self._of_hole, hole.inner)
        kept = Together([KeptLoop(hole, self.price), self.of_parts(hole.parts), *inner], self.most)
        return kept if hole.before is None else Either(kept, self._within(hole.before))
