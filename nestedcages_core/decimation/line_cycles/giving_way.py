"""Where edges of the chosen cycles cross, one of the two is shortened, and so are the lines around it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.vectors import cross
from .crossings import Choice, Search
from .turns import SLACK

SHORTENED = 0.999
"""Fraction of the distance to the crossing that stays free."""


def give_way(searches: Mapping[int, Search], choice: Choice, i: IntArray, j: IntArray, bias: float) -> set[int]:
    """Shorten what is free of the lines of crossing edges where they meet the other edge; the loops that changed.

    Of each pair, the edge whose contact is farther from the crossing is shortened. bias: factor on the distance of the
    first one. The candidates between its neighbours in the cycle are shortened with it.
    """
    changed = set()
    for a, b in zip(i.tolist(), j.tolist(), strict=True):
        sine = float(cross(choice.direction[a], choice.direction[b]))
        if sine == 0.0:
            continue
        step = choice.point[b] - choice.point[a]
        s, t = float(cross(step, choice.direction[b])) / sine, float(cross(step, choice.direction[a])) / sine
        if abs(s) * bias > abs(t):
            a, b, s = b, a, t
        loop, element = (int(choice.loop[b]), 0) if choice.images is None else choice.images.loops[choice.loop[b]]
        blocking = np.stack((choice.point[a], choice.end[a] if s > 0.0 else choice.start[a]))
        if choice.images is not None and element:
            blocking = choice.images.points(blocking, choice.images.symmetry.order - element)
        _shorten(searches[loop], _bundle(searches[loop], choice, a, b), *blocking)
        searches[loop].share()
        changed.add(loop)
    return changed


def _bundle(search: Search, choice: Choice, a: int, b: int) -> IntArray:
    """The lines between those before and after edge b in its cycle, without that of edge a."""
    own = np.flatnonzero(choice.loop == choice.loop[b])
    at = b - int(own[0])
    low, high = int(choice.line[own[at - 1]]), int(choice.line[own[(at + 1) % len(own)]])
    if choice.images is not None and choice.images.reverses(choice.images.loops[choice.loop[b]][1]):
        low, high = high, low
    count = len(search.lines)
    bundle = np.mod(low + 1 + np.arange((high - low - 1) % count), count)
    return bundle[bundle != choice.line[a]] if choice.loop[a] == choice.loop[b] else bundle


def _shorten(search: Search, bundle: IntArray, start: FloatArray, end: FloatArray) -> None:
    """End what is free of some lines at a segment."""
    point, direction = search.lines.point[bundle], search.lines.direction[bundle]
    before, after = cross(direction, start - point), cross(direction, end - point)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = start + (before / (before - after))[:, None] * (end - start)
        along = ((crossing - point) * direction).sum(axis=1)
    met = (before > 0.0) != (after > 0.0)
    for way, sign in ((0, 1.0), (1, -1.0)):
        some = met & (sign * along > 0.0)
        k = bundle[some]
        search.free[way, k] = np.minimum(search.free[way, k], SHORTENED * np.abs(along[some]) - SLACK)
