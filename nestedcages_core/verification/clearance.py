"""The smallest distance between two boundaries: branch and bound over balls around consecutive vertices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._types import FloatArray, IntArray
from ..distance import point_edge

FANOUT = 4
"""Balls that share a parent."""


class Balls(NamedTuple):
    """Balls around vertices of a boundary, each of which covers a stretch of it."""

    centres: FloatArray
    """(N, 2) vertices."""
    radii: FloatArray
    """(N,) lengths."""


def smallest_gap(points: FloatArray, starts: FloatArray, ends: FloatArray) -> float:
    """Smallest distance from points (P, 2) to edges (E, 2) -> (E, 2), each in an order along their boundary.

    Centres are vertices, so every distance measured on the way is an upper bound of the result, and pairs of balls
    that are farther apart than the best one so far are dropped. The cost is that of the stretches in close contact.
    """
    near = _levels(points, np.zeros(len(points)))
    far = _levels(starts, np.hypot(*(ends - starts).T))
    a, b = len(near) - 1, len(far) - 1
    here, there = np.indices((len(near[a].radii), len(far[b].radii)))
    i, j = here.ravel(), there.ravel()
    best = np.inf
    while True:
        reach = near[a].radii[i]
        if b == 0:
            j = np.minimum(j, len(starts) - 1)
            distance = point_edge(near[a].centres[i], starts[j], ends[j]).distance
        else:
            distance = np.hypot(*(near[a].centres[i] - far[b].centres[j]).T)
            reach = reach + far[b].radii[j]
        best = min(best, float(distance.min()))
        if a == 0 and b == 0:
            return best
        keep = distance - reach <= best
        i, j = i[keep], j[keep]
        if b == 0 or (a > 0 and near[a].radii[i].mean() > far[b].radii[j].mean()):
            a -= 1
            i, j = _children(i), np.repeat(j, FANOUT)
        else:
            b -= 1
            i, j = np.repeat(i, FANOUT), _children(j)


def _levels(centres: FloatArray, radii: FloatArray) -> list[Balls]:
    """Balls around single vertices first, then around FANOUT of these each; padded with balls that reach nothing."""
    levels = []
    while len(radii) > FANOUT:
        missing = -len(radii) % FANOUT
        centres = np.concatenate((centres, np.repeat(centres[-1:], missing, axis=0)))
        radii = np.concatenate((radii, np.full(missing, -np.inf)))
        levels.append(Balls(centres, radii))
        groups = centres.reshape(-1, FANOUT, 2)
        middle = groups[:, FANOUT // 2]
        across = groups - middle[:, None]
        centres, radii = middle, (np.hypot(across[..., 0], across[..., 1]) + radii.reshape(-1, FANOUT)).max(axis=1)
    return [*levels, Balls(centres, radii)]


def _children(nodes: IntArray) -> IntArray:
    return (FANOUT * nodes[:, None] + np.arange(FANOUT)).ravel()
