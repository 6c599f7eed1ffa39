"""Carrying: a first guess of how the cage moves, from the motion of the drawing next to each of its vertices."""

from __future__ import annotations

import numpy as np
import scipy

from ..geometry.arrays import FloatArray

NEIGHBOURS = 24
"""Fine vertices that carry a cage vertex; fewer follow noise, more blur limbs into each other."""

CORE = 0.5
"""Distance, in mean distances of the neighbours, below which a neighbour's weight no longer grows."""


def carried(cage: FloatArray, before: FloatArray, after: FloatArray, weight: FloatArray) -> FloatArray:
    """(m, 2) cage vertices moved as the fine vertices near them move, by the best similarity for each.

    before, after: (n, 2) fine vertices of two poses; weight: (n,) boundary length of each. Moving least squares with
    similarity transformations (Schaefer, McPhail & Warren 2006, section 2.2): exact where the drawing is translated,
    rotated and scaled.
    """
    distance, near = scipy.spatial.cKDTree(before).query(cage, k=min(NEIGHBOURS, len(before)))
    core = CORE * distance.mean(axis=1, keepdims=True)
    w = weight[near] / np.maximum(distance * distance + core * core, np.finfo(float).tiny)
    w /= w.sum(axis=1, keepdims=True)
    p, q = before[near], after[near]
    p_mean, q_mean = (w[:, :, None] * p).sum(axis=1), (w[:, :, None] * q).sum(axis=1)
    p, q = p - p_mean[:, None], q - q_mean[:, None]
    size = np.maximum((w * (p * p).sum(axis=2)).sum(axis=1), np.finfo(float).tiny)
    cosine = (w * (p * q).sum(axis=2)).sum(axis=1) / size
    sine = (w * (p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])).sum(axis=1) / size
    x, y = (cage - p_mean).T
    moved: FloatArray = q_mean + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)
    return moved
