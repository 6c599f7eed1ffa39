"""Loops that touch in points, pulled apart by thin necks to make a valid mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray

NECK_PER_EDGE = 1e-3
"""Distance by which loops that touch in a point are pulled apart there, over the shorter edge at the point."""

MAX_NECK = 1e-6
"""Upper bound of that distance, in diagonals."""


def pulled_apart(rings: Sequence[FloatArray], diagonal: float) -> list[FloatArray]:
    """Loops (k, 2) around the same inside, joined by thin necks where rings touch in a point; others unchanged.

    rings: (k, 2) each, with the inside to their left.
    """
    points, index = np.unique(np.concatenate(rings), axis=0, return_inverse=True)
    corners = index.ravel()
    if len(points) == len(corners):
        return list(rings)
    sizes = np.array([len(ring) for ring in rings])
    ends = np.arange(len(corners)) + 1
    ends[np.cumsum(sizes) - 1] = np.cumsum(sizes) - sizes
    loops = _linked(points, corners, corners[ends])
    crowded = np.bincount(corners, minlength=len(points)) > 1
    return [_off_its_touching_points(points, loop, crowded, diagonal) for loop in loops]


def _linked(points: FloatArray, tails: IntArray, heads: IntArray) -> list[IntArray]:
    """Loops of indices from directed edges with the inside to their left.

    Where several leave a point the sharpest right turn is taken: a loop then surrounds one empty region.
    """
    leaving: dict[int, list[int]] = {}
    for edge, tail in enumerate(tails.tolist()):
        leaving.setdefault(tail, []).append(edge)
    onward = np.empty(len(tails), dtype=np.int64)
    for edge, head in enumerate(heads.tolist()):
        choices = leaving[head]
        sharpest = 0
        if len(choices) > 1:
            angles = _empty_angle(points, np.full(len(choices), tails[edge]), head, heads[choices])
            sharpest = int(angles.argmin())
        onward[edge] = choices[sharpest]
    loops = []
    seen = np.zeros(len(tails), dtype=bool)
    for first in range(len(tails)):
        loop = []
        edge = first
        while not seen[edge]:
            seen[edge] = True
            loop.append(edge)
            edge = int(onward[edge])
        if loop:
            loops.append(tails[loop])
    return loops


def _empty_angle(points: FloatArray, before: IntArray, at: int | IntArray, after: IntArray) -> FloatArray:
    """Radians in (0, 2π] from the way back around to the way on, on the right of a path through points."""
    back, on = points[before] - points[at], points[after] - points[at]
    turn = np.arctan2(back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0], (back * on).sum(axis=1))
    return np.asarray(np.where(turn > 0.0, turn, turn + 2.0 * np.pi))


def _off_its_touching_points(points: FloatArray, loop: IntArray, crowded: BoolArray, diagonal: float) -> FloatArray:
    """A loop (k, 2), at crowded points pulled into the empty region that it surrounds, so that nothing is cut off."""
    moved = points[loop].copy()
    place = np.flatnonzero(crowded[loop])
    before, at, after = np.roll(loop, 1)[place], loop[place], np.roll(loop, -1)[place]
    back, on = points[before] - points[at], points[after] - points[at]
    half = _empty_angle(points, before, at, after) / 2.0
    length = np.hypot(*back.T)
    along = back / length[:, None]
    reach = np.minimum(NECK_PER_EDGE * np.minimum(length, np.hypot(*on.T)), MAX_NECK * diagonal)[:, None]
    across = np.stack((-along[:, 1], along[:, 0]), axis=1)
    moved[place] += reach * (np.cos(half)[:, None] * along + np.sin(half)[:, None] * across)
    return np.asarray(moved)
