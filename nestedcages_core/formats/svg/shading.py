"""The colours of a gradient at points of a drawing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ...geometry.arrays import FloatArray
from .paints import Paint
from .transforms import moved

Shades: TypeAlias = Callable[[FloatArray], FloatArray]
"""sRGB and opacity (n, 4) at points (n, 2), from 0 to 1."""

INSIDE = 0.999
"""Largest distance of a focus from the middle of its circle, in radii: others move there (SVG 1.1, section 13.2.3)."""


@dataclass(frozen=True)
class Shading:
    """The gradient of a paint, and the matrix (3, 3) from user units of the drawing to those of the gradient."""

    paint: Paint
    matrix: FloatArray

    def __call__(self, points: FloatArray) -> FloatArray:
        """sRGB and opacity (n, 4) at points (n, 2) in user units, from 0 to 1."""
        gradient = self.paint.gradient
        assert gradient is not None
        places = moved(points, self.matrix)
        t = _outwards(gradient.numbers, places) if gradient.radial else _along(gradient.numbers, places)
        if gradient.spread == "repeat":
            t = t % 1.0
        elif gradient.spread == "reflect":
            t = 1.0 - np.abs(t % 2.0 - 1.0)
        offsets = [stop.offset for stop in gradient.stops]
        colours = np.array([stop.colour.rgb for stop in gradient.stops])
        return np.column_stack([np.interp(t, offsets, each) for each in (*colours.T, self.paint.alphas)])


def shaded(shades: Shades, low: FloatArray, high: FloatArray, size: tuple[int, int]) -> FloatArray:
    """sRGB and opacity (h, w, 4) at the middles of pixels between two corners (2,); size: height and width."""
    shares = (np.indices(size)[::-1].reshape(2, -1).T + 0.5) / size[::-1]
    return shades(low + shares * (high - low)).reshape(*size, 4)


def _along(numbers: tuple[float, ...], points: FloatArray) -> FloatArray:
    """The parameter (n,) of a linear gradient; past its end where it has no length."""
    origin, along = np.array(numbers[:2]), np.array(numbers[2:]) - numbers[:2]
    length = float(along @ along)
    return np.asarray((points - origin) @ along / length) if length > 0.0 else np.ones(len(points))


def _outwards(numbers: tuple[float, ...], points: FloatArray) -> FloatArray:
    """The parameter (n,) of a radial gradient: circles from its focus grow to its circle."""
    radius, way = numbers[2], np.array(numbers[:2]) - numbers[3:]
    if not radius > 0.0:
        return np.ones(len(points))
    far = float(np.hypot(*way))
    way *= INSIDE * radius / far if far > INSIDE * radius else 1.0
    from_focus = points - (numbers[:2] - way)
    along, bend = from_focus @ way, radius * radius - float(way @ way)
    root = np.sqrt(along * along + bend * (from_focus**2).sum(axis=1))
    return np.asarray((root - along) / bend)
