"""The cheapest choice of one candidate per layer, with costs between neighbours in a circle."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray, IntArray


def shortest_cycle(costs: list[FloatArray]) -> IntArray | None:
    """(m,) the point of each layer on the cheapest cycle through all m layers; None if no cycle has finite cost.

    costs: for each layer (K, K') of the steps to the next one, infinite where there is none; the last leads to the
    first.
    """
    begin = int(np.argmin([len(cost) for cost in costs]))
    order = np.roll(np.arange(len(costs)), -begin)
    least = costs[begin]
    back: list[IntArray] = []
    for layer in order[1:]:
        through = least[:, :, None] + costs[layer][None]
        back.append(through.argmin(axis=1))
        least = through.min(axis=1)
    start = int(np.diagonal(least).argmin())
    if not np.isfinite(least[start, start]):
        return None
    picked: IntArray = np.zeros(len(costs), np.int64)
    place = start
    for layer, before in zip(order[:0:-1], back[::-1], strict=True):
        place = int(before[start, place])
        picked[layer] = place
    picked[begin] = start
    return picked
