"""Certified predicates on plain arrays: orientation, crossing, containment; a float filter, then exact arithmetic.

Every answer is the exact one for the double coordinates that come in, however close to degenerate they are.
Filters after J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates (1997).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .box_tree import FANOUT, BoxTree, Floats, Ints

Bools = NDArray[np.bool_]
Signs = NDArray[np.int8]

ON_BOUNDARY = int(np.iinfo(np.int64).min)
"""Value of `winding_number` for a point that lies on an edge."""

ROUND_OFF = 2.0**-53
"""Largest relative error of one float64 operation."""

FLOAT_BOUND = (3.0 + 16.0 * ROUND_OFF) * ROUND_OFF
"""Relative error of the 2x2 determinant of rounded differences (Shewchuk 1997, section 4.3, bound A)."""

EXTENDED_BOUND = 40.0 * ROUND_OFF**2
"""Relative error of the determinant with first-order corrections; about 15 terms of one ROUND_OFF**2 each, doubled."""

LEAST_PRODUCT, GREATEST_PRODUCT = 1e-240, 1e+240
"""Products within are free of underflow and overflow, their rounding errors included (double range 5e-324, 2e308)."""

MANTISSA_BITS = 53
"""Bits of the significand of a double."""

SPLITTER = 2.0**27 + 1.0
"""Splits a double into two halves of 26 bits (Dekker 1971)."""


def orientation(a: Floats, b: Floats, c: Floats) -> Signs:
    """Exact sign of (b - a) x (c - a) for points (..., 2): 1 for a left turn, -1 for a right turn, 0 on a line."""
    ax, ay, bx, by, cx, cy = (np.asarray(p, dtype=np.float64)[..., k] for p in (a, b, c) for k in (0, 1))
    with np.errstate(all="ignore"):
        left = (ax - cx) * (by - cy)
        right = (ay - cy) * (bx - cx)
        determinant: Floats = np.asarray(left - right)
        certain = np.abs(determinant) > FLOAT_BOUND * (np.abs(left) + np.abs(right)) + LEAST_PRODUCT
        sign: Signs = np.sign(np.where(certain, determinant, 0.0)).astype(np.int8)
        if not certain.all():
            doubtful = np.nonzero(~certain)
            coordinates = np.broadcast_arrays(ax, ay, bx, by, cx, cy)
            sign[doubtful] = _sign_by_difference_signs(*(x[doubtful] for x in coordinates))
    return sign


def _sign_by_difference_signs(ax: Floats, ay: Floats, bx: Floats, by: Floats, cx: Floats, cy: Floats) -> Signs:
    """Signs of differences are exact, so products of different sign need no magnitude; the rest is handed on."""
    left = np.sign(ax - cx) * np.sign(by - cy)
    right = np.sign(ay - cy) * np.sign(bx - cx)
    sign: Signs = np.sign(left - right).astype(np.int8)
    hard = np.flatnonzero((left == right) & (left != 0))
    if len(hard):
        sign[hard] = _sign_by_extended(*(x[hard] for x in (ax, ay, bx, by, cx, cy)))
    return sign


def _sign_by_extended(ax: Floats, ay: Floats, bx: Floats, by: Floats, cx: Floats, cy: Floats) -> Signs:
    """Determinant in double-double: exact where the four differences are, else certain above its own bound."""
    (p, p_tail), (q, q_tail) = _difference(ax, cx), _difference(by, cy)
    (r, r_tail), (s, s_tail) = _difference(ay, cy), _difference(bx, cx)
    (left, left_tail), (right, right_tail) = _product(p, q), _product(r, s)
    exact = (p_tail == 0) & (q_tail == 0) & (r_tail == 0) & (s_tail == 0)
    in_order = np.where(left != right, np.sign(left - right), np.sign(left_tail - right_tail))
    corrections = (p * q_tail + q * p_tail) - (r * s_tail + s * r_tail)
    estimate = (left - right) + ((left_tail - right_tail) + corrections)
    bound = EXTENDED_BOUND * (np.abs(left) + np.abs(right))
    side = np.where(exact, in_order, np.sign(estimate))
    certain = exact | (np.abs(estimate) > bound)
    for product in (left, right):
        certain &= (np.abs(product) > LEAST_PRODUCT) & (np.abs(product) < GREATEST_PRODUCT)
    for factor in (p, q, r, s):
        certain &= np.abs(factor) < GREATEST_PRODUCT
    sign: Signs = np.where(certain, side, 0.0).astype(np.int8)
    open_ = np.flatnonzero(~certain)
    if len(open_):
        sign[open_] = _sign_by_integers(np.stack([x[open_] for x in (ax, ay, bx, by, cx, cy)], axis=1))
    return sign


def _sign_by_integers(coordinates: Floats) -> Signs:
    """Sign from unbounded integers, coordinates (K, 6) scaled row by row to a common power of two: always exact."""
    ax, ay, bx, by, cx, cy = as_integers(coordinates)[0].T
    determinant = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    return np.asarray((determinant > 0).astype(np.int8) - (determinant < 0).astype(np.int8), dtype=np.int8)


def as_integers(numbers: Floats) -> tuple[NDArray[np.object_], Ints]:
    """Rows of doubles (K, N) as Python integers (K, N) and exponents (K,): number = integer 2**exponent; exact."""
    mantissa, exponent = np.frexp(numbers)
    whole = np.ldexp(mantissa, MANTISSA_BITS).astype(np.int64).astype(object)
    least = exponent.min(axis=1).astype(np.int64)
    shift = exponent - least[:, None]
    return np.asarray(np.left_shift(whole, shift.astype(object)), dtype=object), least - MANTISSA_BITS


def _difference(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """a - b as rounded difference and exact remainder (Knuth's two-sum)."""
    difference = a - b
    part = a - difference
    return difference, (a - (difference + part)) + (part - b)


def _product(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """a b as rounded product and exact remainder (Dekker 1971)."""
    product = a * b
    a_high = SPLITTER * a - (SPLITTER * a - a)
    b_high = SPLITTER * b - (SPLITTER * b - b)
    a_low, b_low = a - a_high, b - b_high
    return product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)


def segments_intersect(a: Floats, b: Floats, c: Floats, d: Floats) -> Bools:
    """Whether closed segments a-b and c-d, each (K, 2), share a point (touching counts); exact, (K,).

    They do if and only if their boxes overlap and neither lies on one side of the other's line.
    """
    a, b, c, d = np.broadcast_arrays(a, b, c, d)
    meet: Bools = (np.minimum(a, b) <= np.maximum(c, d)).all(axis=-1)
    meet &= (np.minimum(c, d) <= np.maximum(a, b)).all(axis=-1)
    for start, end, first, second in ((a, b, c, d), (c, d, a, b)):
        k = np.flatnonzero(meet)
        sides = orientation(start[k], end[k], first[k]) * orientation(start[k], end[k], second[k])
        meet[k] = sides <= 0
    return meet


def crossing_pairs(tree: BoxTree, other: BoxTree | None = None) -> tuple[Ints, Ints]:
    """Pairs of segments that cross or touch, (K,), (K,): of two trees, or i < j within one (neighbours included)."""
    i, j = tree.self_pairs() if other is None else tree.pairs(other)
    second = tree if other is None else other
    hit = segments_intersect(tree.starts[i], tree.ends[i], second.starts[j], second.ends[j])
    return i[hit], j[hit]


def winding_number(points: Floats, starts: Floats, ends: Floats) -> Ints:
    """How often closed loops of directed edges (E, 2) -> (E, 2) run around points (P, 2); exact, (P,).

    Points on an edge get ON_BOUNDARY. A point inside a counter-clockwise loop gets 1.
    """
    points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    crossings = ray_crossings(points, BoxTree(starts, ends))
    winding = np.zeros(len(points), dtype=np.int64)
    np.add.at(winding, crossings.point, crossings.value)
    winding[crossings.touching] = ON_BOUNDARY
    return winding


class RayCrossings:
    """Signed crossings of the rays from points to the right, summed per chain of a tree.

    point, chain, value: (K,) each; touching: (T,) indices of points that lie on an edge (may repeat).
    """

    def __init__(self) -> None:
        self.point = self.chain = self.value = self.touching = np.zeros(0, dtype=np.int64)

    def add(self, point: Ints, chain: Ints, value: Ints) -> None:
        counts = value != 0
        self.point = np.concatenate((self.point, point[counts]))
        self.chain = np.concatenate((self.chain, chain[counts]))
        self.value = np.concatenate((self.value, value[counts]))


def ray_crossings(points: Floats, tree: BoxTree) -> RayCrossings:
    """Crossings of the chains of a tree with the rays from points (P, 2) to the right; exact.

    A stretch of a chain outside whose box a point lies counts by its two ends alone: +1 if it ends above and starts
    not above the ray, -1 for the reverse, 0 left of the point. Only boxes around a point are opened, so the cost is
    about log E per point. An end on the ray counts as below, so a ray through a vertex is counted once.
    """
    crossings = RayCrossings()
    if len(tree) == 0 or len(points) == 0:
        return crossings
    x, y = np.ascontiguousarray(points.T)
    start_y, end_y = tree.starts[tree.order, 1], tree.ends[tree.order, 1]
    level = len(tree.levels) - 1
    top = tree.levels[level].shape[1]
    p, node = np.repeat(np.arange(len(points)), top), np.tile(np.arange(top), len(points))
    span = FANOUT**level
    while True:
        low_x, low_y, high_x, high_y = tree.levels[level].take(node, axis=1)
        px, py = x.take(p), y.take(p)
        relevant = px <= high_x
        inside = relevant & (low_x <= px) & (low_y <= py) & (py <= high_y)
        outside = relevant & ~inside & (low_y <= py) & (py <= high_y)
        first, last = node * span, np.minimum(node * span + span, len(tree)) - 1
        if not tree.closed:
            divided = outside.copy()
            divided[outside] = tree.chain[first[outside]] != tree.chain[last[outside]]
            inside |= divided
            outside &= ~divided
        q, first, last, qy = p[outside], first[outside], last[outside], py[outside]
        _count_stretches(crossings, tree, q, qy, first, last, start_y, end_y)
        p, node = p[inside], node[inside]
        if level == 0:
            break
        level, span = level - 1, span // FANOUT
        p, node = np.repeat(p, FANOUT), (FANOUT * node[:, None] + np.arange(FANOUT)).ravel()
    _count_edges(crossings, tree, points, p, node)
    return crossings


def _count_stretches(
    crossings: RayCrossings,
    tree: BoxTree,
    point: Ints,
    y: Floats,
    first: Ints,
    last: Ints,
    start_y: Floats,
    end_y: Floats,
) -> None:
    """Count runs of segments first..last to the right of their points; whole closed chains in between add nothing."""
    begin, finish = tree.chain[first], tree.chain[last]
    one = begin == finish
    up_to, down_from = end_y[last] > y, start_y[first] > y
    crossings.add(point[one], begin[one], up_to[one].astype(np.int64) - down_from[one])
    many = ~one
    if many.any():
        opening, closing = start_y[tree.chain_starts[begin]] > y, start_y[tree.chain_starts[finish]] > y
        crossings.add(point[many], begin[many], opening[many].astype(np.int64) - down_from[many])
        crossings.add(point[many], finish[many], up_to[many].astype(np.int64) - closing[many])


def _count_edges(crossings: RayCrossings, tree: BoxTree, points: Floats, point: Ints, segment: Ints) -> None:
    """Count single edges whose boxes hold their points: by the side of the edge that the point is on."""
    a, b, c = tree.starts[tree.order[segment]], tree.ends[tree.order[segment]], points[point]
    side = orientation(a, b, c)
    rises = (b[:, 1] > c[:, 1]).astype(np.int64) - (a[:, 1] > c[:, 1])
    crossings.add(point, tree.chain[segment], np.where(rises == side, rises, 0))
    crossings.touching = np.unique(point[side == 0])
