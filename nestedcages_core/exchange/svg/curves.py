"""Bézier curves and elliptical arcs as chains of points."""

from __future__ import annotations

import math
import sys

import numpy as np

from ...geometry.arrays import FloatArray, IntArray

LINE, CUBIC = 1, 3
"""Degrees."""

MAX_ARC = math.pi / 6.0
"""Radians of one cubic; its distance from the true arc is then below 4e-7 of the radius."""

MAX_CHORDS = 4096
"""Maximum number of chords of a curve."""

FLATTEST = 1e-30
"""Radii by coordinates, and (chord / diameter) squared, below which an elliptical arc is a line."""


Point = tuple[float, float]


def arc(start: Point, end: Point, radii: Point, turn: float, large: bool, sweep: bool) -> FloatArray:
    """Control points (3 k, 2) of k cubics along an elliptical arc, after its start (SVG 1.1, appendix F.6).

    radii: along the ellipse's axes, widened if too small to reach; turn: radians from x to the first axis. A straight
    arc has its end only, one that ends where it starts no points.
    """
    (x0, y0), (x1, y1) = start, end
    rx, ry = abs(radii[0]), abs(radii[1])
    if x0 == x1 and y0 == y1:
        return np.zeros((0, 2))
    largest = max(abs(x0), abs(y0), abs(x1), abs(y1))
    if not (rx > FLATTEST * largest and ry > FLATTEST * largest and math.isfinite(turn)):
        return np.array([end])
    cosine, sine = math.cos(turn), math.sin(turn)
    dx, dy = (x0 - x1) / 2.0, (y0 - y1) / 2.0
    u, v = (cosine * dx + sine * dy) / rx, (cosine * dy - sine * dx) / ry  # half the chord, the ellipse a unit circle
    stretch = u * u + v * v
    if not FLATTEST < stretch < math.inf:  # so large that the arc is straight, or out of range
        return np.array([end])
    if stretch >= 1.0:  # too small, or just reaching: the centre is the middle
        grown = math.sqrt(stretch)
        rx, ry, u, v, across, along = rx * grown, ry * grown, u / grown, v / grown, 0.0, 0.0
    else:
        off = math.sqrt(1.0 / stretch - 1.0) * (1.0 if large != sweep else -1.0)
        across, along = off * v, -off * u
    begin = math.atan2(v - along, u - across)
    angle = (math.atan2(-v - along, -u - across) - begin) % (2.0 * math.pi)
    if not sweep:
        angle -= 2.0 * math.pi
    axes = np.array([[cosine * rx, -sine * ry], [sine * rx, cosine * ry]])
    points = ellipse(axes @ (across, along) + np.add(start, end) / 2.0, axes, begin, angle)[1:]
    points[-1] = end
    return points


TINY = sys.float_info.min
"""Smallest tolerance: scaled ones may underflow."""


def ellipse(centre: FloatArray, axes: FloatArray, begin: float = 0.0, angle: float = 2.0 * math.pi) -> FloatArray:
    """Control points (3 k + 1, 2) of cubics along centre + axes @ (cos t, sin t), t from `begin` over `angle` radians.

    axes: (2, 2).
    """
    count = max(math.ceil(abs(angle) / MAX_ARC - 1e-9), 1)
    reach = 4.0 / 3.0 * math.tan(angle / count / 4.0)
    t = [begin + angle * k / count for k in range(count + 1)]
    if abs(angle) == 2.0 * math.pi:
        t[-1] = t[0]
    on = np.array([(math.cos(at), math.sin(at)) for at in t])
    ahead = on[:, ::-1] * (-reach, reach)
    unit = np.empty((3 * count + 1, 2))
    unit[::3], unit[1::3], unit[2::3] = on, on[:-1] + ahead[:-1], on[1:] - ahead[1:]
    return np.asarray(unit @ axes.T + centre)


def flattened(points: FloatArray, degrees: IntArray, tolerance: float) -> FloatArray:
    """(k, 2) points on consecutive curves, no farther than `tolerance` from them along the chords between.

    points: control points, each curve's first one the last one before; degrees: 1 to 3. The number of chords is that
    of Wang (1984): sqrt(d (d - 1) / 8 · max |second difference| / tolerance) for degree d.
    """
    if (degrees == LINE).all():
        return points
    ends = np.cumsum(degrees)
    counts = np.ones(len(degrees), dtype=np.int64)
    kinds = []
    for degree in range(LINE + 1, CUBIC + 1):
        which = np.flatnonzero(degrees == degree)
        control = points[(ends[which] - degree)[:, None] + np.arange(degree + 1)]
        bend = np.hypot(*np.moveaxis(np.diff(control, 2, axis=1), 2, 0)).max(axis=1)
        wanted = np.sqrt(degree * (degree - 1) / 8.0 * bend / max(tolerance, TINY))
        counts[which] = np.ceil(np.clip(wanted, 1, MAX_CHORDS))
        kinds.append((which, control))
    last = np.cumsum(counts)
    found = np.empty((last[-1] + 1, 2))
    found[0], found[last] = points[0], points[ends]
    for which, control in kinds:
        inner = counts[which] - 1
        curve = np.repeat(np.arange(len(which)), inner)
        k = np.arange(1, len(curve) + 1) - np.repeat(np.cumsum(inner) - inner, inner)
        t, level = (k / counts[which][curve])[:, None, None], control[curve]
        while level.shape[1] > 1:  # de Casteljau, all t at once
            level = level[:, :-1] + t * np.diff(level, axis=1)
        found[(last - counts)[which][curve] + k] = level[:, 0]
    return found
