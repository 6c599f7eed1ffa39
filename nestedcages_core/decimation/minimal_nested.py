"""Minimal nested polygons: few edges around a loop within a distance of it, and a lower bound on their number.

A gate is a segment from a point of the fine loop (its foot) straight outwards to a point farther from the fine mesh
than the distance (its tip). Gates do not cross, so a cage's loop within the distance meets them in their order, and
each of its edges meets a run of consecutive gates, with their feet on its left and their tips on its right. A run
whose feet and tips cannot be separated by a line needs more than one edge, so the smallest number of separable runs
that cover all gates is a lower bound. A greedy walk of longest edges through the same gates gives a polygon. Between
convex loops it has at most one vertex too many (Aggarwal, Booth, O'Rourke, Suri, Yap 1989; for simple polygons see Suri
& O'Rourke 1985, Ghosh & Maheshwari 1990, whose edges start from whole segments).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.signed_distance import SignedDistance
from ..geometry.vectors import cross, norm, rotated_left, rotated_right
from .base import LEAST_PER_LOOP
from .clearing import CLEARANCE_RESERVE

FIRST_GATES, MAX_GATES = 192, 1024
"""First and maximum number of gates of a loop."""

GATES_PER_LINK = 20
"""Wanted number of gates per edge; the bound may lose one of them."""

FAN_STEP = 0.1
"""Largest turn, in radians, between gates at a convex corner."""

RELAXED = 1e-6
"""Relative excess length of the gates of the bound over the distance, against rounding."""

RESERVE = 1e-3
"""Relative shortening of the gates of the walk."""

FIRST_WINDOW = 32
"""First number of gates tested for a run; doubled where a run is longer."""

ANGLE_SLACK = 1e-9
"""Radians by which a line may miss a gate before a run counts as too long; above the rounding of angles."""

WALKS = 32
"""Number of gates of a loop at which a walk starts."""


@dataclass(frozen=True, eq=False)
class Gates:
    """Gates of one loop, in its order: feet (N, 2) on the loop, and unit normals (N, 2)."""

    foot: FloatArray
    normal: FloatArray

    def ends(self, low: float, high: float) -> tuple[FloatArray, FloatArray]:
        """The gates' points at two distances from the loop, (N, 2), (N, 2)."""
        return self.foot + low * self.normal, self.foot + high * self.normal


def gates(fine: Mesh, loop: int, distance: float, count: int) -> Gates:
    """About ``count`` gates of a loop of the fine mesh; none where other parts of the mesh are closer."""
    ring = fine.loops[loop]
    points = fine.vertices[ring]
    steps = np.roll(points, -1, axis=0) - points
    lengths = norm(steps)
    normal = rotated_right(steps) / lengths[:, None]
    before = np.roll(normal, 1, axis=0)
    turn = np.arctan2(cross(before, normal), (before * normal).sum(axis=1))
    # evenly spaced along the offset curve: places and normals change by the same amount per gate
    spacing = float((lengths + distance * np.maximum(turn, 0.0)).sum()) / count
    feet, normals = [], []
    for k in range(len(ring)):
        if turn[k] > 0.0:
            angle = turn[k] * _parts(max(distance * turn[k] / spacing, turn[k] / FAN_STEP))
            cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
            normals.append(cosine * before[k] + sine * rotated_left(before[k]))
            feet.append(np.broadcast_to(points[k], normals[-1].shape))
        part = _parts(lengths[k] / spacing)
        feet.append(points[k] + part[:, None] * steps[k])
        normals.append(np.broadcast_to(normal[k], (len(part), 2)))
    foot, out = np.concatenate(feet), np.concatenate(normals)
    if len(foot) > MAX_GATES:
        chosen = np.unique(np.linspace(0, len(foot), MAX_GATES, endpoint=False).astype(np.int64))
        foot, out = foot[chosen], out[chosen]
    reach = SignedDistance.of(fine).at(foot + (1.0 + RELAXED) * distance * out).distance
    free = reach > (1.0 + 0.5 * RELAXED) * distance
    return Gates(foot[free], out[free])


def _parts(pieces: float) -> FloatArray:
    """The middles of equal parts of the unit interval, about ``pieces`` of them and at least one."""
    number = max(1, round(pieces))
    return (np.arange(number) + 0.5) / number


def fewest_links(fine: Mesh, loop: int, distance: float, clearance: float) -> int:
    """Lower bound on the vertices of a cage's loop that stays within a distance of its fine loop."""
    links = _fewest_runs(gates(fine, loop, distance, FIRST_GATES), distance, clearance)
    if GATES_PER_LINK * links > FIRST_GATES:
        more = gates(fine, loop, distance, min(GATES_PER_LINK * links, MAX_GATES))
        links = max(links, _fewest_runs(more, distance, clearance))
    return links


def _fewest_runs(found: Gates, distance: float, clearance: float) -> int:
    """The smallest number of runs that cover the circle, by leaps from every gate at once; at least 3."""
    count = len(found.foot)
    if count < LEAST_PER_LOOP:
        return LEAST_PER_LOOP
    run = _longest_runs(*found.ends(clearance, (1.0 + RELAXED) * distance))
    place, links = np.arange(count), np.zeros(count, dtype=np.int64)
    goal = place + count
    while (going := place < goal).any():
        place[going] += run[place[going] % count]
        links[going] += 1
    return max(LEAST_PER_LOOP, int(links.min()))


def _longest_runs(feet: FloatArray, tips: FloatArray) -> IntArray:
    """(N,) number of gates from each one on, in circular order, whose feet (N, 2) and tips (N, 2) a line separates.

    With n from tip to foot, a line separates where n · (foot_k - tip_l) ≥ 0 for all k and l: each pair allows half a
    circle of normals around the direction of its difference.
    """
    count = len(feet)
    runs = np.zeros(count, dtype=np.int64)
    window = min(FIRST_WINDOW, count)
    for start in range(count):
        while True:
            k = (start + np.arange(window)) % count
            along = feet[k][:, None] - tips[k][None, :]
            turned = along @ np.array([[feet[start] - tips[start]], [rotated_right((feet - tips)[start])]])[:, 0].T
            angle = np.arctan2(turned[..., 1], turned[..., 0])
            highest = np.maximum.accumulate(np.maximum(_corner(angle), _corner(angle.T)))
            lowest = np.minimum.accumulate(np.minimum(-_corner(-angle), -_corner(-angle.T)))
            apart = highest - lowest > np.pi + ANGLE_SLACK
            length = int(apart.argmax()) if apart.any() else window
            if length < window or window == count:
                break
            window = min(2 * window, count)
        runs[start] = max(1, length)
    return runs


def _corner(values: FloatArray) -> FloatArray:
    """(W,) largest value of each row up to the diagonal."""
    largest: FloatArray = np.where(np.tril(np.ones(values.shape, dtype=bool)), values, -np.inf).max(axis=1)
    return largest


def walks(fine: Mesh, loop: int, distance: float, clearance: float) -> list[FloatArray]:
    """Polygons (k, 2) with few edges around a loop, fewest first; to be verified."""
    found = gates(fine, loop, distance, MAX_GATES // 2)
    if len(found.foot) < LEAST_PER_LOOP:
        return []
    low, high = CLEARANCE_RESERVE * clearance, (1.0 - RESERVE) * distance
    if not low < high:
        return []
    feet, tips = found.ends(low, high)
    starts = np.unique(np.linspace(0, len(feet), WALKS, endpoint=False).astype(np.int64))
    found_ones = [_walk(feet, tips, start, side) for side in (tips, feet) for start in starts.tolist()]
    return sorted([polygon for polygon in found_ones if polygon is not None], key=len)


def _walk(feet: FloatArray, tips: FloatArray, start: int, side: FloatArray) -> FloatArray | None:
    """The polygon of longest edges from the tip or the foot of a gate; None if it does not get around."""
    count = len(feet)
    at, place, goal = side[start], start, start + count
    corners = [at]
    while len(corners) <= count:
        ahead = np.arange(place + 1, goal + 1)
        k = ahead % count
        forward = rotated_left(tips[place % count] - feet[place % count])
        axes = np.stack((forward, rotated_left(forward))) / norm(forward)
        left, right = (feet[k] - at) @ axes.T, (tips[k] - at) @ axes.T
        to_feet, to_tips = (np.unwrap(np.arctan2(to[:, 1], to[:, 0])) for to in (left, right))
        upper, lower = np.minimum.accumulate(to_feet), np.maximum.accumulate(to_tips)
        blocked = upper < lower
        if not blocked.any():
            last = (to_tips if side is tips else to_feet)[-1]  # towards the first corner
            closes = lower[-1] - ANGLE_SLACK <= last <= upper[-1] + ANGLE_SLACK
            return np.array(corners) if closes and len(corners) >= LEAST_PER_LOOP else None
        j = int(blocked.argmax())
        if j == 0:
            return None
        by_outside = upper[j] == upper[j - 1]
        angle = upper[j - 1] if by_outside else lower[j - 1]
        chain = tips if by_outside else feet
        direction = np.cos(angle) * axes[0] + np.sin(angle) * axes[1]
        one, other = chain[k[j - 1]], chain[k[j]]
        across = float(cross(direction, other - one))
        if across == 0.0:
            return None
        part = min(1.0, max(0.0, float(cross(direction, at - one)) / across))
        at = one + part * (other - one)
        corners.append(at)
        place = int(ahead[j - 1])
    return None
