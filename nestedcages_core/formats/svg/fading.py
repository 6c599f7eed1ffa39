"""Where gradients that fade away are visible."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.arrays import FloatArray
from ..solids import shapely
from .paints import Gradient, Stop
from .transforms import moved

GRADIENT_SEGMENTS = 32
"""Chords of a quarter circle."""


def visible(
    gradient: Gradient,
    alphas: FloatArray,
    faintest: float,
    matrix: FloatArray,
    bounds: tuple[float, ...],
    *,
    inside: bool,
) -> Any:
    """The region within `bounds`, (x, y, x, y) of the document, where a gradient is more opaque than `faintest`.

    alphas: (S,) of the stops; matrix: from the units of the gradient, before its own matrix, to the document.
    """
    everywhere = shapely.box(*bounds)
    to_document = matrix @ gradient.matrix
    if gradient.spread in ("repeat", "reflect") or not abs(np.linalg.det(to_document[:2, :2])) > 0.0:
        return everywhere
    corners = shapely.get_coordinates(everywhere)
    here = moved(corners, np.asarray(np.linalg.inv(to_document), np.float64))
    parts = []
    for start, end in intervals_above(gradient.stops, alphas, faintest):
        if gradient.radial:
            part = _disc_between(gradient.numbers, start, end, here, inside=inside)
        else:
            part = _strip(gradient.numbers, start, end, here)
        parts.append(shapely.transform(part, lambda points: moved(points, to_document)))
    return shapely.intersection(shapely.union_all(parts), everywhere)


def _strip(numbers: tuple[float, ...], start: float, end: float, here: FloatArray) -> Any:
    """The region between two parameters of a linear gradient. here: (k, 2) points around the relevant area."""
    origin, along = np.array(numbers[:2]), np.array(numbers[2:]) - numbers[:2]
    length = float(along @ along)
    if not length > 0.0:  # painted in the last colour
        return shapely.MultiPoint(here).convex_hull if end == np.inf else shapely.Polygon()
    across = np.array([-along[1], along[0]])
    t, s = (here - origin) @ along / length, (here - origin) @ across / length
    t0, t1 = max(start, t.min() - 1.0), min(end, t.max() + 1.0)
    if t0 >= t1:
        return shapely.Polygon()
    ends = [(t0, s.min() - 1.0), (t1, s.min() - 1.0), (t1, s.max() + 1.0), (t0, s.max() + 1.0)]
    return shapely.Polygon([origin + t * along + s * across for t, s in ends])


def _disc_between(numbers: tuple[float, ...], start: float, end: float, here: FloatArray, *, inside: bool) -> Any:
    """The region between two parameters of a radial gradient, with chords outside of it, or inside."""
    cx, cy, radius, fx, fy = numbers

    def disc(t: float, *, around: bool) -> Any:
        if not np.isfinite(t):
            return shapely.MultiPoint(here).convex_hull
        middle = shapely.Point(fx + (cx - fx) * t, fy + (cy - fy) * t)
        wider = 1.0 / np.cos(np.pi / (4.0 * GRADIENT_SEGMENTS)) if around else 1.0
        return middle.buffer(max(wider * radius * t, 0.0), quad_segs=GRADIENT_SEGMENTS)

    outer = disc(end, around=not inside)
    return outer if start <= 0.0 else shapely.difference(outer, disc(start, around=inside))


def intervals_above(stops: tuple[Stop, ...], alphas: FloatArray, faintest: float) -> list[tuple[float, float]]:
    """Intervals of a gradient's parameter where it is more opaque than `faintest`; ends may be infinite.

    alphas: (S,) of the stops, linear between them.
    """
    offsets = np.array([stop.offset for stop in stops])
    t = np.concatenate(([-np.inf], offsets, [np.inf]))
    w = np.concatenate((alphas[:1], alphas, alphas[-1:])) - faintest
    found: list[tuple[float, float]] = []
    for a, b, u, v in zip(t[:-1], t[1:], w[:-1], w[1:], strict=True):
        if a == b or (u <= 0.0 and v <= 0.0):
            continue
        crossing = a + (b - a) * u / (u - v) if u != v else a
        low, high = (a if u > 0.0 else crossing), (b if v > 0.0 else crossing)
        if found and found[-1][1] >= low:
            found[-1] = (found[-1][0], high)
        else:
            found.append((low, high))
    return found
