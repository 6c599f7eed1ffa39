"""Distances for `checker`: exact ones, and the largest of a cage from what it encloses, which exact ones bound.

The largest distance is sought among points in float64, which are complex numbers here; the result is verified exactly.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

PIECES = 1_000_000
"""Number of distances measured at once; bounds the memory."""

NEAREST = 4
"""Number of edges tried as the one that a piece stays close to."""

ROUNDING = Fraction(1, 2**46)
"""Bound on the error of corners and middles in float64, per largest coordinate: 50 roundings and as many halvings."""


def whole_numbers(x: Any) -> tuple[Any, int]:
    """An array times a power of two that makes every entry a Python integer, and that power. Raises ValueError."""
    if not np.isfinite(x).all():
        raise ValueError("there are coordinates that are not finite")
    digits, power = np.frexp(x)  # a double has 53 binary digits
    power = np.where(digits == 0.0, 0, power - 53)
    lowest = int(power.min(initial=0))
    whole = (digits * 2.0**53).astype(np.int64).astype(object) << (power - lowest).astype(object)
    bits = int(np.bitwise_or.reduce(whole.ravel(), initial=0))
    zeros = max(0, min(-lowest, (bits & -bits).bit_length() - 1))
    return whole >> zeros, 2 ** (-lowest - zeros)


def dot_cross(u: Any, v: Any) -> tuple[Any, Any]:
    """Dot and cross products of vectors (..., 2)."""
    return u[..., 0] * v[..., 0] + u[..., 1] * v[..., 1], u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def squared_gaps(p: Any, a: Any, b: Any) -> tuple[Any, Any]:
    """Squared distances of points from edges a-b, all in whole numbers, times the squared lengths; and these."""
    (place, off), length = dot_cross(b - a, p - a), dot_cross(b - a, b - a)[0]
    to_a, to_b = (dot_cross(p - end, p - end)[0] * length for end in (a, b))
    return np.where(place <= 0, to_a, np.where(place < length, off**2, to_b)), length


def farther_than(distance: float, x: Any, after: Any, is_fine: Any, tolerance: Fraction) -> list[str]:
    """A sentence if a point between a fine mesh and a cage around it is farther than a distance from the fine mesh.

    x, after, is_fine: vertices (n, 2) of both, the vertex after each with the solid on the left, and which is fine.
    Vertical lines through all vertices cut this region into trapezoids. The distance to an edge is convex, so on a
    piece it is largest at a corner. Pieces that no edge close by bounds are halved, lengthwise and across in turn.
    """
    start, end = x @ [1.0, 1j], x[after] @ [1.0, 1j]
    a, b = start[is_fine], end[is_fine]
    rounding = ROUNDING * Fraction(np.abs(x).max())
    refused = Fraction(distance) + max(tolerance * Fraction(distance), 8 * rounding)
    accepted = 2 * refused - Fraction(distance) - rounding
    found = _trapezoids(start, end, is_fine)
    todo = np.array_split(found, 1 + found.size * len(a) // PIECES)
    while todo:
        if not len(piece := todo.pop()):
            continue
        middle = piece.mean(axis=1, keepdims=True)
        gaps = _gap(middle - a, b - a)
        worst = gaps.min(axis=1).argmax()
        if gaps[worst].min() > float(refused) and not _within(refused, middle[worst], a, b).any():
            place = f"({middle[worst, 0].real:.6g}, {middle[worst, 0].imag:.6g})"
            return [f"the cage is farther than {distance:.9g} from the fine mesh near {place}"]
        near = gaps.argpartition(min(NEAREST, len(a)) - 1, axis=1)[:, :NEAREST]
        bounds = _gap(piece[:, None] - a[near][..., None], (b - a)[near][..., None]).max(axis=2)
        best = near[np.arange(len(near)), bounds.argmin(axis=1), None]
        left = bounds.min(axis=1) > float(accepted)
        left[~left] = ~_within(accepted, piece[~left], a[best[~left]], b[best[~left]]).all(axis=1)
        p, q, r, s = piece[left].T
        todo += [
            np.stack(half, axis=1) for half in (((p + q) / 2, (r + s) / 2, s, p), (q, r, (r + s) / 2, (p + q) / 2))
        ]
    return []


def _gap(to: Any, along: Any) -> Any:
    """Distances of points from edges, given the vectors from the starts of the edges."""
    return np.abs(to - along * np.clip((to / along).real, 0.0, 1.0))


def _within(limit: Fraction, *points_and_edges: Any) -> Any:
    """Whether points are within a distance of edges a-b, exactly."""
    p_a_b = np.stack(np.broadcast_arrays(*points_and_edges))
    whole, factor = whole_numbers(np.stack([p_a_b.real, p_a_b.imag], axis=-1))
    (squared, length), wanted = squared_gaps(*whole), (limit * factor) ** 2
    return (squared * wanted.denominator <= length * wanted.numerator).astype(bool)


def _trapezoids(start: Any, end: Any, is_fine: Any) -> Any:
    """(T, 4) corners of the trapezoids, in order."""
    low, high = np.minimum(start.real, end.real), np.maximum(start.real, end.real)
    slabs, pieces = np.array([*pairwise(np.unique([low, high]))]), []
    groups = [(group, np.flatnonzero((low <= group[-1, 0]) & (high >= group[0, 1])))
              for group in np.array_split(slabs, int(len(slabs) ** 0.5))]  # fmt: skip
    for x, near in ((x, near) for group, near in groups for x in group):
        k = near[(low[near] <= x[0]) & (high[near] >= x[1])]
        along = end[k] - start[k]
        y = start[k].imag + along.imag * ((np.array(x)[:, None] - start[k].real) / along.real)
        upwards = y.sum(axis=0).argsort()
        left, right = np.array(x)[:, None] + 1j * y[:, upwards]
        sense, of_fine = np.where(along.real > 0.0, 1, -1)[upwards], is_fine[k][upwards]
        m = np.flatnonzero((np.cumsum(sense * ~of_fine) > 0) & (np.cumsum(sense * of_fine) == 0))
        pieces.append(np.stack([left[m], right[m], right[m + 1], left[m + 1]], axis=1))
    return np.concatenate(pieces)
