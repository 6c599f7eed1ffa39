"""Turns: the pairs of lines that can follow each other in a cage, and the area each adds between cage and outline."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import position_in_group
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import cross, norm
from .outline import Lines, Outline

SingleArray: TypeAlias = NDArray[np.float32]

SLACK = 1e-5
"""Length, in diameters, by which a vertex may lie beyond the free part of a line: the clearance of an offset."""

PIN_REACH = 1e-3
"""Distance from a pin, in diameters of the shape, up to which a vertex counts as pinned."""

PIN_LOST = 0.5
"""Distance from a pin, in diameters, from which it does not matter how far away a vertex is."""

PIN_COST = 10.0
"""Cost of a vertex for its distance from a pin that it stands for, in diameters, beyond `PIN_REACH`."""

LIMIT_COST = 0.25
"""Cost of edges for what each half lacks of the least length, and of angles, by the cosine."""

FAR_PART = 0.5
"""Part of the usual width, in lines, from which a line over a pocket may follow any line."""


WIDER = 1.25
"""How much wider than the narrowest of them windows are that are looked at together."""

BLOCK_PAIRS = 2**15
"""Pairs tested together: their arrays stay in the processor's cache (measured)."""

CHUNK = 2**14
"""The same of those that are measured."""


class Turns(NamedTuple):
    """P pairs of lines that meet, sorted by the second line."""

    source: IntArray
    """(P,) the line that is left."""
    target: IntArray
    """(P,) the line that is taken."""
    forth: FloatArray
    """(P,) distance of the vertex from the contact of the first line, along it."""
    back: FloatArray
    """(P,) distance of the vertex from the contact of the second line, against it."""
    area: SingleArray
    """(P,) single precision: between the path from contact to contact by the vertex, and the outline."""

    def of_loop(self, begin: int, end: int) -> Turns:
        """Those of the lines from one number up to another, which are counted from there."""
        own = slice(*np.searchsorted(self.target, (begin, end)).tolist())
        source, target = self.source[own] - begin, self.target[own] - begin
        return Turns(source, target, self.forth[own], self.back[own], self.area[own])

    def of_part(self, count: int, lines: int) -> Turns:
        """Those onto the first lines, of which there are as many in each part, each line as that of the first part."""
        kept = np.flatnonzero((self.target < count) & (np.mod(self.target - self.source - 1, lines) < count))
        source = self.source[kept] % count
        return Turns(source, self.target[kept], self.forth[kept], self.back[kept], self.area[kept])

    def within(self, free: FloatArray) -> SingleArray:
        """(P,) the areas; infinite where the vertex lies beyond what is free (2, K) of either line."""
        blocked = (self.forth > free[0][self.source]) | (self.back > free[1][self.target])
        areas: SingleArray = np.where(blocked, np.float32(np.inf), self.area)
        return areas


def turns(outline: Outline, lines: Lines, free: FloatArray, width: IntArray) -> Turns:
    """The turns onto lines (K,) with free parts (2, K) from one of the lines before on the same loop; each has some.

    width: (L,) how many lines before; those over pockets that are longer than that may follow any line.
    """
    loop = outline.loop_at(lines.place)
    counts = np.bincount(loop, minlength=len(outline.sizes))
    begins = np.cumsum(counts) - counts
    first = np.searchsorted(lines.place, outline.wrapped(lines.place - lines.skipped, loop))
    over = np.mod(np.arange(len(lines)) - first, counts[loop])
    far = (lines.skipped > 0.0) & (over > FAR_PART * width[loop])
    i, j = _meeting(lines, free, begins, counts, np.where(far, counts[loop] - 1, width[loop]))
    parts = [slice(first, first + CHUNK) for first in range(0, max(1, len(i)), CHUNK)]
    measured = _Measured(outline, lines, free, loop)
    found = zip(*(measured.turns(i[part], j[part]) for part in parts), strict=True)
    i, j, forth, back, area = (np.concatenate(each) for each in found)
    if outline.weights is not None:
        area *= outline.mean_weight(lines.place[i], lines.place[j])
    if len(outline.pins):
        area += _pin_costs(outline, lines, i, j, forth)
    short, sharp = outline.limits
    if short > 0.0:  # both edges have their contact near the middle
        area += LIMIT_COST * (np.maximum(0.0, 0.5 * short - forth) + np.maximum(0.0, 0.5 * short - back))
    if sharp > 0.0:
        straight = (lines.direction[i] * lines.direction[j]).sum(axis=1)
        area += LIMIT_COST * np.maximum(0.0, -np.cos(np.radians(sharp)) - straight)
    return Turns(i, j, forth, back, area.astype(np.float32))


class _Measured:
    """Lines, with what turns between them are measured by."""

    def __init__(self, outline: Outline, lines: Lines, free: FloatArray, loop: IntArray) -> None:
        origin, edge = outline.origins[loop], lines.place.astype(np.int64)
        (self.x, self.y), (self.u, self.v), self.free = (lines.point - origin).T.copy(), lines.direction.T.copy(), free
        # the areas from a line's contact back to where it belongs on the outline, and along the outline to its start
        start = outline.vertices[edge] - origin
        foot: FloatArray = start + np.mod(lines.place, 1.0)[:, None] * outline.edges[edge]
        self.rest = cross(lines.point - origin, foot) - outline.swept[edge] - cross(start, foot)
        self.around: FloatArray = outline.areas[loop]

    def turns(self, i: IntArray, j: IntArray) -> tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray]:
        """Those of pairs (P,) that meet where both lines are free: the pairs, forth, back and area."""
        x, y, u, v = self.x.take(i), self.y.take(i), self.u.take(i), self.v.take(i)
        wx, wy, uj, vj = self.x.take(j) - x, self.y.take(j) - y, self.u.take(j), self.v.take(j)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            sine = u * vj - v * uj
            forth, back = (wx * vj - wy * uj) / sine, (u * wy - v * wx) / sine
            sound = (np.abs(sine) > ROUND_OFF) & (forth >= -SLACK) & (back >= -SLACK)
            sound &= (forth <= self.free[0].take(i)) & (back <= self.free[1].take(j))
            area = wy * (x + forth * u) - wx * (y + forth * v)
            area += self.rest.take(j) - self.rest.take(i) - np.where(j < i, self.around.take(j), 0.0)
            sound &= area > -ROUND_OFF
        kept = np.flatnonzero(sound)
        return i.take(kept), j.take(kept), forth.take(kept), back.take(kept), 0.5 * area.take(kept)


def _pin_costs(outline: Outline, lines: Lines, i: IntArray, j: IntArray, forth: FloatArray) -> FloatArray:
    """(P,) the cost of turns that pass pins, by the distance of their vertices from these."""
    vertex = lines.point[i] + forth[:, None] * lines.direction[i]
    cost, loop, start = np.zeros(len(i)), outline.loop_at(lines.place[i]), lines.place[i]
    size = outline.sizes[loop]
    way = np.mod(lines.place[j] - start, size)
    for pin in outline.pins.tolist():
        passed = (loop == outline.loop[pin]) & (np.mod(pin - start, size) < way)
        away = norm(vertex[passed] - outline.vertices[pin])
        cost[passed] += PIN_COST * np.clip(away - PIN_REACH, 0.0, PIN_LOST)
    return cost


def _meeting(
    lines: Lines, free: FloatArray, begins: IntArray, counts: IntArray, width: IntArray
) -> tuple[IntArray, IntArray]:
    """Pairs of lines that meet where both are free, or nearly so: a first test in single precision.

    begins, counts: (L,) the lines of each loop. width: (K,) how many lines before each it may follow.
    """
    # before the lines of a loop stand the last of them again, and before all as many as the longest window has
    before, wide = np.maximum.reduceat(width, begins), int(width.max())
    copies, sizes = before + counts, np.repeat(counts, before + counts)
    again = np.repeat(begins, copies) + np.mod(position_in_group(copies) - np.repeat(before, copies), sizes)
    values = np.stack((*lines.point.T, *lines.direction.T, *free)).astype(np.float32)
    around = np.concatenate((np.zeros((6, wide), np.float32), values[:, again]), axis=1)
    order = np.argsort(width, kind="stable")
    ends = wide + np.arange(len(width)) + np.repeat(np.cumsum(before), counts)
    margin, found, first = np.float32(NEGLIGIBLE), [], 0
    while first < len(order):
        narrow = int(width[order[first]])
        last = min(first + max(1, BLOCK_PAIRS // narrow), int(np.searchsorted(width, WIDER * narrow, "right", order)))
        seconds, first = order[first:last], last
        wide = int(width[seconds[-1]])
        x, y, u, v, _, back_free = values[:, seconds, None]
        x_before, y_before, u_before, v_before, forth_free, _ = _windows(around, wide, ends[seconds])
        wx, wy = x - x_before, y - y_before
        sine = u_before * v - v_before * u
        forth, back = wx * v - wy * u, u_before * wy - v_before * wx
        np.copysign(np.float32(1.0), sine, out=wx)
        forth *= wx
        back *= wx
        np.abs(sine, out=sine)
        np.multiply(sine, np.float32(-SLACK), out=wx)
        wx -= margin
        meet = forth >= wx
        meet &= back >= wx
        forth -= margin
        back -= margin
        meet &= forth <= np.multiply(forth_free, sine, out=wx)
        meet &= back <= np.multiply(back_free, sine, out=wx)
        if narrow < wide:
            meet &= np.arange(wide) >= wide - width[seconds, None]
        row, k = np.divmod(np.flatnonzero(meet), wide)
        found.append((seconds[row], wide - k))
    j, back_by = (np.concatenate(each) for each in zip(*found, strict=True))
    begin = np.repeat(begins, counts)[j]
    i = begin + np.mod(j - back_by - begin, np.repeat(counts, counts)[j])
    if (np.diff(order) != 1).any():
        by_target = np.argsort(j, kind="stable")
        i, j = i[by_target], j[by_target]
    return i, j


def _windows(values: SingleArray, width: int, ends: IntArray) -> SingleArray:
    """(6, R, width) the values (6, N) before some ends (R,)."""
    every = sliding_window_view(values, width, axis=1)
    one, other = int(ends[0]) - width, int(ends[-1]) - width + 1
    return every[:, one:other] if other - one == len(ends) else every[:, ends - width]
