"""Turns: the pairs of lines that can follow each other in a cage, and the area each adds between cage and outline."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from ..geometry.arrays import FloatArray, IntArray
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

LIMIT_COST = 1.0
"""Cost of edges for what each half lacks of the least length, and of angles, by the cosine."""

FAR_PART = 0.5
"""Part of the usual width, in lines, from which a line over a pocket may follow any line."""


BLOCK_PAIRS = 2**15
"""Pairs tested together: their arrays stay in the processor's cache (measured)."""


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


def turns(outline: Outline, lines: Lines, free: FloatArray, width: int) -> Turns:
    """The turns onto lines (K,) with free parts (2, K) from one of the `width` lines before."""
    count = len(lines)
    i, j = _meeting(lines, free, np.arange(count), width)
    # lines over pockets that are longer than that may follow any line
    first = np.searchsorted(lines.place, np.mod(lines.place - lines.skipped, outline.size))
    far = np.flatnonzero((lines.skipped > 0.0) & (np.mod(np.arange(count) - first, count) > FAR_PART * width))
    if len(far) and width < count - 1:
        others = np.isin(j, far, invert=True)
        more = _meeting(lines, free, far, count - 1)
        i, j = np.concatenate((i[others], more[0])), np.concatenate((j[others], more[1]))
        order = np.argsort(j, kind="stable")
        i, j = i[order], j[order]
    origin = outline.vertices[0]
    (x, y), (u, v) = (lines.point - origin).T.copy(), lines.direction.T.copy()
    ui, vi, uj, vj, xi, yi, xj, yj = u[i], v[i], u[j], v[j], x[i], y[i], x[j], y[j]
    wx, wy = xj - xi, yj - yi
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        sine = ui * vj - vi * uj
        forth, back = (wx * vj - wy * uj) / sine, (ui * wy - vi * wx) / sine
        sound = (np.abs(sine) > ROUND_OFF) & (forth >= -SLACK) & (back >= -SLACK)
        sound &= (forth <= free[0][i]) & (back <= free[1][j])
        # the areas from a line's contact back to where it belongs on the outline, and along the outline to its start
        edge = np.floor(lines.place).astype(np.int64)
        start = outline.vertices[edge] - origin
        foot = start + (lines.place - edge)[:, None] * outline.edges[edge]
        rest = cross(lines.point - origin, foot) - outline.swept[edge] - cross(start, foot)
        area = -wx * (yi + forth * vi) + wy * (xi + forth * ui)
        area += rest[j] - rest[i] - np.where(j < i, outline.swept[-1], 0.0)
        sound &= area > -ROUND_OFF
    kept = np.flatnonzero(sound)
    i, j, forth, back, area = i.take(kept), j.take(kept), forth.take(kept), back.take(kept), 0.5 * area.take(kept)
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


def _pin_costs(outline: Outline, lines: Lines, i: IntArray, j: IntArray, forth: FloatArray) -> FloatArray:
    """(P,) the cost of turns that pass pins, by the distance of their vertices from these."""
    vertex = lines.point[i] + forth[:, None] * lines.direction[i]
    cost = np.zeros(len(i))
    for pin in outline.pins.tolist():
        passed = np.mod(pin - lines.place[i], outline.size) < np.mod(lines.place[j] - lines.place[i], outline.size)
        away = norm(vertex[passed] - outline.vertices[pin])
        cost[passed] += PIN_COST * np.clip(away - PIN_REACH, 0.0, PIN_LOST)
    return cost


def _meeting(lines: Lines, free: FloatArray, seconds: IntArray, width: int) -> tuple[IntArray, IntArray]:
    """Pairs of lines that meet where both are free, or nearly so: a first test in single precision.

    seconds: (R,) the second lines to look at, each with the `width` lines before it.
    """
    count = len(lines)
    values = np.stack((*lines.point.T, *lines.direction.T, *free)).astype(np.float32)
    around = sliding_window_view(np.concatenate((values[:, count - width :], values[:, :-1]), axis=1), width, axis=1)
    onto, before = values[:, seconds, None], around if len(seconds) == count else around[:, seconds]
    margin, found = np.float32(NEGLIGIBLE), [np.zeros(0, np.int64)]
    rows = max(1, BLOCK_PAIRS // width)
    for first in range(0, len(seconds), rows):
        x, y, u, v, _, back_free = onto[:, first : first + rows]
        x_before, y_before, u_before, v_before, forth_free, _ = before[:, first : first + rows]
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
        found.append(np.flatnonzero(meet) + first * width)
    row, k = np.divmod(np.concatenate(found), width)
    second = seconds[row]
    return (second + k - width) % count, second
