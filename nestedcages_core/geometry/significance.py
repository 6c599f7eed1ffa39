"""Significance: how much the vertices of loops tell (Ramer 1972, Douglas & Peucker 1973), in whole-array operations.

The significance of a vertex is its distance from the chord that it splits, at most that of the chord's own ends. All
chords of all loops are split at once, in about log2(n) rounds; what needs many more, such as a comb, is halved.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count as counting

import numpy as np

from .arrays import TINY, FloatArray
from .precision import NEGLIGIBLE
from .vectors import bounds

MAX_ROUNDS = 128
"""Rounds after which a chord is split at its middle vertex, instead of the farthest: that bounds no less."""


def significance(rings: Sequence[FloatArray]) -> FloatArray:
    """(n,) distance up to which each vertex of loops (k, 2) may be left out; 0 for some below a negligible part of the
    diagonal, infinite for the extreme vertices of each loop."""
    vertices = np.concatenate(rings)
    least = NEGLIGIBLE * float(np.hypot(*np.ptp(bounds(vertices), axis=0)))
    # each loop as a path from its first extreme vertex around to that
    paths, chords, begin = [], [], 0
    for k, ring in enumerate(rings):
        extremes = np.unique([*ring.argmin(axis=0), *ring.argmax(axis=0)])
        paths.append(begin + (np.arange(len(ring) + 1) + extremes[0]) % len(ring))
        chords.append(begin + k + np.append(extremes - extremes[0], len(ring)))
        begin += len(ring)
    place = np.concatenate(paths)
    i, j = (np.concatenate(ends) for ends in zip(*((chord[:-1], chord[1:]) for chord in chords), strict=True))
    x, y = vertices.take(place, axis=0).T.copy()
    squared = np.zeros(len(place))
    squared[i], limit = np.inf, np.full(len(i), np.inf)
    for rounds in counting():
        split = np.flatnonzero(j - i > 1)
        if len(split) == 0:
            break
        i, j, limit = i[split], j[split], limit[split]
        count = j - i - 1
        first = np.cumsum(count) - count
        at = np.arange(count.sum()) + np.repeat(i + 1 - first, count)
        along_x, along_y = x[j] - x[i], y[j] - y[i]
        length = np.maximum(along_x**2 + along_y**2, TINY)
        away_x, away_y = x.take(at) - np.repeat(x[i], count), y.take(at) - np.repeat(y[i], count)
        part = away_x * np.repeat(along_x / length, count) + away_y * np.repeat(along_y / length, count)
        np.clip(part, 0.0, 1.0, out=part)
        away_x -= part * np.repeat(along_x, count)
        away_y -= part * np.repeat(along_y, count)
        away = away_x**2 + away_y**2
        farthest = np.maximum.reduceat(away, first)
        at_most = np.flatnonzero(away == np.repeat(farthest, count))
        middle = at[at_most[at_most.searchsorted(first)]] if rounds < MAX_ROUNDS else (i + j) // 2
        limit = np.minimum(limit, farthest)
        squared[middle] = limit
        apart = farthest > least**2
        i, middle, j, limit = i[apart], middle[apart], j[apart], np.repeat(limit[apart], 2)
        i, j = np.stack((i, middle), axis=1).ravel(), np.stack((middle, j), axis=1).ravel()
    result = np.zeros(len(vertices))
    result[place[::-1]] = np.sqrt(squared[::-1])  # the first vertex of a path stands at both of its ends
    return result
