"""Samples: the vertices of loops at which stretches for candidate lines begin.

A smooth arc needs edges in proportion to the integral of the cube root of its curvature along its length: a triangle
over a short piece has an area in proportion to curvature times length cubed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.loops import Loops
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import cross, norm
from .outline import Outline, largest

ALL_VERTICES = 1.25
"""Vertices per wanted place up to which each vertex is a place."""

SHARP = 0.4
"""Turn in radians times length of the longer edge in spacings of places from which each corner is a place."""

DECIMALS = round(-np.log10(ROUND_OFF))
"""Of angles, cells and sharpness when they are compared: ties must not be decided by round-off, which turns with the
drawing."""

FLAT_WEIGHT = 0.1
"""Weight of a straight edge, relative to the mean weight of all per length."""

MAX_SCALE = 1.0 / 3.0
"""Part of a loop up to which its curvature is measured."""


def weights(outline: Outline, count: int) -> FloatArray:
    """(S,) how many of the places each edge deserves; the scale is that of a cage of count vertices."""
    density = _density(outline, 0.5 * outline.length / count)
    mean = float((density * outline.lengths).sum()) / outline.length
    if mean == 0.0:  # straight at this scale
        return outline.lengths
    return np.asarray((density + FLAT_WEIGHT * mean) * outline.lengths)


def _density(outline: Outline, scale: float) -> FloatArray:
    """(S,) the cube root of the area of the triangle from a scale before each edge's middle to a scale behind it."""
    loop, end = outline.loop, np.cumsum(outline.lengths)
    begin = end - outline.lengths
    first, perimeter = begin[outline.begins][loop], outline.perimeters[loop]
    middle, scales = 0.5 * (begin + end) - first, np.minimum(scale, MAX_SCALE * perimeter)
    low, high = outline.begins[loop], (outline.begins + outline.sizes - 1)[loop]

    def at(shift: FloatArray) -> FloatArray:
        along = first + np.mod(middle + shift, perimeter)
        edge = np.clip(np.searchsorted(begin, along, "right") - 1, low, high)
        part = (along - begin[edge]) / outline.lengths[edge]
        return np.asarray(outline.vertices[edge] + part[:, None] * outline.edges[edge])

    before, here = at(-scales), outline.vertices + 0.5 * outline.edges
    area = np.abs(cross(at(scales) - before, here - before))
    root: FloatArray = np.cbrt(area if outline.weights is None else outline.edge_weights * area)
    return root


def samples(outline: Outline, weight: FloatArray, count: IntArray) -> IntArray:
    """(N,) vertices, ascending: of each loop the sharpest of each cell of equal weight, and the sharp corners.

    weight: (S,) of edges. count: (L,) wanted number for each loop.
    """
    loop, wanted = outline.loop, count[outline.loop]
    first = np.cumsum(count) - count
    sums = np.cumsum(weight)
    before = sums - weight
    before -= before[outline.begins][loop]
    part = before / np.add.reduceat(weight, outline.begins)[loop]
    cell = first[loop] + np.minimum(np.round(part * wanted, DECIMALS).astype(np.int64), wanted - 1)
    turn = np.round(np.abs(outline.turned(np.arange(outline.size), outline.edges)), DECIMALS)
    longer = np.maximum(outline.lengths, outline.lengths[outline.loops.back])
    sharpness = np.round(turn * longer * wanted / outline.perimeters[loop], DECIMALS)
    chosen = (outline.sizes <= ALL_VERTICES * count)[loop]
    order = np.lexsort((turn, cell))
    chosen[order[np.flatnonzero(np.diff(cell[order], append=count.sum()))]] = True
    chosen |= (sharpness > SHARP) & largest(sharpness, loop, count)
    sharpness[chosen] = -1.0
    missing = np.maximum(count - np.bincount(loop[chosen], minlength=len(count)), 0)
    return np.flatnonzero(chosen | largest(sharpness, loop, missing))


@dataclass(frozen=True)
class NormalFrame:
    """Units of an outline: diameter 1, centre at the origin, its first vertex on the x axis."""

    centre: FloatArray
    scale: float
    axis: FloatArray
    """(2,) unit vector to the first vertex."""

    @classmethod
    def of(cls, outline: Loops) -> NormalFrame:
        """The frame of an outline in canonical order: it starts with a vertex far from the centre."""
        first = outline.vertices[0] - outline.centre
        return cls(outline.centre, outline.diameter, first / norm(first))

    def into(self, points: FloatArray) -> FloatArray:
        """Points (K, 2) of the input in this frame."""
        x, y = (points - self.centre).T / self.scale
        c, s = self.axis
        return np.stack((c * x + s * y, c * y - s * x), axis=1)

    def out_of(self, points: FloatArray) -> FloatArray:
        """Points (K, 2) of this frame in the input's units."""
        x, y = points.T
        c, s = self.axis
        moved: FloatArray = self.centre + self.scale * np.stack((c * x - s * y, s * x + c * y), axis=1)
        return moved
