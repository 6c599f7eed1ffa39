"""Symmetric cages: one loop stands for its images, and a part of its candidate lines for all of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.group import Orbits, Symmetry
from ..geometry.loops import Loops
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import dot, norm
from .outline import Lines, Outline
from .ring_search import RingSearch
from .sampling import NormalFrame
from .shortest_cycles import Paths
from .tangents import supporting_lines
from .turns import Turns, turns

SYMMETRY_TOLERANCE = 1e-3
"""Distance between a vertex and the image of its partner, in diameters, up to which they count as symmetric. Offsets in
narrow gaps, where rounding decides what touches, may differ by their whole length."""


class AsymmetricError(NestingError):
    """An outline that is not symmetric."""


def approximate_orbits(outline: Loops, symmetry: Symmetry) -> Orbits:
    """The orbits of an outline. Raises AsymmetricError."""
    orbits = Orbits.of(outline.vertices, outline.successor, symmetry, SYMMETRY_TOLERANCE * outline.diameter)
    if orbits is None:
        raise AsymmetricError(
            f"No symmetric cage was found: where gaps are narrow, an offset of the outline does not have {symmetry}; "
            "leave out the symmetry, or widen the gaps.",
            code="symmetry.not_found",
        )
    return orbits


def symmetrised(outline: Loops, symmetry: Symmetry | None) -> Loops:
    """An outline that is symmetric up to a tolerance, made exactly symmetric. Raises AsymmetricError."""
    if symmetry is None:
        return outline
    return outline.moved(approximate_orbits(outline, symmetry).symmetrised(outline.vertices))


def padded_alike(outline: Loops, total: int, symmetry: Symmetry) -> list[FloatArray]:
    """The loops (k, 2) of a symmetric outline with edges divided evenly, images alike, up to `total` vertices.

    May have fewer vertices where edges come in orbits. Raises AsymmetricError.
    """
    successor = outline.successor
    steps = outline.vertices[successor] - outline.vertices
    _, orbit, sizes = np.unique(
        approximate_orbits(outline, symmetry).edge_orbit(successor), return_inverse=True, return_counts=True
    )
    lengths = np.zeros(len(sizes))
    lengths[orbit] = norm(steps)
    pieces, missing = np.ones(len(sizes), np.int64), total - len(outline.vertices)
    while (sizes <= missing).any():
        spacing = np.where((sizes <= missing) & ((sizes > 1) | (missing % symmetry.order > 0)), lengths / pieces, -1.0)
        chosen = int(np.argmax(spacing))
        if spacing[chosen] < 0.0:
            chosen = int(np.argmax(np.where(sizes <= missing, lengths / pieces, -1.0)))
        pieces[chosen] += 1
        missing -= int(sizes[chosen])
    of_edge = pieces[orbit]
    begin = np.cumsum(of_edge) - of_edge
    fraction = (np.arange(of_edge.sum()) - np.repeat(begin, of_edge)) / np.repeat(of_edge, of_edge)
    vertices = np.repeat(outline.vertices, of_edge, axis=0) + fraction[:, None] * np.repeat(steps, of_edge, axis=0)
    padded = Loops.of(vertices, np.add.reduceat(of_edge, outline.begins))
    return symmetrised(padded, symmetry).split()


class Halves(NamedTuple):
    """The K lines of a loop across the axis of a mirror."""

    image: IntArray
    """(K,) the image of each line."""
    rank: IntArray
    """(K,) order along one half: 0 for lines at its begin, K for those at its end, -1 in the other half."""
    begins: FloatArray
    """(K,) 0 for lines at the begin that are their own images; infinite for others."""
    ends: FloatArray
    """(K,) the same at the end."""

    def take(self, usable: BoolArray) -> Halves:
        """Those of some lines and their images."""
        number = np.cumsum(usable) - 1
        image = number[self.image[usable]]
        return Halves(image, self.rank[usable], self.begins[usable], self.ends[usable])


class Images(NamedTuple):
    """The images of an outline's loops under a symmetry, in the frame of the search."""

    symmetry: Symmetry
    frame: NormalFrame
    partner: list[IntArray]
    """(n,) for each element the image of each vertex of the outline."""
    begins: IntArray
    loops: list[tuple[int, int]]
    """For each loop one that stands for it, and the element that takes this to it."""
    own: list[list[int]]
    """For each loop the elements that take it to itself."""

    @classmethod
    def of(cls, outline: Loops, symmetry: Symmetry, frame: NormalFrame) -> Images:
        """Those of an outline in the input's units. Raises AsymmetricError."""
        first = approximate_orbits(outline, symmetry).partner
        partner = [np.arange(len(first))]
        for _ in range(1, symmetry.order):
            partner.append(first[partner[-1]])
        of_vertex = np.repeat(np.arange(len(outline.sizes)), outline.sizes)
        image = np.stack([of_vertex[each[outline.begins]] for each in partner])  # (order, L)
        loops = [(int(image[:, k].min()), 0) for k in range(len(outline.sizes))]
        loops = [(r, int(np.flatnonzero(image[:, r] == k)[0])) for k, (r, _) in enumerate(loops)]
        own = [np.flatnonzero(image[:, k] == k).tolist() for k in range(len(outline.sizes))]
        return cls(symmetry, frame, partner, outline.begins, loops, own)

    def is_halved(self, loop: int) -> bool:
        """Whether a loop lies across the axis of a mirror."""
        return self.symmetry.reverses and len(self.own[loop]) > 1

    def points(self, points: FloatArray, element: int) -> FloatArray:
        """The images of points (K, 2)."""
        if element % self.symmetry.order == 0:
            return points
        return self.frame.into(self.symmetry.image(self.frame.out_of(points), element % self.symmetry.order))

    def directions(self, points: FloatArray, directions: FloatArray, element: int) -> FloatArray:
        """The directions (K, 2) of the images of lines through points (K, 2), with the solid on their left."""
        turned = self.points(points + directions, element) - self.points(points, element)
        return -turned if self.reverses(element) else turned

    def edges(
        self, cycle: IntArray, edge: tuple[FloatArray, ...], element: int
    ) -> tuple[IntArray, tuple[FloatArray, ...]]:
        """The images of the edges of a cycle: their lines, contacts, directions, starts and ends."""
        point, direction, start, end = edge
        direction = self.directions(point, direction, element)
        point, start, end = (self.points(each, element) for each in (point, start, end))
        if not self.reverses(element):
            return cycle, (point, direction, start, end)
        return cycle[::-1], tuple(each[::-1] for each in (point, direction, end, start))

    def reverses(self, element: int) -> bool:
        """Whether images run backwards."""
        return self.symmetry.reverses and element % 2 == 1

    def turned(self, loop: int, outline: Outline, lines: Lines) -> Lines:
        """Lines of one part of a loop that rotations take to itself, and their images; as many in each part."""
        number = len(self.own[loop])
        shifts = {self._shift(loop, element) % outline.size: element for element in self.own[loop]}
        part = lines.take(lines.place < outline.size // number)
        all_parts = []
        for k in range(number):
            shift = k * outline.size // number
            point = self.points(part.point, shifts[shift])
            direction = self.directions(part.point, part.direction, shifts[shift])
            all_parts.append(part.but(point=point, place=part.place + shift, direction=direction))
        return Lines.joined(all_parts)

    def mirrored(self, loop: int, outline: Outline, lines: Lines, at: IntArray, shift: float) -> tuple[Lines, Halves]:
        """Lines of one half of a loop across the axis and their images, with lines that are their own ones.

        at: (N,) vertices between which the latter are tangents. shift: distance of lines from the outline.
        """
        size = outline.size
        total = self._shift(loop, 1)  # of the places of each vertex and its image, up to whole turns
        begin = 0.5 * total
        along = np.mod(lines.place - begin, size)
        half = np.flatnonzero((along > ROUND_OFF * size) & (along < (0.5 - ROUND_OFF) * size))
        half = half[np.argsort(along[half], kind="stable")]
        part, along = lines.take(half), along[half]
        image = part.but(
            point=self.points(part.point, 1),
            place=np.mod(begin - along, size),
            direction=self.directions(part.point, part.direction, 1),
        )
        ahead = at[(np.mod(at - begin, size) > 0.0) & (np.mod(at - begin, size) < 0.5 * size)]
        behind = (total - ahead) % size
        first = self._across(outline, behind, ahead, begin, shift)
        last = self._across(outline, ahead, behind, np.mod(begin + 0.5 * size, size), shift)
        every = Lines.joined([first, part, last, image.take(np.arange(len(part))[::-1])])
        a, n, b, count = len(first), len(part), len(last), len(every)
        partner = np.arange(count)
        partner[a : a + n] = np.arange(count - 1, count - 1 - n, -1)
        partner[a + n + b :] = np.arange(a + n - 1, a - 1, -1)
        rank = np.full(count, -1)
        rank[:a], rank[a : a + n], rank[a + n : a + n + b] = 0, np.arange(1, n + 1), count
        begins, ends = np.full((2, count), np.inf)
        begins[:a], ends[a + n : a + n + b] = 0.0, 0.0
        # in the order of the outline
        start = int(every.place.argmin())
        while every.place[start - 1] == every.place[start]:
            start -= 1
        order = np.roll(np.arange(count), -start)
        where = np.argsort(order)
        return every.take(order), Halves(where[partner[order]], rank[order], begins[order], ends[order])

    def to_axis(self, lines: Lines, halves: Halves) -> FloatArray:
        """(2, K) how far lines run forwards and backwards until they meet the axis of the mirror."""
        away = lines.point - self.points(lines.point, 1)
        along = lines.direction + self.directions(lines.point, lines.direction, 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = -dot(away, along) / dot(along, along)
        reach[halves.image == np.arange(len(lines))] = np.nan
        limits = np.stack((reach, -reach))
        return np.where(limits > 0.0, limits, np.inf)

    def _across(self, outline: Outline, first: IntArray, last: IntArray, place: float, shift: float) -> Lines:
        """Tangents of stretches across the axis at a place, which are their own images."""
        found = supporting_lines(outline, first, np.where(last <= first, last + outline.size, last)).shifted(shift)
        if len(found) == 0:
            return found
        point = 0.5 * (found.point + self.points(found.point, 1))
        direction = found.direction + self.directions(found.point, found.direction, 1)
        direction /= norm(direction)[:, None]
        right = np.stack((direction[:, 1], -direction[:, 0]), axis=1)
        height = np.round((right * (point - outline.vertices[0])).sum(axis=1) / outline.length, 9)
        _, kept = np.unique(height, return_index=True)
        return Lines.of(point[kept], np.full(len(kept), place), direction[kept])

    def _shift(self, loop: int, element: int) -> int:
        """The vertex of a loop that is the image of its first one."""
        return int(self.partner[element][self.begins[loop]] - self.begins[loop])


class MirrorSearch(RingSearch):
    """The best symmetric cycles around one loop.

    A symmetric cycle crosses the axis twice: with a line that is its own image, or with a vertex between a line and its
    image. Without a first line to fix, one program finds the best cycles of all numbers of lines.
    """

    def __init__(
        self, outline: Outline, lines: Lines, free: FloatArray, *, width: int, sizes: range, halves: Halves
    ) -> None:
        """free: (2, K) what is free of each line. sizes: the possible numbers of lines."""
        self.outline, self.lines, self.free, self.sizes, self.halves = outline, lines, free, sizes, halves
        self.turns: Turns = turns(outline, lines, free, width)
        self.totals, self.found = np.full(sizes.stop, np.inf), {}

    def solve(self, through: int | None = None) -> Iterator[list[Paths]]:
        """Search from scratch, after changes of `free`. Yields in between."""
        image, rank = self.halves.image, self.halves.rank
        areas, (source, target) = self.turns.within(self.free), (self.turns.source, self.turns.target)
        begins, ends = self.halves.begins.copy(), self.halves.ends.copy()
        first = (source == image[target]) & ~np.isfinite(begins[target]) & (rank[target] > 0)
        begins[target[first]] = areas[first]
        last = (target == image[source]) & ~np.isfinite(ends[source]) & (rank[source] >= 0)
        ends[source[last]] = areas[last]
        self.begins, self.ends = begins, ends
        onward = np.flatnonzero((rank[source] >= 0) & (rank[target] > rank[source]) & np.isfinite(areas))
        self.source, self.target, self.areas = source[onward], target[onward], 2.0 * areas[onward]
        reached, at = np.unique(self.target, return_index=True)
        most = max(1, (self.sizes.stop + 1) // 2)
        at_axis = self.halves.begins == 0.0, self.halves.ends == 0.0
        self.least = np.full((2, most, len(self.lines)), np.inf)
        self.totals = np.full(self.sizes.stop, np.inf)
        self.found = {}
        for line_first in (0, 1):
            yield []
            least = self.least[line_first]
            least[0] = np.where(at_axis[0] == bool(line_first), begins, np.inf)
            for k in range(most):
                if k and len(reached):
                    least[k, reached] = np.minimum.reduceat(least[k - 1, self.source] + self.areas, at)
                for line_last in (0, 1):
                    number = 2 * (k + 1) - line_first - line_last
                    closed = np.where(at_axis[1] == bool(line_last), least[k] + self.ends, np.inf)
                    end = int(closed.argmin())
                    if number in self.sizes and closed[end] < self.totals[number]:
                        self.totals[number], self.found[number] = closed[end], (line_first, k, end)

    def refine(self, number: int) -> Iterator[list[Paths]]:
        """The search knows no better cycle."""
        return iter(())

    def cycle(self, number: int) -> IntArray:
        """(number,) the lines of the best cycle, ascending."""
        line_first, k, line = self.found[number]
        path = [line]
        for step in range(k - 1, -1, -1):
            onto = slice(*np.searchsorted(self.target, (path[-1], path[-1] + 1)).tolist())
            path.append(
                int(self.source[onto][(self.least[line_first, step, self.source[onto]] + self.areas[onto]).argmin()])
            )
        half = np.array(path)
        lines: IntArray = np.unique(np.concatenate((half, self.halves.image[half])))
        return lines

    def symmetrise(self) -> None:
        """Let what is free of a line be free of its image."""
        self.free = np.minimum(self.free, self.free[::-1, self.halves.image])
