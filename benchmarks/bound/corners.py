"""Moves of edges that touch a vertex: to another such edge over a corner, to and from a vertex on the outline."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .nodes import CORNER, ENTER, LEAVE, Nodes
from .outline import FULL, LOWER, WIDER, ranges

SMALLEST_SINE = 1e-15
STRAIGHT = 1e-9
"""Radians below half a turn up to which the area of a triangle is computed."""
CHUNK = 2_000_000
"""Pairs of cells and vertices that are looked at in one go."""


class Moves(NamedTuple):
    """Moves between nodes, and lower bounds of the area between cage and outline that they enclose."""

    source: np.ndarray
    target: np.ndarray
    area: np.ndarray

    @classmethod
    def joined(cls, parts: list[Moves]) -> Moves:
        """All of some moves."""
        return cls(*(np.concatenate([part[k] for part in parts]) for k in range(3)))

    def take(self, which: np.ndarray) -> Moves:
        """Some of them."""
        return Moves(self.source[which], self.target[which], self.area[which])


def over_corners(nodes: Nodes, source: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Least areas of moves between cells of edges; infinite where there is no such corner.

    With the chord c between contacts and angles x, y between it and both lines, contacts and corner make a triangle of
    ½ c² sin x sin y / sin(x + y), which grows with both angles; the corner lies at c sin y / sin(x + y).
    """
    outline, a, b = nodes.outline, nodes.at[source], nodes.at[target]
    area = np.full(len(source), np.inf)
    same = a == b
    area[same & (nodes.low[source] <= nodes.low[target])] = 0.0
    which = np.flatnonzero(~same)
    source, target, a, b = source[which], target[which], a[which], b[which]
    chord = outline.points[b] - outline.points[a]
    wraps = b < a
    pocket = outline.pocket(outline.points[a], outline.swept[a], outline.points[b], outline.swept[b], wraps)
    half_a, half_b = (0.5 * (nodes.high[k] - nodes.low[k]) for k in (source, target))
    middle_a, middle_b = (0.5 * (nodes.high[k] + nodes.low[k]) for k in (source, target))
    # the corner turns by as much as the outline between the contacts, as the piece between them is simple
    turn = outline.turned[b] + middle_b - outline.turned[a] - middle_a + FULL * wraps
    angle = np.arctan2(chord[:, 1], chord[:, 0]) - outline.before[a] - middle_a
    angle = (angle + np.pi) % FULL - np.pi
    length, reaches = np.hypot(*chord.T), (nodes.reach[0, source], nodes.reach[1, target])
    least = np.full(len(which), np.inf)
    possible = np.abs(turn) <= np.pi + half_a + half_b + WIDER
    for wound in (0.0, FULL, -FULL):
        x, y = angle + wound, turn - angle - wound
        k = np.flatnonzero(possible & (np.abs(x) <= np.pi + half_a + WIDER) & (np.abs(y) <= np.pi + half_b + WIDER))
        x_ends, y_ends = ((m[k] - h[k] - WIDER, m[k] + h[k] + WIDER) for m, h in ((x, half_a), (y, half_b)))
        least[k] = np.minimum(least[k], _corner(length[k], pocket[k], x_ends, y_ends, (reaches[0][k], reaches[1][k])))
    area[which] = np.where(least < np.inf, np.maximum(least, 0.0), np.inf)
    return area


Ends = tuple[np.ndarray, np.ndarray]


def _corner(length: np.ndarray, pocket: np.ndarray, x: Ends, y: Ends, reach: Ends) -> np.ndarray:
    """Least area over intervals of both angles: of a corner right of the chord (both positive), or left of it."""
    least = np.full(len(length), np.inf)
    for right in (True, False):
        x1, x2, y1, y2 = (*x, *y) if right else (-x[1], -x[0], -y[1], -y[0])
        there = (x2 >= 0.0) & (y2 >= 0.0) & (x1 <= np.pi) & (y1 <= np.pi)
        x1, y1, x2, y2 = np.maximum(x1, 0.0), np.maximum(y1, 0.0), np.minimum(x2, np.pi), np.minimum(y2, np.pi)
        there &= (x1 + y1 < np.pi) & (reach[0] + reach[1] >= length)
        with np.errstate(all="ignore"):
            there &= ~(length * np.sin(y1) > reach[0] * _largest_sine(x1 + y1, x2 + y1))
            there &= ~(length * np.sin(x1) > reach[1] * _largest_sine(x1 + y1, x1 + y2))
            small = _triangle(length, x1, y1)
            large = np.where(x2 + y2 < np.pi - STRAIGHT, _triangle(length, x2, y2), np.inf)
            for far, first, last in ((reach[0], x1, x2), (reach[1], y1, y2)):
                limit = 0.5 * length * far * _largest_sine(first, last)
                large = np.fmin(large, limit)
        area, most = (pocket + small, pocket + large) if right else (pocket - large, pocket - small)
        least = np.where(there & (most >= -LOWER), np.minimum(least, area), least)
    return least


def _triangle(length: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.asarray(0.5 * length**2 * np.sin(x) * np.sin(y) / np.maximum(np.sin(x + y), SMALLEST_SINE))


def _largest_sine(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Over intervals in [0, π]; what is beyond π is cut off."""
    last = np.minimum(last, np.pi)
    ends = np.maximum(np.sin(np.clip(first, 0.0, np.pi)), np.sin(last))
    return np.where((first <= 0.5 * np.pi) & (last >= 0.5 * np.pi), 1.0, ends)


def onto_outline(nodes: Nodes, below: float) -> Moves:
    """Moves between edges and cage vertices on the outline, of less area than something."""
    parts = [*_to_edges(nodes), *_to_vertices(nodes)]
    found = Moves.joined(parts)
    return Moves(found.source, found.target, np.maximum(found.area, 0.0)).take(found.area < below)


def _to_edges(nodes: Nodes) -> Iterator[Moves]:
    """An edge ends in a cage vertex inside an edge of the outline that it sees, or begins in one."""
    outline = nodes.outline
    for ahead, kind, seen in ((True, ENTER, nodes.ahead), (False, LEAVE, nodes.behind)):
        there = np.flatnonzero(nodes.kind == kind)
        there = there[np.argsort(nodes.at[there], kind="stable")]
        place = nodes.at[there]
        row, k = ranges(np.searchsorted(place, seen.edge), np.searchsorted(place, seen.edge, "right"))
        k = there[k]
        low, high = np.maximum(nodes.low[k], seen.low[row]), np.minimum(nodes.high[k], seen.high[row])
        meet = low <= high
        row, k, low, high = row[meet], k[meet], low[meet], high[meet]
        cell, edge = nodes.edges[seen.cell[row]], seen.edge[row]
        a = nodes.at[cell]
        contact, swept = outline.points[a], outline.swept[a]
        areas = []
        for parameter in (low, high):
            point, to = outline.on(edge, parameter)
            areas.append(outline.pocket(contact, swept, point, to, edge < a) if ahead
                         else outline.pocket(point, to, contact, swept, a <= edge))  # fmt: skip
        possible = np.maximum(*areas) >= -LOWER
        found = Moves(cell, k, np.minimum(*areas)) if ahead else Moves(k, cell, np.minimum(*areas))
        yield found.take(possible)


def _to_vertices(nodes: Nodes) -> Iterator[Moves]:
    """An edge ends or begins in a cage vertex on a vertex of the outline that it can reach, its contact included."""
    outline, n = nodes.outline, len(nodes.outline)
    node = np.full(n, -1)
    corners = np.flatnonzero(nodes.kind == CORNER)
    node[nodes.at[corners]] = corners
    step = 1 + CHUNK // n
    for ahead in (True, False):
        for begin in range(0, len(nodes.edges), step):
            cell = nodes.edges[begin : begin + step]
            a = nodes.at[cell]
            away = outline.points[None] - outline.points[a][:, None]
            angle = np.arctan2(away[..., 1], away[..., 0]) - (0.0 if ahead else np.pi) - outline.before[a][:, None]
            angle = (angle + LOWER) % FULL - LOWER
            near = (angle >= nodes.low[cell][:, None] - LOWER) & (angle <= nodes.high[cell][:, None] + LOWER)
            near &= np.hypot(away[..., 0], away[..., 1]) <= nodes.reach[0 if ahead else 1, cell][:, None]
            near |= np.arange(n) == a[:, None]
            row, vertex = np.nonzero(near & (node >= 0))
            cell, a, points, swept = cell[row], a[row], outline.points, outline.swept
            if ahead:
                area = outline.pocket(points[a], swept[a], points[vertex], swept[vertex], vertex < a)
                found = Moves(cell, node[vertex], area)
            else:
                area = outline.pocket(points[vertex], swept[vertex], points[a], swept[a], a < vertex)
                found = Moves(node[vertex], cell, area)
            area[a == vertex] = 0.0
            yield found.take(area >= -LOWER)
