"""The chosen cycles of all loops, and where their edges cross."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import copy
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.predicates import BoxTree, segments_intersect
from .chain import Lines
from .shortest_cycles import Paths

if TYPE_CHECKING:
    from .images import Images


class Search(Protocol):
    """The best cycles around one loop."""

    lines: Lines
    free: FloatArray
    """(2, K) what is free of each line, forwards and backwards."""
    totals: FloatArray
    """The least area for each number of lines."""

    found: dict[int, Any]
    """What tells the best cycle of each number of lines."""

    def solve(self, through: int | None = None) -> Iterator[list[Paths]]:
        """Search from scratch, at first and after changes of `free`. Yields programs that are to be run."""

    def refine(self, number: int) -> Iterator[list[Paths]]:
        """Search once more near the best cycle of a number of lines."""

    def cycle(self, number: int) -> IntArray:
        """The lines of the best cycle of a number of lines, ascending."""

    def share(self) -> None:
        """Take what is free of a line from its images too."""


AnySearch = TypeVar("AnySearch", bound=Search)


def again(search: AnySearch) -> AnySearch:
    """The search as it is now, to go on from without changing it."""
    other = copy(search)
    other.free, other.totals, other.found = search.free.copy(), search.totals.copy(), dict(search.found)
    return other


class Choice(NamedTuple):
    """The cycles of all loops, in the order of these. Each array has an entry for each edge."""

    rings: list[FloatArray]
    loop: IntArray
    line: IntArray
    """The line that the edge, or of which it is an image, lies on."""
    point: FloatArray
    direction: FloatArray
    start: FloatArray
    end: FloatArray
    images: Images | None

    @classmethod
    def of(cls, searches: Mapping[int, Search], numbers: Mapping[int, int], images: Images | None) -> Choice:
        """The best cycles with certain numbers of lines, for each loop that stands for its images, and those."""
        cycles: list[IntArray] = []
        edges: list[tuple[FloatArray, ...]] = []
        loops = [(k, 0) for k in searches] if images is None else images.loops
        for loop, element in loops:
            cycle = searches[loop].cycle(numbers[loop])
            lines = searches[loop].lines.take(cycle)
            start = lines.meeting()
            end, direction = np.roll(start, -1, axis=0), lines.direction
            point = lines.point
            if images is not None and element:
                direction = images.directions(point, direction, element)
                point, start, end = (images.points(each, element) for each in (point, start, end))
                if images.reverses(element):
                    cycle = cycle[::-1]
                    point, direction, start, end = (each[::-1] for each in (point, direction, end, start))
            cycles.append(cycle)
            edges.append((point, direction, start, end))
        point, direction, start, end = (np.concatenate(each) for each in zip(*edges, strict=True))
        loop_of = np.repeat(np.arange(len(cycles)), [len(cycle) for cycle in cycles])
        return cls([each[2] for each in edges], loop_of, np.concatenate(cycles), point, direction, start, end, images)

    def crossings(self) -> tuple[IntArray, IntArray]:
        """Pairs of edges that cross and are not neighbours."""
        i, j = BoxTree(self.start, self.end).self_pairs()
        begin = np.searchsorted(self.loop, self.loop)
        size = np.searchsorted(self.loop, self.loop, "right") - begin
        gap = np.mod(i - j, size[i])
        apart = (self.loop[i] != self.loop[j]) | ((gap > 1) & (gap < size[i] - 1))
        i, j = i[apart], j[apart]
        met = segments_intersect(self.start[i], self.end[i], self.start[j], self.end[j])
        return i[met], j[met]
