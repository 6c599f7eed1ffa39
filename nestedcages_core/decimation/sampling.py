"""Samples: the vertices of a loop at which stretches for candidate lines begin.

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
from .outline import Outline

ALL_VERTICES = 1.25
"""Vertices per wanted place up to which each vertex is a place."""

SHARP = 0.4
"""Turn in radians times length of the longer edge in spacings of places from which each corner is a place."""

DECIMALS = round(-np.log10(ROUND_OFF))
"""Of angles, cells and sharpness when they are compared: ties must not be decided by round-off, which turns with the
drawing."""

FLAT_WEIGHT = 0.1
"""Weight of a straight edge, relative to the mean weight of all per length."""


def weights(outlines: list[Outline], count: int) -> list[FloatArray]:
    """(S,) for each outline how many of the places its edges deserve; the scale is that of a cage of count vertices."""
    total = sum(outline.length for outline in outlines)
    densities = [_density(outline, 0.5 * total / count) for outline in outlines]
    mean = sum(float((d * outline.lengths).sum()) for d, outline in zip(densities, outlines, strict=True)) / total
    if mean == 0.0:  # straight at this scale
        return [outline.lengths for outline in outlines]
    return [(d + FLAT_WEIGHT * mean) * outline.lengths for d, outline in zip(densities, outlines, strict=True)]


def _density(outline: Outline, scale: float) -> FloatArray:
    """(S,) the cube root of the area of the triangle from a scale before each edge's middle to a scale behind it."""
    along = np.concatenate(([0.0], np.cumsum(np.tile(outline.lengths, 3))))
    ring = np.concatenate((np.tile(outline.vertices, (3, 1)), outline.vertices[:1]))
    middle = along[outline.size : 2 * outline.size] + 0.5 * outline.lengths

    def at(shift: float) -> FloatArray:
        return np.stack([np.interp(middle + shift, along, axis) for axis in ring.T], axis=1)

    before = at(-scale)
    area = np.abs(cross(at(scale) - before, at(0.0) - before))
    root: FloatArray = np.cbrt(area if outline.weights is None else outline.edge_weights * area)
    return root


def samples(outline: Outline, weight: FloatArray, count: int) -> IntArray:
    """(N,) vertices, ascending: the sharpest of each cell of equal weight, and the sharp corners of the outline."""
    if outline.size <= ALL_VERTICES * count:
        return np.arange(outline.size)
    sums = np.cumsum(weight)
    cell = np.minimum(np.round((sums - weight) / sums[-1] * count, DECIMALS).astype(np.int64), count - 1)
    turn = np.round(np.abs(outline.turned(np.arange(outline.size), outline.edges)), DECIMALS)
    order = np.lexsort((turn, cell))
    chosen = order[np.flatnonzero(np.diff(cell[order], append=count))]
    sharpness = np.round(
        turn * np.maximum(outline.lengths, np.roll(outline.lengths, 1)) * count / outline.length, DECIMALS
    )
    corners = np.flatnonzero(sharpness > SHARP)
    chosen = np.union1d(chosen, corners if len(corners) <= count else np.argsort(-sharpness, kind="stable")[:count])
    sharpness[chosen] = -1.0
    return np.union1d(chosen, np.argsort(-sharpness, kind="stable")[: max(0, count - len(chosen))])


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
