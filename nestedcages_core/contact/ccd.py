"""Continuous collision detection: when does a moving point first meet a moving edge?

Point and edge move linearly, x(s) = x + s v for s in [0, 1]. The point is on the edge's line where

    c(s) = (b(s) - a(s)) × (p(s) - a(s)) = c0 + c1 s + c2 s²

vanishes, so candidate times are the roots of a quadratic and no iteration is needed (a cubic in 3D; Li et al. 2020,
section 5). Where all three coefficients vanish, point and edge stay on one line, and the candidates are the times at
which the point is closest to either end of the edge. A candidate is an impact if the point is then on the edge, up to a
fraction of the starting distance. A tolerance on the edge's parameter instead would report impacts at time 0 for points
that rest next to an end of the edge.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.vectors import cross
from .pairs import Pairs

HIT_DISTANCE = 0.05
"""Distance to the edge below which a candidate time is an impact, as a fraction of the starting distance."""

SAFETY = 0.9
"""Fraction of the time of impact that a step may take; leaves a tenth of the gap to the next step."""

REACH_MARGIN = 0.99
"""Pairs whose motions add up to less than this fraction of their distance cannot meet; the rest covers rounding."""

DISCRIMINANT_ROUNDING = 1e-10
"""Size of a negative discriminant, relative to c1², up to which it counts as zero: the point grazes the line."""

COLLINEAR_ROUNDING = 2.0**-50
"""Rounding of positions, relative to the largest coordinate: coefficients below their share of it count as zero."""


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
    resolution = COLLINEAR_ROUNDING * max(float(np.abs(x).max()), float(speed.max()))
    time = _first_impact(edge, edge_v, to, to_v, HIT_DISTANCE * np.minimum(distance[candidate], clearance), resolution)
    hit = np.isfinite(time)
    return candidate[hit], time[hit]


def largest_safe_step(
    pairs: Pairs, x: FloatArray, v: FloatArray, distance: FloatArray, clearance: float = np.inf
) -> float:
    """Fraction of the motion v, at most 1, that is free of impacts with a safety margin; see :func:`impacts`."""
    _, time = impacts(pairs, x, v, distance, clearance)
    return min(1.0, SAFETY * float(time.min())) if len(time) else 1.0


def _first_impact(
    edge: FloatArray, edge_v: FloatArray, to: FloatArray, to_v: FloatArray, near: FloatArray, resolution: float
) -> FloatArray:
    """(K,) first time in (0, 1] at which the point is on the edge, infinite where it never is.

    edge, to: (K, 2) from the start of the edge to its end and to the point; edge_v, to_v: their displacements; near:
    (K,) distance that counts as on the edge; resolution: length of the rounding of positions.
    """
    c0 = cross(edge, to)
    c1 = cross(edge, to_v) + cross(edge_v, to)
    c2 = cross(edge_v, to_v)
    discriminant = c1 * c1 - 4.0 * c0 * c2
    real = discriminant >= -DISCRIMINANT_ROUNDING * c1 * c1
    # the numerically stable pair of roots: q / c2 and c0 / q
    q = -0.5 * (c1 + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), c1))
    first = np.full(len(c0), np.inf)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        candidates = [(real, q / c2), (real, c0 / q)]
    lengths = np.abs(edge).sum(axis=1), np.abs(to).sum(axis=1), np.abs(edge_v).sum(axis=1), np.abs(to_v).sum(axis=1)
    collinear = (
        (np.abs(c0) <= resolution * (lengths[0] + lengths[1]))
        & (np.abs(c1) <= resolution * sum(lengths))
        & (np.abs(c2) <= resolution * (lengths[2] + lengths[3]))
    )
    if collinear.any():
        # on one line, only a point beyond the ends of the edge is apart from it
        beyond = collinear & (((edge * to).sum(axis=1) <= 0.0) | ((edge * (to - edge)).sum(axis=1) >= 0.0))
        candidates += [(beyond, _closest_time(to, to_v)), (beyond, _closest_time(to - edge, to_v - edge_v))]
    for possible, time in candidates:
        valid = np.flatnonzero(possible & (time > 0.0) & (time <= 1.0))
        if len(valid) == 0:
            continue
        s = time[valid][:, None]
        e = edge[valid] + s * edge_v[valid]
        t = to[valid] + s * to_v[valid]
        squared = np.maximum((e * e).sum(axis=1), TINY)
        t = t - np.clip((e * t).sum(axis=1) / squared, 0.0, 1.0)[:, None] * e
        touches = (t * t).sum(axis=1) < near[valid] ** 2
        hit = valid[touches]
        first[hit] = np.minimum(first[hit], time[hit])
    return first


def _closest_time(offset: FloatArray, velocity: FloatArray) -> FloatArray:
    """(K,) time at which offset + s velocity is shortest; 0 without motion."""
    squared = (velocity * velocity).sum(axis=1)
    time: FloatArray = -(offset * velocity).sum(axis=1) / np.maximum(squared, TINY)
    return time
