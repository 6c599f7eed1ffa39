"""Bézier curves and elliptical arcs as chains of points."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import numpy as np

from ...geometry.arrays import FloatArray

MAX_ARC = math.pi / 6.0
"""Radians of one cubic; its distance from the true arc is then below 4e-7 of the radius."""

MAX_CHORDS = 4096
"""Maximum number of chords of a curve."""

FLATTEST = 1e-30
"""Radii by coordinates, and (chord / diameter) squared, below which an elliptical arc is a line."""


def line(start: FloatArray, end: FloatArray) -> FloatArray:
    """(2, 2) control points."""
    return np.stack((start, end))


def arc(
    start: FloatArray, end: FloatArray, radii: Sequence[float], turn: float, large: bool, sweep: bool
) -> list[FloatArray]:
    """Cubics (4, 2) along an elliptical arc, from its end points (SVG 1.1, appendix F.6).

    radii: two, along the ellipse's axes, widened if too small to reach; turn: radians from x to the first axis.
    """
    (x0, y0), (x1, y1) = start.tolist(), end.tolist()
    rx, ry = abs(radii[0]), abs(radii[1])
    if x0 == x1 and y0 == y1:
        return []
    largest = max(abs(x0), abs(y0), abs(x1), abs(y1))
    if not (rx > FLATTEST * largest and ry > FLATTEST * largest and math.isfinite(turn)):
        return [line(start, end)]
    cosine, sine = math.cos(turn), math.sin(turn)
    dx, dy = (x0 - x1) / 2.0, (y0 - y1) / 2.0
    u, v = (cosine * dx + sine * dy) / rx, (cosine * dy - sine * dx) / ry  # half the chord, the ellipse a unit circle
    stretch = u * u + v * v
    if not FLATTEST < stretch < math.inf:  # so large that the arc is straight, or out of range
        return [line(start, end)]
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
    centre = axes @ (across, along) + (start + end) / 2.0
    curves = ellipse(centre, axes, begin, angle)
    curves[0][0], curves[-1][3] = start, end
    return curves


TINY = sys.float_info.min
"""Smallest tolerance: scaled ones may underflow."""


def ellipse(centre: FloatArray, axes: FloatArray, begin: float = 0.0, angle: float = 2.0 * math.pi) -> list[FloatArray]:
    """Cubics (4, 2) along centre + axes @ (cos t, sin t) for t from `begin` over `angle` radians; axes: (2, 2)."""
    count = max(math.ceil(abs(angle) / MAX_ARC - 1e-9), 1)
    reach = 4.0 / 3.0 * math.tan(angle / count / 4.0)
    t = [begin + angle * k / count for k in range(count + 1)]
    if abs(angle) == 2.0 * math.pi:
        t[-1] = t[0]
    on = np.array([(math.cos(at), math.sin(at)) for at in t])
    ahead = on[:, ::-1] * (-reach, reach)
    unit = np.empty((count, 4, 2))
    unit[:, 0], unit[:, 1], unit[:, 2], unit[:, 3] = on[:-1], on[:-1] + ahead[:-1], on[1:] - ahead[1:], on[1:]
    return list(unit @ axes.T + centre)


def flattened(curves: list[FloatArray], tolerance: float) -> FloatArray:
    """(k, 2) points on consecutive curves, no farther than `tolerance` from them along the chords between.

    curves: control points (2, 2), (3, 2) or (4, 2), each starting where the one before ends. The number of chords is
    that of Wang (1984): sqrt(d (d - 1) / 8 · max |second difference| / tolerance) for degree d.
    """
    parts = [curves[0][:1]]
    for control in curves:
        degree = len(control) - 1
        bend = float(np.hypot(*np.diff(control, 2, axis=0).T).max()) if degree > 1 else 0.0
        wanted = math.sqrt(degree * (degree - 1) / 8.0 * bend / max(tolerance, TINY))
        count = max(math.ceil(min(wanted, MAX_CHORDS)), 1)
        t = np.arange(1, count)[:, None] / count
        level = control
        for _ in range(degree if count > 1 else 0):  # de Casteljau, all t at once
            level = level[..., :-1, :] + t[..., None] * np.diff(level, axis=-2)
        parts += [level.reshape(-1, 2)[: count - 1] if count > 1 else np.zeros((0, 2)), control[-1:]]
    return np.concatenate(parts)
