"""A lower bound on the area of all simple polygons of at most m vertices around a loop (docs/method.md, section 5).

In this order: the loop with the areas and sights it gives; cells of what edges and vertices of a cage can be; the least
area that each kind of move between two cells encloses; the cheapest closed walk of at most m vertices; and the search,
which halves the cells on cheap walks until the target is proven or time is up.
"""

from __future__ import annotations

import heapq
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from nestedcages_core import Mesh

# A loop in units of its size, areas between it and chords, and what rays from its convex vertices meet first.

FULL = 2.0 * np.pi
SAME_ANGLE = 1e-13  # radians between two vertices, seen from a third, below which rays between them are not tried
WIDER = 1e-10  # by how many radians all intervals of directions are widened
FARTHER = 1e-7  # by which fraction what a ray reaches is raised
LOWER = 1e-9  # by how much all areas are lowered, in units of the squared size; also a length, in units of the size
PARALLEL = 1e-11  # cross product of a direction and an edge below which no point of intersection is computed


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products of vectors (…, 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def direction(angle: np.ndarray) -> np.ndarray:
    """Unit vectors (…, 2)."""
    return np.stack((np.cos(angle), np.sin(angle)), axis=-1)


def ranges(first: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row and value of all of first … end - 1, row by row."""
    count = np.maximum(end - first, 0)
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)


class Sight(NamedTuple):
    """Intervals of directions from convex vertices within which rays first meet one edge, or none (-1)."""

    vertex: np.ndarray
    low: np.ndarray  # angles from the direction of the edge before the vertex
    high: np.ndarray
    edge: np.ndarray

    @property
    def key(self) -> np.ndarray:
        """Sorted by vertex and angle; angles are below 4."""
        return 4.0 * self.vertex + self.low


class Seen(NamedTuple):
    """What cells of directions see: pieces of edges, and the farthest that a ray of each cell comes."""

    cell: np.ndarray
    edge: np.ndarray
    low: np.ndarray  # parameters of edges
    high: np.ndarray
    reach: np.ndarray  # for each cell


class Outline:
    """A simple loop (n, 2), counter-clockwise."""

    def __init__(self, points: np.ndarray) -> None:
        self.size = float(np.hypot(*np.ptp(points, axis=0)))
        self.points = (points - points.mean(axis=0)) / self.size
        self.edges = np.roll(self.points, -1, axis=0) - self.points
        triangles = 0.5 * cross(self.points, np.roll(self.points, -1, axis=0))
        self.swept = np.concatenate(([0.0], np.cumsum(triangles)))
        self.area = float(self.swept[-1])
        heading = np.arctan2(self.edges[:, 1], self.edges[:, 0])
        self.before = np.roll(heading, 1)
        """Direction of the edge before each vertex."""
        self.turn = (heading - self.before + np.pi) % FULL - np.pi
        self.turned = np.cumsum(self.turn) - self.turn
        """Sum of the turns before each vertex."""
        self.convex = np.flatnonzero(self.turn > 0.0)
        self.sights = self._sight(0.0), self._sight(np.pi)

    def __len__(self) -> int:
        return len(self.points)

    def on(self, edge: np.ndarray, parameter: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (k, 2) of edges, and the area swept about the origin from vertex 0 along the outline to them."""
        points = self.points[edge] + parameter[:, None] * self.edges[edge]
        return points, self.swept[edge] + 0.5 * cross(self.points[edge], points)

    def pocket(
        self, a: np.ndarray, swept_a: np.ndarray, b: np.ndarray, swept_b: np.ndarray, wraps: np.ndarray
    ) -> np.ndarray:
        """Area to the left of chords a-b (k, 2) and outside the outline; wraps: whether they pass vertex 0."""
        return np.asarray(0.5 * cross(a, b) - (swept_b - swept_a + wraps * self.area))

    def _sight(self, back: float) -> Sight:
        vertices, lows, highs, edges = [], [], [], []
        for a in self.convex:
            away, turn = self.points - self.points[a], self.turn[a]
            seen = (np.arctan2(away[:, 1], away[:, 0]) - back - self.before[a]) % FULL
            seen[a] = FULL
            bounds = np.unique(np.concatenate(([0.0], seen[seen < turn], [turn])))
            bounds = bounds[np.concatenate(([True], np.diff(bounds) > SAME_ANGLE))]
            bounds = bounds if len(bounds) > 1 else np.array([0.0, turn])
            ray = direction(self.before[a] + back + 0.5 * (bounds[1:] + bounds[:-1]))[:, None]
            with np.errstate(all="ignore"):
                sine = cross(ray, self.edges[None])
                far, parameter = cross(away, self.edges)[None] / sine, cross(away[None], ray) / sine
            met = (far > 0.0) & (parameter >= -PARALLEL) & (parameter <= 1.0 + PARALLEL)
            met[:, [a - 1, a]] = False
            far = np.where(met, far, np.inf)
            vertices.append(np.full(len(bounds) - 1, a))
            lows.append(bounds[:-1])
            highs.append(bounds[1:])
            edges.append(np.where(np.isfinite(far.min(axis=1)), far.argmin(axis=1), -1))
        return Sight(*map(np.concatenate, (vertices, lows, highs, edges)))

    def seen(self, ahead: bool, vertex: np.ndarray, low: np.ndarray, high: np.ndarray) -> Seen:
        """What rays from vertices, in intervals of directions, meet first: ahead along an edge of a cage, or behind."""
        sight = self.sights[0 if ahead else 1]
        back = 0.0 if ahead else np.pi
        first = np.searchsorted(sight.key, 4.0 * vertex + low - SAME_ANGLE, "right") - 1
        first = np.maximum(first, np.searchsorted(sight.vertex, vertex))
        end = np.searchsorted(sight.key, 4.0 * vertex + high + SAME_ANGLE)
        end = np.clip(end, first + 1, np.searchsorted(sight.vertex, vertex, "right"))
        cell, piece = ranges(first, end)
        edge, origin = sight.edge[piece], self.points[vertex[cell]]
        to = self.points[edge] - origin
        farthest = np.maximum(np.hypot(*to.T), np.hypot(*(to + self.edges[edge]).T))
        ends, reaches = [], []
        for angle, otherwise in ((np.maximum(sight.low[piece], low[cell]), 0.0),
                                 (np.minimum(sight.high[piece], high[cell]), 1.0)):  # fmt: skip
            ray = direction(self.before[vertex[cell]] + angle + back)
            with np.errstate(all="ignore"):
                sine = cross(ray, self.edges[edge])
                parameter, far = cross(to, ray) / sine, cross(to, self.edges[edge]) / sine
            grazing = ~(np.abs(sine) > PARALLEL)
            ends.append(np.where(grazing, otherwise, np.clip(parameter, 0.0, 1.0)))
            reaches.append(np.where(grazing | (far < 0.0) | (far > farthest), farthest, far))
        reach = np.zeros(len(vertex))
        np.maximum.at(reach, cell, np.where(edge < 0, np.inf, np.maximum(*reaches)))
        met = edge >= 0
        low_end, high_end = np.minimum(*ends)[met] - LOWER, np.maximum(*ends)[met] + LOWER
        return Seen(cell[met], edge[met], np.clip(low_end, 0.0, 1.0), np.clip(high_end, 0.0, 1.0),
                    reach * (1.0 + FARTHER) + LOWER)  # fmt: skip


# Nodes: cells of all that an edge or a vertex of a cage can be where it touches the outline.

EDGE, CORNER, ENTER, LEAVE = range(4)
"""Kinds. EDGE: an edge that touches a convex vertex, in an interval of directions. CORNER: a cage vertex on a vertex of
the outline. ENTER, LEAVE: a cage vertex in an interval of an edge of the outline, between an EDGE and a chord, and
between a chord and an EDGE."""


@dataclass(frozen=True, eq=False)
class Nodes:
    """Arrays (N,); angles from the direction of the edge before a vertex, or parameters of an edge."""

    outline: Outline
    kind: np.ndarray
    at: np.ndarray  # vertex or edge of the outline
    low: np.ndarray
    high: np.ndarray

    def __post_init__(self) -> None:
        edges = np.flatnonzero(self.kind == EDGE)
        ahead, behind = (
            self.outline.seen(way, self.at[edges], self.low[edges], self.high[edges]) for way in (True, False)
        )
        reach = np.full((2, len(self.kind)), np.inf)
        reach[0, edges], reach[1, edges] = ahead.reach, behind.reach
        self.__dict__.update(edges=edges, ahead=ahead, behind=behind, reach=reach)

    edges: np.ndarray = None  # type: ignore[assignment]
    """Those of kind EDGE; the next three are about them."""
    ahead: Seen = None  # type: ignore[assignment]
    behind: Seen = None  # type: ignore[assignment]
    reach: np.ndarray = None  # type: ignore[assignment]
    """(2, N) how far an edge comes at most, ahead and behind."""

    @property
    def key(self) -> np.ndarray:
        """Place along the outline: vertices are even, edges odd."""
        return 2 * self.at + (self.kind >= ENTER)

    def ends(self, of: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Both ends of cells of cage vertices on the outline, with the area swept up to them."""
        return [self.outline.on(self.at[of], end[of]) for end in (self.low, self.high)]

    def halved(self, alive: np.ndarray, split: np.ndarray) -> tuple[Nodes, np.ndarray, np.ndarray]:
        """Nodes without the dead, and with some in two; of each old node its first new one and their number."""
        count = np.where(alive, np.where(split, 2, 1), 0)
        first = np.cumsum(count) - count
        kind, at, low, high = (np.repeat(a, count) for a in (self.kind, self.at, self.low, self.high))
        middle = 0.5 * (self.low + self.high)[split]
        high[first[split]], low[first[split] + 1] = middle, middle
        return Nodes(self.outline, kind, at, low, high), first, count


def first_nodes(outline: Outline, per_half_turn: int, pieces: int) -> Nodes:
    """Cells of so many to half a turn, and edges in about so many pieces in all."""
    rows: list[tuple[int, int, float, float]] = []
    for vertex in outline.convex:
        turn = outline.turn[vertex]
        bounds = np.linspace(0.0, turn, 1 + max(1, int(np.ceil(per_half_turn * turn / np.pi))))
        rows += [(EDGE, vertex, *pair) for pair in pairwise(bounds)]
    rows += [(CORNER, vertex, 0.0, 0.0) for vertex in range(len(outline))]
    lengths = np.hypot(*outline.edges.T)
    for edge, length in enumerate(lengths):
        bounds = np.linspace(0.0, 1.0, 1 + max(1, int(np.ceil(pieces * length / lengths.sum()))))
        rows += [(kind, edge, *pair) for kind in (ENTER, LEAVE) for pair in pairwise(bounds)]
    kind, at, low, high = np.array(rows).T
    return Nodes(outline, kind.astype(int), at.astype(int), low, high)


# Moves of edges that touch a vertex: to another such edge over a corner, to and from a vertex on the outline.

SMALLEST_SINE = 1e-15
STRAIGHT = 1e-9  # radians below half a turn up to which the area of a triangle is computed
CHUNK = 2_000_000  # pairs of cells, or of chords and edges, that are looked at in one go


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


# Moves along chords of the outline, between cage vertices on it.

ALLOWED = ((CORNER, CORNER), (CORNER, LEAVE), (ENTER, CORNER), (ENTER, LEAVE))  # kinds of both ends
STRICTLY = 1e-11  # cross product above which a point lies off a line
INWARD = 1e-12  # cross product above which a chord leaves a vertex into the solid
LONGEST_CUT = 4  # most edges of a part of the outline that is tried as a cut through chords
SPARSE = 8  # every so many edges are tried first


def along_chords(nodes: Nodes, source: np.ndarray, target: np.ndarray, below: float) -> np.ndarray:
    """Least areas of chords between two nodes each; infinite where none is outside, or none less than something.

    The area is affine in each end, so it is least and largest for ends of cells.
    """
    outline, f, g = nodes.outline, nodes.at[source], nodes.at[target]
    wraps = nodes.key[target] < nodes.key[source]
    least, most = np.full(len(source), np.inf), np.full(len(source), -np.inf)
    out = np.zeros((2, len(source)), bool)
    from_ends, to_ends = nodes.ends(source), nodes.ends(target)
    for a, swept_a in from_ends:
        for b, swept_b in to_ends:
            area = outline.pocket(a, swept_a, b, swept_b, wraps)
            least, most = np.minimum(least, area), np.maximum(most, area)
            out[0] |= cross(outline.edges[f], b - outline.points[f]) <= LOWER
            out[1] |= cross(outline.edges[g], a - outline.points[g]) <= LOWER
    inside_from, inside_to = nodes.kind[source] != CORNER, nodes.kind[target] != CORNER
    possible = (most >= -LOWER) & (out[0] | ~inside_from) & (out[1] | ~inside_to)
    one_edge = (f == g) & inside_from & inside_to
    possible &= ~one_edge | (nodes.high[target] >= nodes.low[source])
    least = np.maximum(np.where(one_edge, 0.0, least), 0.0)
    possible &= least < below
    for node, other in ((source, to_ends), (target, from_ends)):
        possible &= ~_into_solid(nodes, node, other)
    which = np.flatnonzero(possible)
    for edges in (np.arange(0, len(outline), SPARSE), np.arange(len(outline))):
        which = which[~_cut(nodes, source[which], target[which], edges)]
    found = np.full(len(source), np.inf)
    found[which] = least[which]
    return found


def _into_solid(nodes: Nodes, node: np.ndarray, other: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Whether all chords leave a vertex of the outline into the solid."""
    outline, vertex = nodes.outline, nodes.at[node]
    left = np.ones((2, len(node)), bool)
    for point, _ in other:
        for side, edge in enumerate((outline.edges[vertex - 1], outline.edges[vertex])):
            left[side] &= cross(edge, point - outline.points[vertex]) > INWARD
    inward = np.where(outline.turn[vertex] > 0.0, left[0] & left[1], left[0] | left[1])
    return np.asarray(inward & (nodes.kind[node] == CORNER))


def _cut(nodes: Nodes, source: np.ndarray, target: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Whether a part of the outline, which starts at one of some edges, cuts all chords between two nodes each.

    Its ends lie on either side of all chords, and no chord ends on it. So the parity of its crossings with a chord is
    the same for all of them; it is odd for one.
    """
    outline, n = nodes.outline, len(nodes.outline)
    found = np.zeros(len(source), bool)
    lengths = range(1, LONGEST_CUT + 1) if len(edges) == n else (1,)
    vertices = np.unique((edges[:, None] + np.arange(lengths[-1] + 1)).ravel() % n) if len(edges) < n else edges
    place = np.full(n, -1)
    place[vertices] = np.arange(len(vertices))
    step = 1 + CHUNK // len(vertices)
    for begin in range(0, len(source), step):
        s, t = source[begin : begin + step], target[begin : begin + step]
        left, right = np.ones((2, len(s), len(vertices)), bool)
        from_ends, to_ends = nodes.ends(s), nodes.ends(t)
        for a, _ in from_ends:
            for b, _ in to_ends:
                to = outline.points[vertices][None] - a[:, None]
                height = cross((b - a)[:, None], to)
                left &= height > STRICTLY
                right &= height < -STRICTLY
        a, b = from_ends[0][0], to_ends[0][0]  # of one chord
        height = cross((b - a)[:, None], outline.points[vertices][None] - a[:, None])
        after = place[(edges + 1) % n]
        one, other = height[:, place[edges]], height[:, after]
        u = cross(outline.edges[edges][None], a[:, None] - outline.points[edges][None])
        v = cross(outline.edges[edges][None], b[:, None] - outline.points[edges][None])
        sure = (np.minimum(np.abs(one), np.abs(other)) > STRICTLY) & (np.minimum(np.abs(u), np.abs(v)) > STRICTLY)
        crossed = (one * other < 0.0) & (u * v < 0.0)
        free = np.ones((len(s), n), bool)  # of both ends: whether an edge, ends included, holds none
        rows = np.arange(len(s))
        for node in (s, t):
            for near in (-1, 0, 1):
                inside = nodes.kind[node] != CORNER
                free[rows, (nodes.at[node] + near * (inside | (near < 1))) % n] = False
        odd, certain = np.zeros_like(crossed), np.ones_like(crossed)
        for length in lengths:
            shift = length - 1
            odd ^= np.roll(crossed, -shift, axis=1)
            certain &= np.roll(sure & free[:, edges], -shift, axis=1)
            ends = place[(edges + length) % n]
            begins = place[edges]
            apart = (left[:, begins] & right[:, ends]) | (right[:, begins] & left[:, ends])
            found[begin : begin + step] |= (apart & odd & certain).any(axis=1)
    return found


# The cheapest closed walk once around the outline with at most m cage vertices, and the moves of all cheap ones.

FEWEST_GROUPS, MOST_GROUPS, WORK = 24, 400, 4e7
"""Groups of first nodes that are searched at once: bounds, and moves times groups."""


class Cheap(NamedTuple):
    """What a search found."""

    least: float  # lower bound on the area of all closed walks
    moves: np.ndarray  # (K,) whether a move can be on a walk below the threshold
    through: np.ndarray  # (N,) lower bound on walks through a node


class Layers:
    """Moves sorted for min-plus products, apart by the cage vertices that they cost, 0 or 1."""

    def __init__(self, moves: Moves, cost: np.ndarray, head: np.ndarray, tail: np.ndarray) -> None:
        order = np.argsort(head, kind="stable")
        self.parts = []
        for price in (0, 1):
            of = order[cost[order] == price]
            heads, begins = np.unique(head[of], return_index=True)
            self.parts.append((tail[of], moves.area[of], heads, begins))

    def relax(self, price: int, before: np.ndarray, now: np.ndarray) -> None:
        """now[head] = min(now[head], before[tail] + area)."""
        tail, area, heads, begins = self.parts[price]
        if len(tail):
            now[heads] = np.minimum(now[heads], np.minimum.reduceat(before[tail] + area, begins))

    def run(self, tables: np.ndarray) -> None:
        """Fill tables (m + 1, N): least area to or from each node with at most so many cage vertices."""
        for k, now in enumerate(tables):
            if k:
                self.relax(1, tables[k - 1], now)
                np.minimum(now, tables[k - 1], out=now)
            self.relax(0, now, now)


def cheap_walks(nodes: Nodes, moves: Moves, most: int, below: float) -> Cheap:
    """Search closed walks of at most ``most`` cage vertices and of less area than ``below``."""
    search = _Search(nodes, moves, most)
    groups = search.groups(below)
    keep, through, least = np.zeros(len(moves.source), bool), np.full(len(nodes.kind), np.inf), np.inf
    for low, _, group in groups:
        least = min(least, low)
        if low < below:
            total = search.totals(group)
            keep |= total < below
            np.minimum.at(through, moves.source, total)
            np.minimum.at(through, moves.target, total)
    return Cheap(least, keep, through)


class _Search:
    def __init__(self, nodes: Nodes, moves: Moves, most: int) -> None:
        self.moves, self.most, self.count = moves, most, len(nodes.kind)
        edges = nodes.kind == EDGE
        # a cage vertex is counted by the move that comes to it; one on the outline is no more on leaving it by an edge
        self.cost = np.where(edges[moves.target] & ~edges[moves.source], 0, 1)
        around = 2 * len(nodes.outline)
        place = (nodes.key - _best_cut(nodes.key, moves, around)) % around
        self.crossing = place[moves.target] < place[moves.source]
        inner = ~self.crossing
        kept, cost = moves.take(inner), self.cost[inner]
        self.ahead = Layers(kept, cost, kept.target, kept.source)
        self.back = Layers(kept, cost, kept.source, kept.target)
        self.over = np.flatnonzero(self.crossing)
        sources = np.unique(moves.source[self.over])
        self.sources = sources[np.lexsort((nodes.low[sources], place[sources]))]

    def groups(self, below: float) -> list[tuple[float, int, np.ndarray]]:
        """First nodes in groups, each with a lower bound; the one with the least is halved again and again."""
        if not len(self.sources):
            return []
        budget = int(np.clip(WORK / max(len(self.moves.source), 1), FEWEST_GROUPS, MOST_GROUPS))
        heap, number = [(self.bound(self.sources), 0, self.sources)], 0
        while number < budget and heap[0][0] < below and len(heap[0][2]) > 1:
            low, _, group = heapq.heappop(heap)
            for half in np.array_split(group, 2):
                number += 1
                heapq.heappush(heap, (max(low, self.bound(half)), number, half))
        return heap

    def bound(self, group: np.ndarray) -> float:
        """Least area of walks from a group of first nodes to the same group."""
        return float(self.forward(group)[self.most, group].min())

    def forward(self, group: np.ndarray) -> np.ndarray:
        """(m + 1, N) least areas from the group, over its moves that cross the cut."""
        over = self._over(group)
        tables = np.full((self.most + 1, self.count), np.inf)
        for price in (0, 1):
            of = over[self.cost[over] == price]
            np.minimum.at(tables[price], self.moves.target[of], self.moves.area[of])
        self.ahead.run(tables)
        return tables

    def totals(self, group: np.ndarray) -> np.ndarray:
        """(K,) least areas of walks from the group to itself through each move."""
        ahead, back = self.forward(group), np.full((self.most + 1, self.count), np.inf)
        back[0, group] = 0.0
        self.back.run(back)
        source, target, area = self.moves
        total = np.full(len(source), np.inf)
        inner = np.flatnonzero(~self.crossing)
        inner = inner[np.isfinite(ahead[self.most, source[inner]] + back[self.most, target[inner]])]
        best = np.full(len(inner), np.inf)
        for k in range(self.most + 1):
            left = self.most - k - self.cost[inner]
            rest = np.where(left >= 0, back[np.maximum(left, 0), target[inner]], np.inf)
            np.minimum(best, ahead[k, source[inner]] + rest, out=best)
        total[inner] = best + area[inner]
        over = self._over(group)
        total[over] = area[over] + back[self.most - self.cost[over], target[over]]
        return total

    def _over(self, group: np.ndarray) -> np.ndarray:
        there = np.zeros(self.count, bool)
        there[group] = True
        return self.over[there[self.moves.source[self.over]]]


def _best_cut(key: np.ndarray, moves: Moves, around: int) -> int:
    """The vertex of the outline, as an even place, that moves from the fewest nodes pass."""
    source, reach = moves.source, (key[moves.target] - key[moves.source]) % around
    nodes = np.unique(source)
    farthest = np.zeros(len(key), int)
    np.maximum.at(farthest, source, reach)
    passed = np.zeros(2 * around + 2, int)
    np.add.at(passed, key[nodes] + 1, 1)
    np.add.at(passed, key[nodes] + farthest[nodes] + 1, -1)
    passed = np.cumsum(passed)
    return 2 * int(np.argmin((passed[:around] + passed[around : 2 * around])[::2]))


# Branch and bound: cells that cheap walks use are halved until all walks cost as much as the target.

PER_HALF_TURN = 8  # first cells in half a turn
FEW_VERTICES = 200  # vertices of an outline below which its edges get two pieces each, on average
FEW_NODES = 1000  # nodes below which a larger part of them is halved in a round
HALVED_OF_FEW, HALVED_OF_MANY = 0.6, 0.1
"""Nodes are halved whose cheapest walk lies within this part of the way from the bound to the target."""
SMALLEST_CELL = 1e-7  # radians or part of an edge; cells that are smaller are not halved
PAIRS = 300_000  # pairs of nodes that are looked at in one go
MOST_MOVES, MOST_ROUNDS = 1_200_000, 40  # caps


class Bound(NamedTuple):
    """A lower bound, and what it took."""

    area: float  # no simple polygon of at most m vertices whose solid holds the shape has less
    proven: bool  # whether the target was reached
    rounds: int
    nodes: int
    seconds: float  # CPU time


def lower_bound(shape: Mesh, most: int, cage_area: float, *, target: float = 0.01, seconds: float = 30.0) -> Bound:
    """Bound the area of all polygons of at most ``most`` vertices around a shape of one loop, holes left out.

    cage_area: that of a known cage; the search ends once it is at most the part ``target`` above the bound.
    """
    began = time.process_time()
    loop = next(loop for loop, sign in zip(shape.loops, shape.loop_signs, strict=True) if sign > 0)
    outline = Outline(shape.vertices[loop])
    below = cage_area / outline.size**2 / (1.0 + target) - outline.area
    if below <= 0.0:
        return Bound(outline.area * outline.size**2, True, 0, 0, time.process_time() - began)
    nodes = first_nodes(outline, PER_HALF_TURN, (2 if len(outline) < FEW_VERTICES else 1) * len(outline))
    moves = _first_moves(nodes, below)
    best, rounds = 0.0, 0
    while True:
        rounds += 1
        every = Moves.joined([moves, onto_outline(nodes, below)])
        cheap = cheap_walks(nodes, every._replace(area=np.maximum(every.area - LOWER, 0.0)), most, below)
        best = max(best, min(cheap.least, below))
        if cheap.least >= below or rounds == MOST_ROUNDS or time.process_time() - began > seconds:
            break
        alive = cheap.through < below
        part = HALVED_OF_FEW if alive.sum() < FEW_NODES else HALVED_OF_MANY
        split = alive & (cheap.through <= cheap.least + part * (below - cheap.least))
        split &= nodes.high - nodes.low > SMALLEST_CELL
        kept = moves.take(cheap.moves[: len(moves.source)])
        kept = kept.take(alive[kept.source] & alive[kept.target])
        finer = _halved(nodes, kept, alive, split, below)
        if not split.any() or finer is None:
            break
        nodes, moves = finer
    area = (outline.area + best) * outline.size**2
    return Bound(area, bool(cheap.least >= below), rounds, len(nodes.kind), time.process_time() - began)


def _first_moves(nodes: Nodes, below: float) -> Moves:
    """All moves of less area than something, but those to and from an edge and the outline."""
    found = []
    for kinds in ((EDGE, EDGE), *ALLOWED):
        sources, targets = (np.flatnonzero(nodes.kind == kind) for kind in kinds)
        step = 1 + PAIRS // max(len(targets), 1)
        for begin in range(0, len(sources), step):
            part = sources[begin : begin + step]
            source, target = np.repeat(part, len(targets)), np.tile(targets, len(part))
            other = source != target
            found.append(_areas(nodes, source[other], target[other], below))
    return Moves.joined(found)


def _areas(nodes: Nodes, source: np.ndarray, target: np.ndarray, below: float) -> Moves:
    """The moves between pairs of nodes that have less area than something."""
    area = np.full(len(source), np.inf)
    edges = nodes.kind[source] == EDGE
    area[edges] = over_corners(nodes, source[edges], target[edges])
    area[~edges] = along_chords(nodes, source[~edges], target[~edges], below)
    return Moves(source, target, area).take(area < below)


def _halved(
    nodes: Nodes, moves: Moves, alive: np.ndarray, split: np.ndarray, below: float
) -> tuple[Nodes, Moves] | None:
    """Nodes with some in two, and the moves between them; None if they would be too many."""
    finer, first, count = nodes.halved(alive, split)
    parent, source = ranges(first[moves.source], (first + count)[moves.source])
    again, target = ranges(first[moves.target][parent], (first + count)[moves.target][parent])
    source, parent = source[again], parent[again]
    if len(source) > MOST_MOVES:
        return None
    same = ~split[moves.source[parent]] & ~split[moves.target[parent]]
    stay = Moves(source[same], target[same], moves.area[parent[same]])
    parts = [stay]
    source, target = source[~same], target[~same]
    parts += [_areas(finer, source[k : k + PAIRS], target[k : k + PAIRS], below) for k in range(0, len(source), PAIRS)]
    return finer, Moves.joined(parts)
