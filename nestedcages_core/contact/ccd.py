"""Continuous collision detection: when does a moving point first meet a moving edge?

Point and edge move linearly, x(s) = x + s v for s in [0, 1]. The point is on the edge's line where

    c(s) = (b(s) - a(s)) × (p(s) - a(s)) = c0 + c1 s + c2 s²

vanishes: the roots of a quadratic, so no iteration is needed (in 3D this is a cubic; see Li et al. 2020, section 5). A
root counts as an impact when the point is then on, or very close to, the edge itself. "Very close" is measured against
the distance at the start: a tolerance on the edge's parameter instead would report impacts at time 0 for points that
rest beside an end of the edge.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.vectors import cross
from .pairs import Pairs

TOUCH = 0.05
"""A point closer to the edge than this fraction of the starting distance, when it crosses the edge's line, has hit
it."""

SAFETY = 0.9
"""Fraction of the time of impact that a step may take."""

REACH_MARGIN = 0.99
"""Pairs whose motions together are shorter than this fraction of their distance cannot meet."""

NEGATIVE_DISCRIMINANT = 1e-10
"""Relative size of a negative discriminant that rounding explains: the line is touched, not missed."""


def impacts(
    pairs: Pairs, x: FloatArray, v: FloatArray, distance: FloatArray, clearance: float = np.inf
) -> tuple[IntArray, FloatArray]:
    """Pairs that meet during the motion x + s v, 0 ≤ s ≤ 1, and when.

    x, v: (m + n, 2) positions and displacements; distance: (K,) distances of the pairs at x; clearance: distance at
    which a point may pass the end of an edge. Returns the (H,) indices of the pairs that meet and the (H,) times s of
    their first impact.
    """
    speed = np.sqrt(v[:, 0] * v[:, 0] + v[:, 1] * v[:, 1])
    candidate = np.flatnonzero(pairs.approach(speed) >= REACH_MARGIN * distance)
    if len(candidate) == 0:
        return candidate, np.zeros(0)
    p, a, b = pairs.point[candidate], pairs.start[candidate], pairs.end[candidate]
    edge, edge_v = x[b] - x[a], v[b] - v[a]
    to, to_v = x[p] - x[a], v[p] - v[a]
    time = _first_impact(edge, edge_v, to, to_v, TOUCH * np.minimum(distance[candidate], clearance))
    hit = np.isfinite(time)
    return candidate[hit], time[hit]


def largest_safe_step(
    pairs: Pairs, x: FloatArray, v: FloatArray, distance: FloatArray, clearance: float = np.inf
) -> float:
    """Fraction of the motion v, at most 1, that is free of impacts with a safety margin; see :func:`impacts`."""
    _, time = impacts(pairs, x, v, distance, clearance)
    return min(1.0, SAFETY * float(time.min())) if len(time) else 1.0


def _first_impact(
    edge: FloatArray, edge_v: FloatArray, to: FloatArray, to_v: FloatArray, touch: FloatArray
) -> FloatArray:
    """(K,) first time in (0, 1] at which the point touches the edge, infinite where it does not; see the module's
    docstring."""
    c0 = cross(edge, to)
    c1 = cross(edge, to_v) + cross(edge_v, to)
    c2 = cross(edge_v, to_v)
    discriminant = c1 * c1 - 4.0 * c0 * c2
    real = discriminant >= -NEGATIVE_DISCRIMINANT * c1 * c1
    # the numerically stable pair of roots: q / c2 and c0 / q
    q = -0.5 * (c1 + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), c1))
    first = np.full(len(c0), np.inf)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        roots = (q / c2, c0 / q)
    for root in roots:
        valid = np.flatnonzero(real & (root > 0.0) & (root <= 1.0))
        if len(valid) == 0:
            continue
        s = root[valid][:, None]
        e = edge[valid] + s * edge_v[valid]
        t = to[valid] + s * to_v[valid]
        squared = np.maximum((e * e).sum(axis=1), np.finfo(float).tiny)
        t = t - np.clip((e * t).sum(axis=1) / squared, 0.0, 1.0)[:, None] * e
        touches = (t * t).sum(axis=1) < touch[valid] ** 2
        hit = valid[touches]
        first[hit] = np.minimum(first[hit], root[hit])
    return first
