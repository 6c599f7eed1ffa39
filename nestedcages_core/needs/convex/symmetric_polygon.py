"""The convex polygon of least area with k edges and a symmetry, around points that have it.

With rotations of order r, the polygon repeats a path of k / r tangents that ends at the image of its first one. With a
mirror, it is a path over a half turn and its image; at each end there is a corner on the axis or an edge across it.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.group import Symmetry
from .hull import Hull, Tangents

ZOOMS, ZOOM, NEIGHBOURS = 4, 8.0, 8
"""Searches among tangents next to the last polygon, the factor by which they move together each time, and their number
on each side."""


def symmetric_polygon(hull: Hull, count: int, group: Symmetry) -> Tangents | None:
    """The polygon with ``count`` edges around a hull with the symmetries of a group; None where walls leave none."""
    x, y = group.about_origin().image(np.array([1.0, 0.0]))
    turn = float(np.arctan2(y, x))  # twice the angle of the axis, or that of a rotation
    best, angles, spread = None, hull.candidates().angle, 2.0 * np.pi / len(hull.candidates().angle)
    for _ in range(1 + ZOOMS):
        found = _mirrored(hull, angles, count, turn) if group.reverses else _turned(hull, angles, count, group.order)
        if found is None:
            break
        best = found if best is None or hull.area(found) < hull.area(best) else best
        near = spread * np.arange(-NEIGHBOURS, NEIGHBOURS + 1) / NEIGHBOURS
        angles, spread = np.unique(np.mod(best.angle[:, None] + near, 2.0 * np.pi)), spread / ZOOM
    return best


def image_angles(angles: FloatArray, group: Symmetry, element: int) -> FloatArray:
    """Normals (k,) of the image of a polygon under an element, counter-clockwise."""
    normals = group.about_origin().image(np.stack([np.cos(angles), np.sin(angles)], axis=-1), element)
    turned = np.arctan2(normals[:, 1], normals[:, 0])
    return turned[::-1] if group.reverses and element % 2 else turned


def _turned(hull: Hull, angles: FloatArray, count: int, order: int) -> Tangents | None:
    """The best polygon of tangents with normals among angles (N,), all turned by multiples of 360° / order."""
    sector = 2.0 * np.pi / order
    angles = np.unique(np.mod(angles, sector))
    best: tuple[float, FloatArray] | None = None
    for start in _starts(hull, angles, count // order, sector):
        here = angles[start] + np.mod(angles - angles[start], sector)
        here.sort()
        inside, back = hull.tangents(here), hull.tangents(here[:1] + sector)
        first = np.where(np.arange(len(here)) == 0, 0.0, np.inf)
        found = _cheapest(first, _ahead(hull, inside), hull.sector(inside, back), count // order)
        if found is not None and (best is None or found[0] < best[0]):
            best = found[0], here[found[1]]
    if best is None:
        return None
    return hull.tangents((best[1] + sector * np.arange(order)[:, None]).ravel())


def _starts(hull: Hull, angles: FloatArray, count: int, sector: float) -> list[int]:
    """Tangents of which the best polygon has one: those from one of a polygon through the first to the next of it."""
    inside, back = hull.tangents(angles), hull.tangents(angles[:1] + sector)
    first = np.where(np.arange(len(angles)) == 0, 0.0, np.inf)
    found = _cheapest(first, _ahead(hull, inside), hull.sector(inside, back), count)
    if found is None or count == 1:
        return list(range(len(angles)))
    ends = [*found[1].tolist(), len(angles)]
    window = min(range(count), key=lambda k: ends[k + 1] - ends[k])
    return list(range(ends[window], min(ends[window + 1], len(angles) - 1) + 1))


def _mirrored(hull: Hull, angles: FloatArray, count: int, turn: float) -> Tangents | None:
    """The best polygon of tangents with normals among angles (N,) and their images by a mirror along ``turn`` / 2."""
    axis = 0.5 * turn
    half = np.unique(axis + np.mod(np.concatenate([angles, turn - angles]) - axis, 2.0 * np.pi))
    half = half[(half > axis) & (half < axis + np.pi)]
    one, other = hull.tangents(half), hull.tangents(turn - half)
    ahead = _ahead(hull, one)
    ends = np.array([axis, axis + np.pi])
    first = 0.5 * hull.sector(other, one), hull.sector(hull.tangents(ends[:1]), one)
    last = 0.5 * hull.sector(one, other), hull.sector(one, hull.tangents(ends[1:]))
    best: tuple[float, FloatArray] | None = None
    for across in product((0, 1), (0, 1)):
        steps, odd = divmod(count - sum(across), 2)
        found = None if odd or steps < 1 else _cheapest(first[across[0]], ahead, last[across[1]], steps)
        if found is not None and (best is None or found[0] < best[0]):
            path = half[found[1]]
            parts = [ends[: across[0]], path, ends[1:][: across[1]], turn + 2.0 * np.pi - path[::-1]]
            best = found[0], np.concatenate(parts)
    return None if best is None else hull.tangents(best[1])


def _ahead(hull: Hull, tangents: Tangents) -> FloatArray:
    """(N, N) cost from each of some tangents, by angle, to each later one."""
    costs = hull.sector(Tangents(*(part[:, None] for part in tangents)), tangents)
    return np.where(np.triu(np.ones(costs.shape, bool), 1), costs, np.inf)


def _cheapest(first: FloatArray, costs: FloatArray, last: FloatArray, count: int) -> tuple[float, IntArray] | None:
    """The cheapest path over ``count`` nodes, with costs to begin (N,), to go on (N, N) and to end (N,)."""
    least, back = first, []
    for _ in range(count - 1):
        through = least[:, None] + costs
        back.append(through.argmin(axis=0))
        least = through.min(axis=0)
    closed = least + last
    node = int(closed.argmin()) if len(closed) else -1
    if node < 0 or not np.isfinite(closed[node]):
        return None
    path, cost = [node], float(closed[node])
    for before in back[::-1]:
        path.append(int(before[path[-1]]))
    return cost, np.array(path[::-1])
