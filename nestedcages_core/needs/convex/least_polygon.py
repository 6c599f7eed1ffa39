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

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.precision import INPUT_ROUND_OFF, ROUND_OFF
from ...geometry.shortest_cycle import shortest_cycle
from ...geometry.vectors import rotated_left
from .hull import Hull, Tangents, corner

STARTS = 6
"""Number of tangents that first polygons go through: where edges are not flush, several are nearly the best."""

MAX_SWEEPS = 20
"""Maximum number of sweeps over all edges: more take seconds, for gains of less than 1e-9 each."""

GOLDEN_STEPS = 30
"""Steps of golden-section search: intervals are 1e-6 of the first one then, and areas exact to its square."""


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
    return min((_turned(hull, each) for each in found.values()), key=hull.area, default=None)


def _through(costs: FloatArray, start: int, count: int) -> IntArray | None:
    """(count,) the cheapest cycle through one tangent, once around; None if there is none."""
    size = len(costs)
    order = (start + np.arange(size)) % size
    ahead = np.triu(np.ones((size, size), bool), 1)
    forward = np.where(ahead, costs[np.ix_(order, order)], np.inf)
    least = np.full(size, np.inf)
    least[0] = 0.0
    back: list[IntArray] = []
    for _ in range(count - 1):
        through = least[:, None] + forward
        back.append(through.argmin(axis=0))
        least = through.min(axis=0)
    closing = least + costs[order, start]
    place = int(closing.argmin())
    if not np.isfinite(closing[place]):
        return None
    cycle = [place]
    for before in back[::-1]:
        place = int(before[place])
        cycle.append(place)
    places: IntArray = order[np.array(cycle[::-1])]
    return places


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


def _turned(hull: Hull, tangents: Tangents) -> Tangents:
    """The polygon with edges turned one by one, as long as the area shrinks."""
    angles = tangents.angle.copy()
    breaks = np.unique(np.mod(hull.flush, 2.0 * np.pi))
    for _ in range(MAX_SWEEPS):
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
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    for _ in range(GOLDEN_STEPS):
        one, other = high - golden * (high - low), low + golden * (high - low)
        left = area(one) < area(other)
        low, high = np.where(left, low, one), np.where(left, other, high)
    places = np.concatenate([[here], *tried, 0.5 * (low + high)])
    return float(places[area(places).argmin()])
