"""The convex polygon of least area with k edges around points, at a distance from them.

Every edge of it touches the hull of the points, widened by the distance, so the polygon is given by the directions of
its normals. With the support function h, the tangent with the normal at angle θ is n(θ) · x = h(θ), and between two
tangents that are turned by δ the polygon covers, seen from the origin, the area

    T = (h₁ h₂ - ½ (h₁² + h₂²) cos δ) / sin δ.

The area is the sum of T over the corners, so that the best choice from a finite set of tangents is a shortest cycle
with k edges. All but one of the edges of an optimum are flush with edges of the hull (DePano 1987). Edges that are not
are represented by some tangents at each vertex of the hull, which are then turned until the middle of the edge touches.
With the cheapest cycle through one tangent, the best of all has an edge between each two consecutive ones of it, since
T obeys the quadrangle inequality (Aggarwal, Chang & Yap 1985).
"""

from __future__ import annotations

from itertools import product

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.group import Symmetry
from ...geometry.precision import INPUT_ROUND_OFF, MOST_HALVINGS, MOST_ROUNDS, NEGLIGIBLE, ROUND_OFF
from ...geometry.shortest_cycle import shortest_cycle
from ...geometry.vectors import rotated_left
from .hull import Hull, Tangents, corner

STARTS = 6
"""Number of tangents that first polygons go through: where edges are not flush, several are nearly the best."""


def least_polygon(hull: Hull, count: int) -> Tangents | None:
    """The polygon of least area with ``count`` edges around a hull; None where walls leave none."""
    candidates = hull.candidates()
    costs = hull.sector(Tangents(*(part[:, None] for part in candidates)), candidates)
    starts = np.linspace(0, len(costs), STARTS, endpoint=False).astype(np.int64)
    found: dict[bytes, Tangents] = {}
    for start in np.unique(starts).tolist():
        cycle = _through(costs, start, count)
        if cycle is not None:
            better = _in_windows(costs, cycle)
            best = np.sort(cycle if better is None else better)
            found[best.tobytes()] = candidates.take(best)
    return min((_turned_to_touch(hull, each) for each in found.values()), key=hull.area, default=None)


def _through(costs: FloatArray, start: int, count: int) -> IntArray | None:
    """(count,) the cheapest cycle through one tangent, once around; None if there is none."""
    order = (start + np.arange(len(costs))) % len(costs)
    found = _cheapest(_only_first(len(costs)), _later(costs[np.ix_(order, order)]), costs[order, start], count)
    return None if found is None else order[found[1]]


def _in_windows(costs: FloatArray, bounds: IntArray) -> IntArray | None:
    """(k,) the cheapest cycle with one tangent from each window between consecutive bounds (k,), both included."""
    size = len(costs)
    widths = np.mod(np.roll(bounds, -1) - bounds, size)
    windows = [(begin + np.arange(width + 1)) % size for begin, width in zip(bounds.tolist(), widths, strict=True)]
    picked = shortest_cycle(
        [costs[np.ix_(one, other)] for one, other in zip(windows, [*windows[1:], windows[0]], strict=True)]
    )
    if picked is None:
        return None
    return np.array([window[k] for window, k in zip(windows, picked, strict=True)])


def _turned_to_touch(hull: Hull, tangents: Tangents) -> Tangents:
    """The polygon with edges turned one by one, as long as the area shrinks."""
    angles = tangents.angle.copy()
    breaks = np.unique(np.mod(hull.flush, 2.0 * np.pi))
    for _ in range(MOST_ROUNDS):
        before = hull.area(hull.tangents(angles))
        for k in range(len(angles)):
            if not _rests(hull, hull.tangents(angles), k):
                angles[k] = _best_turn(hull, angles, k, breaks)
        if before - hull.area(hull.tangents(angles)) <= INPUT_ROUND_OFF * before:
            break
    return hull.tangents(angles)


def _rests(hull: Hull, tangents: Tangents, k: int) -> bool:
    """Whether the middle of an edge lies on an edge of the offset hull, so that turning it costs area."""
    around = tangents.take(np.array([k - 1, k, (k + 1) % len(tangents.angle)]))
    ends = corner(around.take(np.array([0, 1])), around.take(np.array([1, 2])))
    normal = np.array([np.cos(around.angle[1]), np.sin(around.angle[1])])
    touching = np.abs(hull.corners @ normal + hull.distance - around.support[1]) <= 1e-12 * np.abs(around.support[1])
    along = hull.corners[touching] @ rotated_left(normal)
    middle = 0.5 * (ends[0] + ends[1]) @ rotated_left(normal)
    return len(along) > 1 and bool(along.min() <= middle <= along.max())


def _best_turn(hull: Hull, angles: FloatArray, k: int, breaks: FloatArray) -> float:
    """The angle of edge k, at the corners of the hull that it touches, with the least area between its neighbours."""
    before, after = angles[k - 1], angles[(k + 1) % len(angles)]
    neighbours = hull.tangents(np.array([before, after]))

    def area(angle: FloatArray) -> FloatArray:
        turned = hull.tangents(np.asarray(angle))
        one = Tangents(neighbours.angle[:1], neighbours.support[:1])
        other = Tangents(neighbours.angle[1:], neighbours.support[1:])
        return hull.sector(one, turned) + hull.sector(turned, other)

    here = float(angles[k])
    distance = np.mod(breaks - here, 2.0 * np.pi)
    ahead = here + distance[distance > ROUND_OFF].min()
    behind = here - np.mod(-distance, 2.0 * np.pi)[distance > ROUND_OFF].min()
    behind = max(behind, here - np.mod(here - before, 2.0 * np.pi) + 2.0 * ROUND_OFF)
    ahead = min(ahead, here + np.mod(after - here, 2.0 * np.pi) - 2.0 * ROUND_OFF)
    low, high = np.array([behind, here]), np.array([here, ahead])
    tried = [low.copy(), high.copy()]
    golden, widest = 0.5 * (np.sqrt(5.0) - 1.0), NEGLIGIBLE * (high - low)
    for _ in range(MOST_HALVINGS):
        if not (high - low > widest).any():  # areas are exact to the square of that
            break
        one, other = high - golden * (high - low), low + golden * (high - low)
        left = area(one) < area(other)
        low, high = np.where(left, low, one), np.where(left, other, high)
    places = np.concatenate([[here], *tried, 0.5 * (low + high)])
    return float(places[area(places).argmin()])


ZOOMS, NEIGHBOURS = 4, 8
"""Searches among tangents next to the last polygon, and their number on each side, up to the neighbours before."""


def symmetric_polygon(hull: Hull, count: int, group: Symmetry) -> Tangents | None:
    """The polygon with ``count`` edges around a hull with the symmetries of a group; None where walls leave none.

    With rotations of order r, the polygon repeats a path of k / r tangents that ends at the image of its first one.
    With a mirror, it is a path over a half turn and its image; at each end there is a corner on the axis or an edge
    across it.
    """
    x, y = group.about_origin().image(np.array([1.0, 0.0]))
    turn = float(np.arctan2(y, x))  # twice the angle of the axis, or that of a rotation
    best, angles, spread = None, hull.candidates().angle, 2.0 * np.pi / len(hull.candidates().angle)
    for _ in range(1 + ZOOMS):
        found = _mirrored(hull, angles, count, turn) if group.reverses else _turned(hull, angles, count, group.order)
        if found is None:
            break
        best = found if best is None or hull.area(found) < hull.area(best) else best
        near = spread * np.arange(-NEIGHBOURS, NEIGHBOURS + 1) / NEIGHBOURS
        angles, spread = np.unique(np.mod(best.angle[:, None] + near, 2.0 * np.pi)), spread / NEIGHBOURS
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
        found = _cheapest(_only_first(len(here)), _ahead(hull, inside), hull.sector(inside, back), count // order)
        if found is not None and (best is None or found[0] < best[0]):
            best = found[0], here[found[1]]
    if best is None:
        return None
    return hull.tangents((best[1] + sector * np.arange(order)[:, None]).ravel())


def _starts(hull: Hull, angles: FloatArray, count: int, sector: float) -> list[int]:
    """Tangents of which the best polygon has one: those from one of a polygon through the first to the next of it."""
    inside, back = hull.tangents(angles), hull.tangents(angles[:1] + sector)
    found = _cheapest(_only_first(len(angles)), _ahead(hull, inside), hull.sector(inside, back), count)
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
    return _later(hull.sector(Tangents(*(part[:, None] for part in tangents)), tangents))


def _later(costs: FloatArray) -> FloatArray:
    """(N, N) costs to later ones; infinite to others."""
    return np.where(np.triu(np.ones(costs.shape, bool), 1), costs, np.inf)


def _only_first(count: int) -> FloatArray:
    """(count,) costs to begin with the first one."""
    return np.where(np.arange(count) == 0, 0.0, np.inf)


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
