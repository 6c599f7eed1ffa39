"""Overlapping boxes by sorting along x: for some thousand boxes this takes a fraction of the time of a tree."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray

SWEEP_LIMIT = 10_000
"""Number of boxes up to which sorting is tried first (measured)."""

SWEPT_PER_BOX = 64
"""Pairs per box that overlap along x, above which a tree is faster (measured)."""


def swept_pairs(
    low: FloatArray, high: FloatArray, other_low: FloatArray, other_high: FloatArray, most: int
) -> tuple[IntArray, IntArray] | None:
    """Pairs (i, j) of boxes (2, N), (2, N) and others (2, M), (2, M) that share a point, (K,), (K,).

    None where more than `most` pairs, or SWEPT_PER_BOX per box, overlap along x.
    """
    # one of two that overlap begins within the other, where both begin at once the second within the first
    order, other_order = low[0].argsort(kind="stable"), other_low[0].argsort(kind="stable")
    begins, other_begins = low[0].take(order), other_low[0].take(other_order)
    first, count = _range(other_begins, low[0], high[0], "left")
    other_first, other_count = _range(begins, other_low[0], other_high[0], "right")
    total = int(count.sum() + other_count.sum())
    if total > min(most, SWEPT_PER_BOX * (len(order) + len(other_order))):
        return None
    i, place = expanded(first, count)
    j, other_place = expanded(other_first, other_count)
    i = np.concatenate([i, order.take(other_place)])
    j = np.concatenate([other_order.take(place), j])
    keep = low[1].take(i) <= other_high[1].take(j)
    keep &= other_low[1].take(j) <= high[1].take(i)
    kept = keep.nonzero()[0]
    return i.take(kept), j.take(kept)


def swept_self_pairs(low: FloatArray, high: FloatArray, most: int) -> tuple[IntArray, IntArray] | None:
    """Pairs i < j of boxes (2, N), (2, N) that share a point, (K,), (K,); None as in `swept_pairs`."""
    order = low[0].argsort(kind="stable")
    low, high = low.take(order, axis=1), high.take(order, axis=1)
    first = np.arange(1, len(order) + 1)
    count = low[0].searchsorted(high[0], "right") - first
    if int(count.sum()) > min(most, SWEPT_PER_BOX * len(order)):
        return None
    i, j = expanded(first, count)
    keep = low[1].take(i) <= high[1].take(j)
    keep &= low[1].take(j) <= high[1].take(i)
    kept = keep.nonzero()[0]
    i, j = order.take(i.take(kept)), order.take(j.take(kept))
    return np.minimum(i, j), np.maximum(i, j)


def _range(values: FloatArray, low: FloatArray, high: FloatArray, side: str) -> tuple[IntArray, IntArray]:
    """Where the sorted values in [low, high] begin, and how many they are; side "right": in (low, high]."""
    first = values.searchsorted(low, side)  # type: ignore[call-overload]
    return first, values.searchsorted(high, "right") - first


def expanded(first: IntArray, count: IntArray) -> tuple[IntArray, IntArray]:
    """For each of `count` (N,) places from `first` on: whose it is, and the place."""
    whose = np.arange(len(first)).repeat(count)
    place = (first - np.cumsum(count) + count).take(whose)
    place += np.arange(len(whose))
    return whose, place
