"""Where edges of the chosen cycles cross, one of the two is shortened, and so are the lines around it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.predicates import segments_intersect
from ..geometry.vectors import cross, dot
from .ring_search import RingSearch
from .turns import SLACK

if TYPE_CHECKING:
    from .symmetric import Images

SHORTENED = 0.999
"""Fraction of the distance to the crossing that stays free."""


class Choice(NamedTuple):
    """The cycles of all outlines, in the order of these. Each array has an entry for each edge."""

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
    def of(cls, searches: Mapping[int, RingSearch], numbers: Mapping[int, int], images: Images | None) -> Choice:
        """The best cycles with certain numbers of lines, for each outline that stands for its images, and those."""
        cycles: list[IntArray] = []
        edges: list[tuple[FloatArray, ...]] = []
        for loop, element in [(k, 0) for k in searches] if images is None else images.loops:
            cycle = searches[loop].cycle(numbers[loop])
            if images is not None and images.reverses(element):
                cycle = cycle[::-1]
            lines = searches[loop].lines.take(cycle)
            if images is not None and element:
                lines = images.lines(lines, element)
            start = lines.meeting()
            cycles.append(cycle)
            edges.append((lines.point, lines.direction, start, np.roll(start, -1, axis=0)))
        point, direction, start, end = (np.concatenate(each) for each in zip(*edges, strict=True))
        loop_of = np.repeat(np.arange(len(cycles)), [len(cycle) for cycle in cycles])
        return cls([each[2] for each in edges], loop_of, np.concatenate(cycles), point, direction, start, end, images)

    def crossings(self) -> tuple[IntArray, IntArray]:
        """Pairs of edges that cross and are not neighbours."""
        i, j = BoxTree(self.start, self.end).pairs()
        begin = np.searchsorted(self.loop, self.loop)
        size = np.searchsorted(self.loop, self.loop, "right") - begin
        gap = np.mod(i - j, size[i])
        apart = (self.loop[i] != self.loop[j]) | ((gap > 1) & (gap < size[i] - 1))
        i, j = i[apart], j[apart]
        met = segments_intersect(self.start[i], self.end[i], self.start[j], self.end[j])
        return i[met], j[met]

    def shorten(self, searches: Mapping[int, RingSearch], i: IntArray, j: IntArray, rule: float) -> set[int]:
        """Shorten what is free of the lines of crossing edges where they meet the other edge; the loops that changed.

        Of each pair, the edge whose contact is farther from the crossing is shortened. rule: factor on the distance of
        the first one. The candidates between its neighbours in the cycle are shortened with it.
        """
        changed = set()
        for a, b in zip(i.tolist(), j.tolist(), strict=True):
            sine = float(cross(self.direction[a], self.direction[b]))
            if sine == 0.0:
                continue
            step = self.point[b] - self.point[a]
            s, t = float(cross(step, self.direction[b])) / sine, float(cross(step, self.direction[a])) / sine
            if abs(s) * rule > abs(t):
                a, b, s = b, a, t
            loop, element = (int(self.loop[b]), 0) if self.images is None else self.images.loops[self.loop[b]]
            blocking = np.stack((self.point[a], self.end[a] if s > 0.0 else self.start[a]))
            if self.images is not None and element:
                blocking = self.images.points(blocking, -element)
            _end_at(searches[loop], self._bundle(searches[loop], a, b), *blocking)
            searches[loop].symmetrise()
            changed.add(loop)
        return changed

    def _bundle(self, search: RingSearch, a: int, b: int) -> IntArray:
        """The lines between those before and after edge b in its cycle, without that of edge a."""
        own = np.flatnonzero(self.loop == self.loop[b])
        at = b - int(own[0])
        low, high = int(self.line[own[at - 1]]), int(self.line[own[(at + 1) % len(own)]])
        if self.images is not None and self.images.reverses(self.images.loops[self.loop[b]][1]):
            low, high = high, low
        count = len(search.lines)
        bundle = np.mod(low + 1 + np.arange((high - low - 1) % count), count)
        return bundle[bundle != self.line[a]] if self.loop[a] == self.loop[b] else bundle


def _end_at(search: RingSearch, bundle: IntArray, start: FloatArray, end: FloatArray) -> None:
    """End what is free of some lines at a segment."""
    point, direction = search.lines.point[bundle], search.lines.direction[bundle]
    before, after = cross(direction, start - point), cross(direction, end - point)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = dot(start + (before / (before - after))[:, None] * (end - start) - point, direction)
    met = (before > 0.0) != (after > 0.0)
    for way, sign in ((0, 1.0), (1, -1.0)):
        some = met & (sign * along > 0.0)
        k = bundle[some]
        search.free[way, k] = np.minimum(search.free[way, k], SHORTENED * np.abs(along[some]) - SLACK)
