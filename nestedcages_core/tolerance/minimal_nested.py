"""Minimal nested polygons: few links around a loop within a distance of it, and a bound that no polygon undercuts.

A gate is a segment from a point of the fine loop straight outwards to a place farther from the fine mesh than the
distance. Segments to nearest points do not cross, so a loop of a cage within the distance meets the gates in their
order, and each of its edges, a link, meets a run of consecutive ones: it passes between their two ends, that on the
fine mesh to its left.

What j links can reach from a gate ends at a window: a chord of the last line that passes as many gates as any. It
touches an inner end and an outer end of gates, and the window runs from the later one of these to where the line misses
a gate. A link that goes on crosses the window, wherever it likes: so the next window is that of a line with the window
for its first gate (Suri 1986; for polygons between two others Suri & O'Rourke 1985, Ghosh & Maheshwari 1990; between
convex ones Aggarwal, Booth, O'Rourke, Suri & Yap 1989). Once around from a gate, links are as few as possible. A
polygon has at most one less, since it is a path from a point of the gate back to it. A walk of such lines that closes
up is a polygon.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.broad_phase import BoxTree
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_ROUNDS, NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import cross, norm, rotated_left, rotated_right
from .minimum_link import Corridor

FIRST_GATES, MAX_GATES = 512, 8192
"""Gates of a loop at first, and at most."""

GATES_PER_LINK = 16
"""Gates aimed at for each link, which may lose one of them in the bound; and steps between those that are added around
a place where a polygon went too far, up to the mean distance of gates away."""

FAN_STEP = 0.1
"""Largest turn, in radians, between gates at a convex corner."""

LEAST_NOTCH = 0.02
"""Turn inwards, in radians, from which a corner is looked at: polygons go beyond others by 5e-5 of the distance."""


RESERVE = 1e-3
"""Relative width by which the gates of the walk are shorter."""


BOUND_STARTS = 2
"""Gates of a loop from which links are counted."""

MAX_LINKS = 100
"""Links of all walks after which there are no more."""


@dataclass(frozen=True, eq=False)
class Gates:
    """Gates of one loop in its order: from the feet (N, 2) on the loop along unit normals (N, 2)."""

    foot: FloatArray
    normal: FloatArray

    def ends(self, low: float, high: float) -> tuple[FloatArray, FloatArray]:
        """The gates' points at two distances from the loop, (N, 2), (N, 2)."""
        return self.foot + low * self.normal, self.foot + high * self.normal


class _Boundary:
    """The boundary of a loop's offset by a distance: edges moved along their normals, and arcs at convex corners."""

    def __init__(self, fine: Mesh, loop: int, distance: float) -> None:
        self.points = fine.vertices[fine.loops[loop]]
        self.steps = np.roll(self.points, -1, axis=0) - self.points
        lengths = norm(self.steps)
        self.normals = rotated_right(self.steps) / lengths[:, None]
        after = np.roll(self.normals, -1, axis=0)
        turns = np.arctan2(cross(self.normals, after), (self.normals * after).sum(axis=1))
        self.is_notch = turns < -LEAST_NOTCH
        self.turns = np.maximum(turns, 0.0)
        # edge by edge, each with the corner at its end
        self.lengths = np.stack([lengths, distance * self.turns], axis=1).ravel()
        self.ends = np.cumsum(self.lengths)

    @property
    def length(self) -> float:
        """Of the whole boundary."""
        return float(self.ends[-1])

    def samples(self, count: int) -> FloatArray:
        """(N,) at most twice as many places, the middles of equal parts of edges and arcs; each has one if few do."""
        spacing = self.length / count
        turns = np.stack([np.zeros_like(self.turns), self.turns], axis=1).ravel()
        parts = np.maximum(np.rint(np.maximum(self.lengths / spacing, turns / FAN_STEP)), 1.0).astype(np.int64)
        parts[self.lengths == 0.0] = 0
        piece = np.repeat(np.arange(len(parts)), parts)
        number = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
        places: FloatArray = (self.ends - self.lengths)[piece] + (number + 0.5) / parts[piece] * self.lengths[piece]
        even = np.linspace(0, len(places), min(len(places), 2 * count), endpoint=False).astype(np.int64)
        return places[even]

    def at(self, places: FloatArray) -> Gates:
        """The gates at places (N,) along the boundary, counted on and on around."""
        places = np.mod(places, self.length)
        piece = np.minimum(np.searchsorted(self.ends, places, side="right"), len(self.ends) - 1)
        part = np.clip((places - (self.ends - self.lengths)[piece]) / self.lengths[piece], 0.0, 1.0)
        edge, on_arc = piece // 2, piece % 2 == 1
        angle = np.where(on_arc, part * self.turns[edge], 0.0)
        normal = np.cos(angle)[:, None] * self.normals[edge] + np.sin(angle)[:, None] * rotated_left(self.normals[edge])
        return Gates(self.points[edge] + np.where(on_arc, 1.0, part)[:, None] * self.steps[edge], normal)

    def under(self, points: FloatArray) -> FloatArray:
        """(N,) the places whose gates lead to points (N, 2)."""
        near = BoxTree(self.points, np.roll(self.points, -1, axis=0)).closest(points)
        edge, at = near.edge, near.parameter
        edge = np.where(at == 0.0, edge - 1, edge) % len(self.points)
        on_arc = (at == 0.0) | (at == 1.0)
        away = points - np.roll(self.points, -1, axis=0)[edge]
        turn = np.arctan2(cross(self.normals[edge], away), (self.normals[edge] * away).sum(axis=1))
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.where(
                on_arc, np.where(self.turns[edge] > 0.0, np.clip(turn / self.turns[edge], 0.0, 1.0), 0.0), at
            )
        piece = 2 * edge + on_arc
        places: FloatArray = self.ends[piece] - (1.0 - part) * self.lengths[piece]
        return places


def _protruding(fine: Mesh, loop: int, found: Gates) -> float:
    """How far vertices of a loop protrude from the chords between the feet of gates, at most."""
    feet = np.concatenate([found.foot, found.foot[:1]])
    points = fine.vertices[fine.loops[loop]]
    chords = BoxTree(feet[:-1], feet[1:])
    near = chords.closest(points)
    start, end = feet[near.edge], feet[near.edge + 1]
    outside = cross(end - start, points - start) < 0.0
    return float(near.distance[outside].max(initial=0.0))


class Band:
    """What is within a distance of one loop of a mesh, with its gates."""

    def __init__(self, fine: Mesh, loop: int, distance: float) -> None:
        self.fine, self.loop, self.distance = fine, loop, distance
        self.search = fine.edge_search
        self.boundary = _Boundary(fine, loop, distance)
        self._place(FIRST_GATES)
        if len(self.places) >= MIN_PER_LOOP:
            wanted = GATES_PER_LINK * self._counting(0.0).links_around(0)
            if wanted > FIRST_GATES:
                self._place(min(wanted, MAX_GATES))

    def _place(self, count: int) -> None:
        """Place about this many gates; none where other points of the mesh are closer.

        Where these begin, a gate is as close to them as doubles tell: there the offset has a corner that turns inwards.
        """
        boundary = self.boundary
        notches = boundary.ends[::2][boundary.is_notch]  # no gate is free there
        places = np.unique(np.mod(np.concatenate([boundary.samples(count), notches]), boundary.length))
        kept = self._free(places)
        ends = np.flatnonzero(kept != np.roll(kept, -1))
        here, there = places[ends], np.append(places, places[0] + boundary.length)[ends + 1]
        good, bad = np.where(kept[ends], here, there), np.where(kept[ends], there, here)
        for _ in range(MOST_ROUNDS if len(ends) else 0):
            middle = 0.5 * (good + bad)
            is_free = self._free(middle)
            good, bad = np.where(is_free, middle, good), np.where(is_free, bad, middle)
        self.places = np.unique(np.mod(np.concatenate([places[kept], good]), boundary.length))

    def _free(self, places: FloatArray) -> BoolArray:
        found = self.boundary.at(places)
        reach = self.search.closest(found.foot + (1.0 + NEGLIGIBLE) * self.distance * found.normal).distance
        return np.asarray(reach > (1.0 + 0.5 * NEGLIGIBLE) * self.distance)

    def add(self, points: FloatArray) -> None:
        """Add gates around those that lead to points (N, 2), where they are free."""
        if len(self.places) == 0:
            return
        spacing = self.boundary.length / len(self.places)
        around = self.boundary.under(points)[:, None] + spacing * np.linspace(-1.0, 1.0, GATES_PER_LINK + 1)
        places = np.mod(around.ravel(), self.boundary.length)
        self.places = np.union1d(self.places, places[self._free(places)])

    def fewest_links(self, clearance: float) -> int:
        """Lower bound on the vertices of a cage's loop around this one, all of it within the distance.

        The larger of two bounds: by links that meet, from some gates, and by runs that need not, from every gate.
        """
        if len(self.places) < MIN_PER_LOOP:
            return MIN_PER_LOOP
        corridor = self._counting(clearance)
        meeting = max(corridor.links_around(start) for start in corridor.some(BOUND_STARTS)) - 1
        return corridor.fewest_runs(max(MIN_PER_LOOP, meeting))

    def walks(self, clearance: float, *, share: float = 1.0, enough: int = 0) -> list[FloatArray]:
        """Polygons (k, 2) around the loop of few links each, fewest first; they are to be verified.

        share: part of the distance that they keep. enough: number of links with which only some of them are made.
        """
        if len(self.places) < MIN_PER_LOOP:
            return []
        gates = self.boundary.at(self.places)
        low = clearance + _protruding(self.fine, self.loop, gates)
        high = (1.0 - RESERVE) * share * self.distance
        if not low < high:
            return []
        corridor = Corridor(*gates.ends(low, high), slack=0.0)
        polygons: list[FloatArray] = []
        for start in corridor.some(MAX_LINKS // MIN_PER_LOOP):
            polygon = corridor.polygon(start)
            if polygon is not None:
                polygons.append(polygon)
            if not polygons or min(map(len, polygons)) <= enough or sum(map(len, polygons)) > MAX_LINKS:
                break
        return sorted(polygons, key=len)

    def _counting(self, clearance: float) -> Corridor:
        ends = self.boundary.at(self.places).ends(clearance, (1.0 + NEGLIGIBLE) * self.distance)
        return Corridor(*ends, slack=ROUND_OFF)
