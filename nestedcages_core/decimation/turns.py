"""Turns: the pairs of lines that can follow each other in a cage, and the area each adds between cage and outline."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import position_in_group
from ..geometry.precision import ROUND_OFF
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


MARGIN = np.float32(4e-6)
"""Height in single precision up to which a line may meet another one."""

BLOCK_PAIRS, BLOCK_LINES = 2**15, 128
"""Most pairs, and second lines of them, that are tested together: their arrays stay in the processor's cache."""

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

    The free part of each meets the other line if the height of its middle over that is at most what it rises from there
    to its ends. Heights and sines of many pairs are products of matrices.

    begins, counts: (L,) the lines of each loop. width: (K,) how many lines before each it may follow.
    """
    (x, y), (u, v) = lines.point.T, lines.direction.T
    (forth, back), halves = 0.5 * (free - SLACK), (0.5 * (free + SLACK)).astype(np.float32)
    level, one = v * x - u * y, np.ones(len(width))
    # each loop stands there twice, so that the lines that one of the second turn may follow are before it
    again = np.repeat(begins, 2 * counts) + np.mod(position_in_group(2 * counts), np.repeat(counts, 2 * counts))
    ends = np.arange(len(width)) + np.repeat(begins + counts, counts)
    middle = _singles(y + forth * v, x + forth * u, one).take(again, axis=1)
    around, rises = _singles(u, v, level).take(again, axis=1), halves[0].take(again)
    over, under = _singles(u, -v, level).T.copy(), _singles(y - back * v, back * u - x, one).T.copy()
    across = _singles(v, -u).T.copy()
    wide = width == np.maximum.reduceat(width, begins).repeat(counts)
    i, j = [], []
    for rows in (np.flatnonzero(wide), np.flatnonzero(~wide)):
        first = 0
        while first < len(rows):
            second = rows[first : first + max(1, min(BLOCK_LINES, BLOCK_PAIRS // int(width[rows[first]])))]
            first += len(second)
            begin, end = int((ends[second] - width[second]).min()), int(ends[second[-1]])
            sine = np.abs(across[second] @ around[:2, begin:end])
            height = np.abs(over[second] @ middle[:, begin:end])
            height -= rises[begin:end] * sine
            meet = height <= MARGIN
            np.abs(np.matmul(under[second], around[:, begin:end], out=height), out=height)
            sine *= halves[1, second, None]
            height -= sine
            meet &= height <= MARGIN
            row, column = np.divmod(np.flatnonzero(meet), end - begin)
            row, column = second[row], begin + column
            kept = np.flatnonzero((column < ends[row]) & (column >= ends[row] - width[row]))
            i.append(again[column[kept]])
            j.append(row[kept])
    before, onto = np.concatenate(i), np.concatenate(j)
    if wide.all():
        return before, onto
    order = np.argsort(onto, kind="stable")
    return before[order], onto[order]


def _singles(*values: FloatArray) -> SingleArray:
    return np.stack(values).astype(np.float32)
