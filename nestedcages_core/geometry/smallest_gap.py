"""The smallest distance between two boundaries: of the vertices of either from the edges of the other."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt, ldexp

import numpy as np

from .arrays import FloatArray
from .broad_phase import BoxTree
from .distance import point_edge
from .predicates import as_integers
from .vectors import norm

MEASURED_FIRST = 256
"""Number of vertices of either boundary whose distances bound the result."""

ROUNDING = 16.0 * float(np.finfo(float).eps)
"""Bound on the error of a distance between a point and a segment, over the vectors between their ends."""

ACCURATE = 1e-12
"""Relative error of a distance that is left to rounding; where it may be larger, the distance is exact."""

ROOT_BITS = 64
"""Binary digits of a root, more than a double has."""


def smallest_gap(here: BoxTree, there: BoxTree) -> float:
    """Smallest distance between the closed loops of two trees, which must not meet.

    Some vertices give an upper bound, and few pairs are as near as that. What rounding may decide is measured again in
    whole numbers.
    """
    sides = (here, there), (there, here)
    step = 1 + max(len(here), len(there)) // MEASURED_FIRST
    bound = min(float(tree.closest(other.starts[::step]).distance.min()) for tree, other in sides)
    slack = ROUNDING * (bound + max(float(norm(tree.ends - tree.starts).max()) for tree in (here, there)))
    i, j = here.pairs(there, bound + 2.0 * slack)
    one, other = here.segments(i), there.segments(j)
    p, a, b = (np.concatenate(each) for each in ((one[0], other[0]), (other[0], one[0]), (other[1], one[1])))
    distance = point_edge(p, a, b).distance
    best = float(distance.min())
    if slack <= ACCURATE * best:
        return best
    near = distance <= best + 2.0 * slack
    return _exact_gap(p[near], a[near], b[near])


def _exact_gap(p: FloatArray, a: FloatArray, b: FloatArray) -> float:
    """Smallest distance of points p from segments a-b, (K, 2) each, rounded once."""
    whole, exponent = as_integers(np.concatenate([p, a, b], axis=1).reshape(1, -1))
    p, a, b = whole.reshape(-1, 3, 2).transpose(1, 2, 0)
    along, to_a, to_b = b - a, p - a, p - b
    place, length = (along * to_a).sum(axis=0), (along**2).sum(axis=0)
    off = (along[0] * to_a[1] - along[1] * to_a[0]) ** 2
    ends = np.where(place <= 0, (to_a**2).sum(axis=0), (to_b**2).sum(axis=0)) * length
    squared = np.where((place <= 0) | (place >= length), ends, off)
    over, under = min(zip(squared, length, strict=True), key=lambda ratio: Fraction(*ratio))
    shift = 2 * (ROOT_BITS - (over.bit_length() - under.bit_length()) // 2)
    root = isqrt((over << shift if shift >= 0 else over >> -shift) // under)
    return ldexp(root, int(exponent[0]) - shift // 2)
