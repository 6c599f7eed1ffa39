"""The convex hull of points, by exact predicates."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray, IntArray
from .predicates import orientation_sign


def convex_hull(points: FloatArray) -> IntArray:
    """(h,) the corners of the convex hull of points (n, 2), counter-clockwise, by exact predicates (Andrew 1979)."""
    order = np.lexsort((points[:, 1], points[:, 0])).tolist()
    x, y = points[:, 0].tolist(), points[:, 1].tolist()
    halves = []
    for walk in (order, order[::-1]):
        half: list[int] = []
        for k in walk:
            while (
                len(half) > 1 and orientation_sign(x[half[-2]], y[half[-2]], x[half[-1]], y[half[-1]], x[k], y[k]) <= 0
            ):
                half.pop()
            half.append(k)
        halves += half[:-1]
    return np.array(halves, dtype=np.int64)
