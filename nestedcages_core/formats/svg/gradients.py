"""Gradients: their colours at points of a drawing, and where those that fade away are visible."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from ...geometry.arrays import FloatArray
from ..solids import shapely
from .colours import Colour
from .transforms import moved

Shades: TypeAlias = Callable[[FloatArray], FloatArray]
"""sRGB and opacity (n, 4) at points (n, 2), from 0 to 1."""

INSIDE = 0.999
"""Largest distance of a focus from the middle of its circle, in radii: others move there (SVG 1.1, section 13.2.3)."""

GRADIENT_SEGMENTS = 32
"""Chords of a quarter circle."""


@dataclass(frozen=True)
class Stop:
    offset: float
    colour: Colour


@dataclass(frozen=True)
class Gradient:
    """Colours along a line or outwards from a focus."""

    radial: bool
    numbers: tuple[float, ...]
    """x1, y1, x2, y2; or cx, cy, r, fx, fy."""
    of_box: bool
    """Whether lengths are fractions of the painted box."""
    matrix: FloatArray = field(compare=False)
    stops: tuple[Stop, ...]
    spread: str
    """What is painted beyond the first and last stop: pad, repeat or reflect."""

    def as_light(self) -> Gradient:
        """The same in a mask: as opaque as it is light."""
        stops = (replace(stop, colour=Colour(stop.colour.alpha * stop.colour.luminance)) for stop in self.stops)
        return replace(self, stops=tuple(stops))

    def alphas(self, opacity: float) -> FloatArray:
        """(S,) opacities of its stops in a paint of an opacity."""
        return opacity * np.array([stop.colour.alpha for stop in self.stops])

    def parameters(self, points: FloatArray) -> FloatArray:
        """The parameter (n,) at points (n, 2) in its units, before it is spread; 1 where it has no extent."""
        numbers = np.array(self.numbers)
        if not self.radial:
            along = numbers[2:] - numbers[:2]
            length = float(along @ along)
            return np.asarray((points - numbers[:2]) @ along / length) if length > 0.0 else np.ones(len(points))
        radius, way = numbers[2], numbers[:2] - numbers[3:]
        if not radius > 0.0:
            return np.ones(len(points))
        far = float(np.hypot(*way))
        way *= INSIDE * radius / far if far > INSIDE * radius else 1.0
        from_focus = points - (numbers[:2] - way)
        ahead, bend = from_focus @ way, radius * radius - float(way @ way)
        root = np.sqrt(ahead * ahead + bend * (from_focus**2).sum(axis=1))
        return np.asarray((root - ahead) / bend)


@dataclass(frozen=True)
class Shading:
    """A gradient with an opacity, and the matrix (3, 3) from user units of the drawing to its units."""

    gradient: Gradient
    opacity: float
    matrix: FloatArray

    def __call__(self, points: FloatArray) -> FloatArray:
        """sRGB and opacity (n, 4) at points (n, 2) in user units, from 0 to 1."""
        t, stops = self.gradient.parameters(moved(points, self.matrix)), self.gradient.stops
        if self.gradient.spread == "repeat":
            t = t % 1.0
        elif self.gradient.spread == "reflect":
            t = 1.0 - np.abs(t % 2.0 - 1.0)
        channels = *np.array([stop.colour.rgb for stop in stops]).T, self.gradient.alphas(self.opacity)
        return np.column_stack([np.interp(t, [stop.offset for stop in stops], each) for each in channels])


def shaded(shades: Shades, low: FloatArray, high: FloatArray, size: tuple[int, int]) -> FloatArray:
    """sRGB and opacity (h, w, 4) at the middles of pixels between two corners (2,); size: height and width."""
    shares = (np.indices(size)[::-1].reshape(2, -1).T + 0.5) / size[::-1]
    return shades(low + shares * (high - low)).reshape(*size, 4)


def visible(
    gradient: Gradient,
    opacity: float,
    faintest: float,
    matrix: FloatArray,
    bounds: tuple[float, ...],
    *,
    inside: bool,
) -> Any:
    """The region within `bounds`, (x, y, x, y) of the document, where a gradient is more opaque than `faintest`.

    matrix: from the units of the gradient, before its own matrix, to the document; inside: whether chords of circles
    lie inside of it.
    """
    everywhere = shapely.box(*bounds)
    to_document = matrix @ gradient.matrix
    if gradient.spread in ("repeat", "reflect") or not abs(np.linalg.det(to_document[:2, :2])) > 0.0:
        return everywhere
    here = moved(shapely.get_coordinates(everywhere), np.asarray(np.linalg.inv(to_document), np.float64))
    parts = []
    for start, end in _intervals_above(gradient, opacity, faintest):
        part = shapely.difference(
            _up_to(gradient, end, here, around=not inside), _up_to(gradient, start, here, around=inside)
        )
        parts.append(shapely.transform(part, lambda points: moved(points, to_document)))
    return shapely.intersection(shapely.union_all(parts), everywhere)


def _up_to(gradient: Gradient, t: float, here: FloatArray, *, around: bool) -> Any:
    """The region near the points `here` (k, 2) up to a parameter; around: with chords of its circle outside of it."""
    everywhere = shapely.MultiPoint(here).convex_hull
    if not np.isfinite(t):
        return everywhere if t > 0.0 else shapely.Polygon()
    if gradient.radial:
        cx, cy, radius, fx, fy = gradient.numbers
        middle = shapely.Point(fx + (cx - fx) * t, fy + (cy - fy) * t)
        wider = 1.0 / np.cos(np.pi / (4.0 * GRADIENT_SEGMENTS)) if around else 1.0
        return middle.buffer(max(wider * radius * t, 0.0), quad_segs=GRADIENT_SEGMENTS)
    origin, along = np.array(gradient.numbers[:2]), np.array(gradient.numbers[2:]) - gradient.numbers[:2]
    length = float(along @ along)
    if not length > 0.0:  # painted in the last colour
        return shapely.Polygon()
    across = np.array([-along[1], along[0]])
    ahead, aside = (here - origin) @ along / length, (here - origin) @ across / length
    first, sides = min(float(ahead.min()), t) - 1.0, (aside.min() - 1.0, aside.max() + 1.0)
    ends = [(first, sides[0]), (t, sides[0]), (t, sides[1]), (first, sides[1])]
    return shapely.Polygon([origin + k * along + s * across for k, s in ends])


def _intervals_above(gradient: Gradient, opacity: float, faintest: float) -> list[tuple[float, float]]:
    """Intervals of a gradient's parameter where it is more opaque than `faintest`; ends may be infinite."""
    alphas = gradient.alphas(opacity)
    offsets = [-np.inf, *(stop.offset for stop in gradient.stops), np.inf]
    excesses = np.concatenate((alphas[:1], alphas, alphas[-1:])) - faintest
    found: list[tuple[float, float]] = []
    for (a, u), (b, v) in pairwise(zip(offsets, excesses.tolist(), strict=True)):
        if a == b or (u <= 0.0 and v <= 0.0):
            continue
        crossing = a + (b - a) * u / (u - v) if u != v else a
        low, high = (a if u > 0.0 else crossing), (b if v > 0.0 else crossing)
        if found and found[-1][1] >= low:
            low = found.pop()[0]
        found.append((low, high))
    return found
