"""Crossings: where edges of the chosen cycles cross, one of the two is shortened, and so are the lines around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.predicates import BoxTree, segments_intersect
from ...geometry.vectors import cross
from .loop_search import LoopSearch
from .turns import SLACK

SHORTENED = 0.999
"""Fraction of the distance to the crossing that stays free."""


@dataclass(frozen=True, eq=False)
class Choice:
    """The cycles of all loops. Edge e lies on line `line[e]` of loop `loop[e]`, from `start[e]` to `end[e]`."""

    rings: list[FloatArray]
    loop: IntArray
    line: IntArray
    start: FloatArray
    end: FloatArray

    @classmethod
    def of(cls, searches: list[LoopSearch], numbers: list[int]) -> Choice:
        """The best cycles with certain numbers of lines."""
        cycles = [search.cycle(k) for search, k in zip(searches, numbers, strict=True)]
        rings = [search.lines.take(cycle).meeting() for search, cycle in zip(searches, cycles, strict=True)]
        loop = np.repeat(np.arange(len(rings)), numbers)
        ends = [np.roll(ring, -1, axis=0) for ring in rings]
        return cls(rings, loop, np.concatenate(cycles), np.concatenate(rings), np.concatenate(ends))

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


def give_way(searches: list[LoopSearch], choice: Choice, i: IntArray, j: IntArray, bias: float) -> set[int]:
    """Shorten what is free of the lines of crossing edges where they meet the other edge; the loops that changed.

    Of each pair, the edge whose contact is farther from the crossing is shortened. bias: factor on the distance of the
    first one. The candidates between its neighbours in the cycle are shortened with it.
    """
    changed = set()
    for a, b in zip(i.tolist(), j.tolist(), strict=True):
        p, d = _line(searches, choice, a)
        q, f = _line(searches, choice, b)
        sine = float(cross(d, f))
        if sine == 0.0:
            continue
        s, t = float(cross(q - p, f)) / sine, float(cross(q - p, d)) / sine
        if abs(s) * bias > abs(t):
            a, b, p, s = b, a, q, t
        end = choice.end[a] if s > 0.0 else choice.start[a]
        _shorten(searches[choice.loop[b]], _bundle(searches, choice, a, b), p, end)
        changed.add(int(choice.loop[b]))
    return changed


def _line(searches: list[LoopSearch], choice: Choice, edge: int) -> tuple[FloatArray, FloatArray]:
    lines = searches[choice.loop[edge]].lines
    return lines.point[choice.line[edge]], lines.direction[choice.line[edge]]


def _bundle(searches: list[LoopSearch], choice: Choice, a: int, b: int) -> IntArray:
    """The lines between those before and after edge b in its cycle, without that of edge a."""
    own = np.flatnonzero(choice.loop == choice.loop[b])
    at = b - int(own[0])
    low, high = int(choice.line[own[at - 1]]), int(choice.line[own[(at + 1) % len(own)]])
    count = len(searches[choice.loop[b]].lines)
    bundle = np.mod(low + 1 + np.arange((high - low - 1) % count), count)
    return bundle[bundle != choice.line[a]] if choice.loop[a] == choice.loop[b] else bundle


def _shorten(search: LoopSearch, bundle: IntArray, start: FloatArray, end: FloatArray) -> None:
    """End what is free of some lines at a segment."""
    point, direction = search.lines.point[bundle], search.lines.direction[bundle]
    before, after = cross(direction, start - point), cross(direction, end - point)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = start + (before / (before - after))[:, None] * (end - start)
        along = ((crossing - point) * direction).sum(axis=1)
    met = (before > 0.0) != (after > 0.0)
    for way, sign in ((0, 1.0), (1, -1.0)):
        some = met & (sign * along > 0.0)
        k = bundle[some]
        search.free[way, k] = np.minimum(search.free[way, k], SHORTENED * np.abs(along[some]) - SLACK)
