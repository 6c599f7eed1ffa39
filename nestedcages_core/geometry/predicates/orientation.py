"""Exact orientation and crossing: a float filter, then integers for what is left.

Filter after J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates (1997).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import AnyArray, BoolArray, FloatArray, IntArray
from ..broad_phase import BoxTree

Signs = NDArray[np.int8]

UNIT_ROUND_OFF = 2.0**-53
"""Largest relative error of one float64 operation."""

FLOAT_BOUND = (3.0 + 16.0 * UNIT_ROUND_OFF) * UNIT_ROUND_OFF
"""Relative error of the 2x2 determinant of rounded differences (Shewchuk 1997, section 4.3, bound A)."""

MIN_PRODUCT = 1e-240
"""Products above this, and their rounding errors, do not underflow (a double does below 5e-324)."""

MANTISSA_BITS = 53
"""Bits of the significand of a double."""


def orientation(a: FloatArray, b: FloatArray, c: FloatArray) -> Signs:
    """Exact sign of (b - a) x (c - a) for points (..., 2): 1 for a left turn, -1 for a right turn, 0 on a line."""
    a, b, c = np.asarray(a, np.float64), np.asarray(b, np.float64), np.asarray(c, np.float64)
    ax, ay, bx, by, cx, cy = a[..., 0], a[..., 1], b[..., 0], b[..., 1], c[..., 0], c[..., 1]
    with np.errstate(all="ignore"):
        left = (ax - cx) * (by - cy)
        right = (ay - cy) * (bx - cx)
        determinant: FloatArray = left - right
        bound = np.abs(left)
        bound += np.abs(right)
        bound *= FLOAT_BOUND
        bound += MIN_PRODUCT
        sign: Signs = np.asarray((determinant > bound).view(np.int8) - (determinant < -bound).view(np.int8))
        if not sign.all():
            doubtful = np.nonzero(sign == 0) if sign.ndim else None
            corners = [ax, ay, bx, by, cx, cy]
            if not ax.shape == bx.shape == cx.shape:
                corners = list(np.broadcast_arrays(*corners))
            sign[doubtful] = _sign_by_signs(np.array([x[doubtful] for x in corners]))
    return sign


def orientation_sign(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> int:
    """Exact sign of (b - a) x (c - a) for three points in plain floats: the twin of `orientation` for scalar loops."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    determinant = left - right
    bound = FLOAT_BOUND * (abs(left) + abs(right)) + MIN_PRODUCT
    if determinant > bound:
        return 1
    if determinant < -bound:
        return -1
    if (ax == cx or by == cy) and (ay == cy or bx == cx):
        return 0
    ratios = [number.as_integer_ratio() for number in (ax, ay, bx, by, cx, cy)]
    scale = max(denominator for _, denominator in ratios)  # powers of two, so the others divide it
    px, py, qx, qy, rx, ry = (numerator * (scale // denominator) for numerator, denominator in ratios)
    exact = (px - rx) * (qy - ry) - (py - ry) * (qx - rx)
    return (exact > 0) - (exact < 0)


def _sign_by_signs(corners: FloatArray) -> Signs:
    """Sign for corners (6, K) by the signs of the differences, which are exact, where these decide."""
    ax, ay, bx, by, cx, cy = corners
    left = np.sign(ax - cx) * np.sign(by - cy)
    right = np.sign(ay - cy) * np.sign(bx - cx)
    sign: Signs = np.sign(left - right).astype(np.int8)
    hard = np.flatnonzero((left == right) & (left != 0))
    if len(hard):
        sign[hard] = _sign_by_integers(corners[:, hard])
    return sign


def _sign_by_integers(corners: FloatArray) -> Signs:
    """Sign for corners (6, K) in unbounded integers, each triple scaled by its own power of two: always exact."""
    ax, ay, bx, by, cx, cy = as_integers(corners.T)[0].T
    determinant = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    return np.asarray((determinant > 0).astype(np.int8) - (determinant < 0).astype(np.int8), dtype=np.int8)


def as_integers(numbers: FloatArray) -> tuple[AnyArray, IntArray]:
    """Rows of doubles (K, N) as Python integers (K, N) and exponents (K,): number = integer 2**exponent; exact."""
    mantissa, exponent = np.frexp(numbers)
    whole = np.ldexp(mantissa, MANTISSA_BITS).astype(np.int64).astype(object)
    least = exponent.min(axis=1).astype(np.int64)
    shift = exponent - least[:, None]
    return np.asarray(np.left_shift(whole, shift.astype(object)), dtype=object), least - MANTISSA_BITS


def segments_intersect(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> BoolArray:
    """Whether closed segments a-b and c-d, each (K, 2), share a point (touching counts); exact, (K,).

    They do if and only if their boxes overlap and neither lies on one side of the other's line.
    """
    overlap = np.minimum(a, b) <= np.maximum(c, d)
    overlap &= np.minimum(c, d) <= np.maximum(a, b)
    meet: BoolArray = overlap[:, 0] & overlap[:, 1]
    for start, end, first, second in ((a, b, c, d), (c, d, a, b)):
        k = meet.nonzero()[0]
        if len(k) == 0:
            break
        others = np.concatenate([first.take(k, axis=0), second.take(k, axis=0)]).reshape(2, -1, 2)
        sides = orientation(start.take(k, axis=0), end.take(k, axis=0), others)
        meet[k] = sides[0] * sides[1] <= 0
    return meet


def crossing_pairs(tree: BoxTree, other: BoxTree | None = None) -> tuple[IntArray, IntArray]:
    """Pairs of segments that cross or touch, (K,), (K,): of two trees, or i < j within one (neighbours included)."""
    second = tree if other is None else other
    found_i, found_j = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for i, j in tree.blocks(other):
        hit = segments_intersect(*tree.segments(i), *second.segments(j))
        found_i.append(i[hit])
        found_j.append(j[hit])
    return np.concatenate(found_i), np.concatenate(found_j)
