"""Whether a point and an edge in linear motion certainly never meet.

With s from 0 to 1, a point p and an edge a-b meet only where c = (b - a) × (p - a) is zero and p lies next to the edge.
Both c and the two products that say whether p lies next to it are quadratic in s, so each lies between the smallest and
the largest of its three Bernstein coefficients (Farouki 2012). Where those have one sign, beyond their rounding errors,
the pair is certified; so is one whose point stays on one side of both ends of the edge along x or along y, even where
the edge shrinks to a point. All other intervals of s are halved. After k halvings a difference of positions carries an
absolute error of up to k roundings of the largest one, which both tests allow for: a relative bound says nothing about
a difference that vanishes. A pair that is undecided after all halvings counts as a collision, so the certificate is
conservative.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray

MAX_HALVINGS = 40
"""Maximum number of halvings: an interval is then about as short as a rounding of s."""

MAX_PIECES = 32
"""Maximum number of undecided intervals of one pair: a passing contact leaves two or three, sliding leaves more."""

COEFFICIENT_ROUNDING = 16.0 * float(np.finfo(float).eps)
"""Bound on the relative rounding error of a coefficient: a product of two differences, summed twice, doubled for
safety."""

HALVING_ROUNDING = float(np.finfo(float).eps)
"""Bound on the rounding error that a halving adds to a difference of positions, relative to the largest one:
half of it for the sum; the other half, once, for the difference itself."""

UNDERFLOW = 16.0 * np.finfo(float).smallest_subnormal
"""Bound on the error of a coefficient whose products leave the range of normal floats."""


def never_meet(before: FloatArray, after: FloatArray) -> BoolArray:
    """(K,) whether pairs certainly stay apart in linear motion; positions (3, 2, K) of point, start and end."""
    first, last = _differences(before), _differences(after)
    certified = _never_aligned(first, last, np.zeros(before.shape[2]))
    left = (~certified).nonzero()[0]
    if len(left):
        certified[left] = _by_halving(first.take(left, axis=2), last.take(left, axis=2))
    return certified


def _by_halving(first: FloatArray, last: FloatArray) -> BoolArray:
    """`never_meet` for differences of positions (3, 2, K) before and after."""
    count = first.shape[2]
    pair = np.arange(count)
    rounding = HALVING_ROUNDING * np.abs(np.concatenate([first, last])).reshape(-1, count).max(axis=0)
    certified = np.ones(count, bool)
    for halvings in range(MAX_HALVINGS):
        margin = halvings * rounding.take(pair)
        left = (~_never_aligned(first, last, margin)).nonzero()[0]
        pair, margin = pair.take(left), margin.take(left)
        first, last = first.take(left, axis=2), last.take(left, axis=2)
        left = (~_never_beside(first, last, margin)).nonzero()[0]
        if len(left) == 0:
            break
        crowded = np.bincount(pair.take(left), minlength=count) > MAX_PIECES
        if crowded.any():
            certified[crowded] = False
            left = left[~crowded[pair.take(left)]]
        pair = pair.take(left)
        first, last = first.take(left, axis=2), last.take(left, axis=2)
        middle = 0.5 * (first + last)
        pair = np.concatenate([pair, pair])
        first, last = np.concatenate([first, middle], axis=2), np.concatenate([middle, last], axis=2)
    else:
        certified[pair] = False
    return certified


def _differences(corners: FloatArray) -> FloatArray:
    """(3, 2, K) along the edge, from its start and from its end to the point, of these at positions (3, 2, K)."""
    point, start, end = corners
    differences = np.empty_like(corners)
    for difference, (to, of) in zip(differences, ((end, start), (point, start), (point, end)), strict=True):
        np.subtract(to, of, out=difference)
    return differences


def _never_aligned(first: FloatArray, last: FloatArray, margin: FloatArray) -> BoolArray:
    """(K,) whether the point certainly never is on the line of the edge; differences (3, 2, K), errors (K,)."""
    (edge, from_start, _), (last_edge, last_from_start, _) = first, last
    values, errors = _bernstein(edge, last_edge, from_start, last_from_start, margin, cross=True)
    return _above(values, errors) | _above(-values, errors)


def _never_beside(first: FloatArray, last: FloatArray, margin: FloatArray) -> BoolArray:
    """(K,) whether the point certainly is before the start of the edge, after its end, or beyond both along an axis."""
    (edge, *ends), (last_edge, *last_ends) = first, last
    ahead, errors = _bernstein(edge, last_edge, ends[0], last_ends[0], margin, cross=False)
    before_start = _above(-ahead, errors)
    ahead, errors = _bernstein(edge, last_edge, ends[1], last_ends[1], margin, cross=False)
    sides = np.stack([*ends, *last_ends])
    beyond = _above(sides, margin) | _above(-sides, margin)
    return np.asarray(before_start | _above(ahead, errors) | beyond[0] | beyond[1])


def _above(values: FloatArray, errors: FloatArray) -> BoolArray:
    """Whether all values along the first axis are above their errors."""
    return np.asarray((values > errors).all(axis=0))


def _bernstein(
    u0: FloatArray, u1: FloatArray, w0: FloatArray, w1: FloatArray, margin: FloatArray, *, cross: bool
) -> tuple[FloatArray, FloatArray]:
    """Coefficients (3, K) of u(s) × w(s), or of u(s) · w(s), for linear u and w (2, K), and bounds of their errors.

    margin: (K,) bounds on the absolute errors of the components of u and w.
    """
    if cross:
        w0, w1 = w0[::-1], w1[::-1]
    values, sizes = np.empty((3, len(margin))), np.empty((3, len(margin)))

    def product(u: FloatArray, w: FloatArray, k: int) -> None:
        first, second = u[0] * w[0], u[1] * w[1]
        (np.subtract if cross else np.add)(first, second, out=values[k])
        np.add(np.abs(first, out=first), np.abs(second, out=second), out=sizes[k])

    product(u1, w0, 0)
    product(u0, w1, 1)
    for both in (values, sizes):
        np.add(both[0], both[1], out=both[1])
        both[1] *= 0.5
    product(u0, w0, 0)
    product(u1, w1, 2)
    errors = COEFFICIENT_ROUNDING * sizes
    errors += UNDERFLOW
    if margin.any():
        # (u + δ)(w + δ) - u w for both terms of each product, the larger end of each vector taken for both
        reach = np.maximum(*(np.abs(u).sum(axis=0) for u in (u0, u1)))
        reach += np.maximum(*(np.abs(w).sum(axis=0) for w in (w0, w1)))
        errors += margin * (reach + 2.0 * margin)
    return values, errors
