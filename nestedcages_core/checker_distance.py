"""The largest distance of a cage from what it encloses, for `checker`. Points are complex numbers here, in float64."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

PIECES = 1_000_000
"""Number of distances measured at once; bounds the memory."""

NEAREST = 4
"""Number of edges tried as the one that a piece stays close to."""


def farther_than(distance: float, x: Any, after: Any, is_fine: Any, tolerance: float) -> list[str]:
    """A sentence if a point between a fine mesh and a cage around it is farther than a distance from the fine mesh.

    x, after, is_fine: vertices (n, 2) of both, the vertex after each with the solid on the left, and which is fine.
    Vertical lines through all vertices cut this region into trapezoids. The distance to an edge is convex, so on a
    piece it is largest at a corner. Pieces that no edge close by bounds are halved, lengthwise and across in turn.
    """
    start, end, slack = x @ [1.0, 1j], x[after] @ [1.0, 1j], 1.0 + tolerance
    along = end[is_fine] - start[is_fine]
    found = _trapezoids(start, end, is_fine)
    todo = np.array_split(found, 1 + found.size * len(along) // PIECES)
    while todo:
        piece = todo.pop()
        middle = piece.mean(axis=1, keepdims=True)
        gaps = _gap(middle - start[is_fine], along)
        least, near = gaps.min(axis=1), gaps.argsort(axis=1)[:, :NEAREST, None]
        if least.max() > slack * distance:
            place = middle[least.argmax(), 0]
            return [
                f"the cage is farther than {distance:.9g} from the fine mesh near ({place.real:.6g}, {place.imag:.6g})"
            ]
        bound = _gap(piece[:, None] - start[is_fine][near], along[near]).max(axis=2).min(axis=1)
        p, q, r, s = piece[bound > slack**2 * distance].T
        halves = ((p + q) / 2, (r + s) / 2, s, p), (q, r, (r + s) / 2, (p + q) / 2)
        todo += [np.stack(half, axis=1) for half in halves if len(p)]
    return []


def _gap(to: Any, along: Any) -> Any:
    """Distances of points from edges, given the vectors from the starts of the edges."""
    return np.abs(to - along * np.clip((to / along).real, 0.0, 1.0))


def _trapezoids(start: Any, end: Any, is_fine: Any) -> Any:
    """(T, 4) corners of the trapezoids, in order."""
    low, high = np.minimum(start.real, end.real), np.maximum(start.real, end.real)
    pieces = []
    for x in pairwise(np.unique([low, high])):
        k = np.flatnonzero((low <= x[0]) & (high >= x[1]))
        along = end[k] - start[k]
        y = start[k].imag + along.imag * ((np.array(x)[:, None] - start[k].real) / along.real)
        upwards = y.sum(axis=0).argsort()
        left, right = np.array(x)[:, None] + 1j * y[:, upwards]
        sense, of_fine = np.where(along.real > 0.0, 1, -1)[upwards], is_fine[k][upwards]
        m = np.flatnonzero((np.cumsum(sense * ~of_fine) > 0) & (np.cumsum(sense * of_fine) == 0))
        pieces.append(np.stack([left[m], right[m], right[m + 1], left[m + 1]], axis=1))
    return np.concatenate(pieces)
