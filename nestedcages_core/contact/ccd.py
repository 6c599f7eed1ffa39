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

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import column_cross, column_dot
from .pairs import Pairs

HIT_DISTANCE = 0.05
"""Distance to the edge below which a candidate time is an impact, as a fraction of the starting distance."""

SAFETY = 0.9
"""Fraction of the time of impact that a step may take; leaves a tenth of the gap to the next step."""

MAX_LENGTHS = 8.0
"""Upper bound on the lengths |x| + |y| of two differences of positions, relative to the largest coordinate."""

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
    positions, velocities = np.ascontiguousarray(x.T), np.ascontiguousarray(v.T)
    speed = np.sqrt(column_dot(velocities, velocities))
    candidate = np.flatnonzero(pairs.approach(speed) >= (1.0 - NEGLIGIBLE) * distance)
    if len(candidate) == 0:
        return candidate, np.zeros(0)
    size = max(float(np.abs(positions).max()), float(speed.max()))
    point, start, end = pairs.point.take(candidate), pairs.start.take(candidate), pairs.end.take(candidate)
    a, a_v = positions.take(start, axis=1), velocities.take(start, axis=1)
    edge, edge_v = positions.take(end, axis=1) - a, velocities.take(end, axis=1) - a_v
    to, to_v = positions.take(point, axis=1) - a, velocities.take(point, axis=1) - a_v
    motion = _RelativeMotion.of(edge, edge_v, to, to_v)
    rounding = MAX_LENGTHS * COLLINEAR_ROUNDING * size * size
    left = motion.may_meet(rounding)
    candidate = candidate.take(left)
    if len(candidate) == 0:
        return candidate, np.zeros(0)
    motion = _RelativeMotion(*(field.take(left, axis=-1) for field in motion))
    near = HIT_DISTANCE * np.minimum(distance.take(candidate), clearance)
    time = _first_impact(motion, near, COLLINEAR_ROUNDING * size, rounding)
    hit = np.flatnonzero(np.isfinite(time))
    return candidate.take(hit), time.take(hit)


def largest_safe_step(
    pairs: Pairs, x: FloatArray, v: FloatArray, distance: FloatArray, clearance: float = np.inf
) -> float:
    """Fraction of the motion v, at most 1, that is free of impacts with a safety margin; see :func:`impacts`."""
    _, time = impacts(pairs, x, v, distance, clearance)
    return min(1.0, SAFETY * float(time.min())) if len(time) else 1.0


class _RelativeMotion(NamedTuple):
    """Linear motion of K points relative to the starts of their edges, and the coefficients c (module)."""

    edge: FloatArray
    """(2, K) from the start of the edge to its end."""
    edge_v: FloatArray
    """(2, K) its displacement."""
    to: FloatArray
    """(2, K) from the start of the edge to the point."""
    to_v: FloatArray
    """(2, K) its displacement."""
    c0: FloatArray
    """(K,)."""
    c1: FloatArray
    """(K,)."""
    c2: FloatArray
    """(K,)."""

    @classmethod
    def of(cls, edge: FloatArray, edge_v: FloatArray, to: FloatArray, to_v: FloatArray) -> _RelativeMotion:
        c1 = column_cross(edge, to_v) + column_cross(edge_v, to)
        return cls(edge, edge_v, to, to_v, column_cross(edge, to), c1, column_cross(edge_v, to_v))

    def may_meet(self, rounding: float) -> IntArray:
        """Indices of a superset of the pairs whose c has a root in [0, 1]; rounding: of a coefficient."""
        bound = np.abs(self.c1) + np.abs(self.c2)
        return np.flatnonzero((1.0 - NEGLIGIBLE) * np.abs(self.c0) <= bound + rounding)


def _first_impact(motion: _RelativeMotion, near: FloatArray, resolution: float, rounding: float) -> FloatArray:
    """(K,) first time in (0, 1] at which the point is on the edge, infinite where it never is.

    near: (K,) distance that counts as on the edge; resolution: rounding of a position; rounding: of a coefficient.
    """
    edge, edge_v, to, to_v, c0, c1, c2 = motion
    discriminant = c1 * c1 - 4.0 * c0 * c2
    real = discriminant >= -ROUND_OFF * c1 * c1  # the point grazes the line
    # the numerically stable pair of roots: q / c2 and c0 / q
    q = -0.5 * (c1 + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), c1))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        times, possible = [q / c2, c0 / q], [real, real]
    if (np.abs(c0) <= rounding).any():
        lengths = [np.abs(vector).sum(axis=0) for vector in (edge, to, edge_v, to_v)]
        collinear = (
            (np.abs(c0) <= resolution * (lengths[0] + lengths[1]))
            & (np.abs(c1) <= resolution * sum(lengths))
            & (np.abs(c2) <= resolution * (lengths[2] + lengths[3]))
        )
        # on one line, only a point beyond the ends of the edge is apart from it
        beyond = collinear & ((column_dot(edge, to) <= 0.0) | (column_dot(edge, to - edge) >= 0.0))
        times += [_closest_time(to, to_v), _closest_time(to - edge, to_v - edge_v)]
        possible += [beyond, beyond]
    time = np.concatenate(times).reshape(len(times), -1)
    valid = np.concatenate(possible).reshape(time.shape) & (time > 0.0) & (time <= 1.0)
    s = np.where(valid, time, 0.0)
    e = edge[:, None] + s * edge_v[:, None]
    t = to[:, None] + s * to_v[:, None]
    t -= np.minimum(np.maximum(column_dot(e, t) / np.maximum(column_dot(e, e), TINY), 0.0), 1.0) * e
    valid &= column_dot(t, t) < near * near
    first: FloatArray = np.where(valid, time, np.inf).min(axis=0)
    return first


def _closest_time(offset: FloatArray, velocity: FloatArray) -> FloatArray:
    """(K,) time at which offset + s velocity, both (2, K), is shortest; 0 without motion."""
    time: FloatArray = -column_dot(offset, velocity) / np.maximum(column_dot(velocity, velocity), TINY)
    return time
