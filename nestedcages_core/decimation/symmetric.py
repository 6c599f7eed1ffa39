"""Symmetric cages: one loop stands for its images, and the first part of a loop that is its own image for all parts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.group import Orbits, Symmetry
from ..geometry.loops import Loops
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import dot, norm, rotated_right
from .outline import Lines, Outline
from .ring_search import RingSearch
from .sampling import NormalFrame
from .shortest_cycles import Graph, Paths
from .turns import SLACK, Turns


def _orbits(loops: Loops, symmetry: Symmetry) -> Orbits:
    """The orbits of the vertices of loops. Raises NestingError."""
    orbits = Orbits.of(loops.vertices, loops.successor, symmetry, NEGLIGIBLE * loops.diameter)
    if orbits is None:
        raise NestingError(f"The outline does not have {symmetry}.", code="symmetry.not_found")
    return orbits


def exact(loops: Loops, symmetry: Symmetry) -> Loops:
    """Loops that are symmetric up to round-off, made exactly so. Raises NestingError."""
    return loops.moved(_orbits(loops, symmetry).symmetrised(loops.vertices))


def symmetrised(loops: Loops, symmetry: Symmetry | None) -> Loops:
    """The same, where loops across an axis begin there, and have vertices at both places of it."""
    if symmetry is None:
        return loops
    rings = exact(loops, symmetry).split()
    partner = _orbits(loops, symmetry).partner[loops.begins]
    across = (loops.loop[partner] == np.arange(len(rings))) & symmetry.reverses
    for k in np.flatnonzero(across).tolist():
        rings[k] = _from_axis(rings[k], int(partner[k] - loops.begins[k]), symmetry)
    return Loops.of(np.concatenate(rings), list(map(len, rings)))


def _from_axis(ring: FloatArray, image: int, mirror: Symmetry) -> FloatArray:
    """A ring (k, 2) across an axis from there on; image: the vertex that is the image of the first one."""
    size = len(ring)
    begin, end = 0.5 * image, 0.5 * (image + size)
    half = ring[np.arange(np.floor(begin) + 1, np.ceil(end), dtype=np.int64) % size]
    low, high = np.floor((begin, end)).astype(np.int64) % size, np.ceil((begin, end)).astype(np.int64) % size
    first, last = mirror.fixed(0.5 * (ring[low] + ring[high]))
    return np.concatenate(([first], half, [last], mirror.image(half)[::-1]))


class Images(NamedTuple):
    """The images of loops and of their lines under a symmetry, in the frame of the search."""

    symmetry: Symmetry
    frame: NormalFrame
    loops: list[tuple[int, int]]
    """For each loop one that stands for it, and the element that takes this to it."""
    shift: list[int]
    """For each loop that is its own image the vertex that is the image of its first one; -1 for others."""

    @classmethod
    def of(cls, loops: Loops, symmetry: Symmetry, frame: NormalFrame) -> Images:
        """Those of symmetrised loops. Raises NestingError."""
        partner = _orbits(loops, symmetry).partner[loops.begins]
        image = loops.loop[partner]
        every = [np.arange(len(image))]
        for _ in range(1, symmetry.order):
            every.append(image[every[-1]])
        first, element = np.min(every, axis=0), -np.argmin(every, axis=0) % symmetry.order
        shift = np.where(image == every[0], partner - loops.begins, -1)
        return cls(symmetry, frame, list(zip(first.tolist(), element.tolist(), strict=True)), shift.tolist())

    def is_halved(self, loop: int) -> bool:
        """Whether a loop lies across the axis of a mirror."""
        return self.symmetry.reverses and self.shift[loop] >= 0

    def parts(self, loop: int) -> int:
        """The number of parts of a loop that rotations take to each other."""
        return 1 if self.symmetry.reverses or self.shift[loop] < 0 else self.symmetry.order

    def reverses(self, element: int) -> bool:
        """Whether images run backwards."""
        return self.symmetry.reverses and element % 2 == 1

    def points(self, points: FloatArray, element: int = 1) -> FloatArray:
        """The images of points (K, 2)."""
        return self.frame.into(self.symmetry.image(self.frame.out_of(points), element % self.symmetry.order))

    def lines(self, lines: Lines, element: int = 1) -> Lines:
        """The images of lines, with the solid on their left, at the same places."""
        direction = self.points(lines.direction, element) - self.points(np.zeros((1, 2)), element)
        sign = -1.0 if self.reverses(element) else 1.0
        return lines.but(point=self.points(lines.point, element), direction=sign * direction)

    def first_part(self, loop: int, outline: Outline, lines: Lines, at: IntArray, shift: float) -> Lines:
        """The lines of the first part of a loop; of its first half with tangents across the axis.

        at: (N,) vertices where stretches across the axis end. shift: distance of lines from the outline.
        """
        if not self.is_halved(loop):
            return lines.take(lines.place < outline.size // self.parts(loop))
        middle = outline.size // 2
        half = lines.take((lines.place > ROUND_OFF * middle) & (lines.place < (1.0 - ROUND_OFF) * middle))
        ahead = at[(at > 0) & (at < middle)]
        first, last = (self._across(outline, place, ahead, shift) for place in (0, middle))
        return Lines.joined([first, half, last])

    def all_parts(self, loop: int, outline: Outline, part: Lines, free: FloatArray) -> tuple[Lines, FloatArray]:
        """Lines of the first part and their images, and what is free (2, K) of them."""
        if not self.is_halved(loop):
            number, part_size = self.parts(loop), outline.size // self.parts(loop)
            step = pow(self.shift[loop] // part_size, -1, number) if number > 1 else 0  # to the next part
            every = [self.lines(part, k * step).but(place=part.place + k * part_size) for k in range(number)]
            return Lines.joined(every), np.tile(free, number)
        is_half = (part.place > 0.0) & (part.place < outline.size // 2)
        across = _across_axis(outline, 0)
        away, speed = dot(across, part.point - outline.vertices[0]), dot(across, part.direction)
        to_axis = away / np.maximum(np.stack((-speed, speed)), ROUND_OFF)
        own = np.where(is_half, np.minimum(free, to_axis + SLACK), free.min(axis=0))
        half = np.flatnonzero(is_half)[::-1]
        image = self.lines(part.take(half))
        every = [part, image.but(place=outline.size - image.place)]
        return Lines.joined(every), np.concatenate((own, own[::-1, half]), axis=1)

    def _across(self, outline: Outline, place: int, ahead: IntArray, shift: float) -> Lines:
        """Tangents across the axis at a place on it: of stretches from some vertices (N,) to their images."""
        vertices, direction = outline.vertices, _across_axis(outline, place)
        heights = dot(rotated_right(direction), vertices[: outline.size // 2 + 1] - vertices[place])
        highest = np.maximum.accumulate(heights if place == 0 else heights[::-1])
        rise = np.unique(highest[ahead if place == 0 else place - ahead]) + shift
        point = vertices[place] + rise[:, None] * rotated_right(direction)
        return Lines.of(point, np.full(len(rise), place), np.tile(direction, (len(rise), 1)))


def _across_axis(outline: Outline, place: int) -> FloatArray:
    """The direction (2,) across the axis of an outline at a place on it."""
    step = outline.vertices[place + 1] - outline.vertices[place - 1]
    across: FloatArray = step / norm(step)
    return across


class MirrorSearch(RingSearch):
    """The best symmetric cycles around one loop across an axis: paths along half of it, from one end to the other.

    A path takes a step to its first line, another from its last one, and one for each vertex of the cage: two for one
    that has an image, the first of which ends between lines. So one program finds the best cycles of all numbers.
    """

    def __init__(self, size: int, lines: Lines, free: FloatArray, found: Turns, minimum: int, most: int) -> None:
        """lines: of one half and their images. free: (2, K) what is free of each. found: the turns between them.

        size: of the outline. minimum, most: of the number of lines.
        """
        self.lines, self.free, self.turns = lines, free, found
        self.minimum, self.most, self.count = minimum, min(most, len(lines)), len(lines)
        self._forget()
        middle = 0.5 * size
        self.half = int((lines.place <= middle).sum())
        self.first, self.last = np.flatnonzero(lines.place == 0.0), np.flatnonzero(lines.place == middle)
        own = (lines.place == 0.0) | (lines.place == middle)
        every = np.arange(len(lines))
        self.image: IntArray = np.where(own, every, len(lines) - 1 + len(self.first) - every)

    def solve(self) -> Iterator[list[Paths]]:
        """Search from scratch, after changes of `free`."""
        areas, source, target, half = self.turns.within(self.free), self.turns.source, self.turns.target, self.half
        mirrored, onward = self.image[source] == target, (source < target) & (target < half)
        begins, ends = mirrored & (source > target), mirrored & (source < target)
        every, axis = np.arange(half), 2 * half + 1
        steps = (  # to a line k comes 2 k + 2, to the vertex before it 2 k + 1
            (0, 2 * self.first + 2, 0.0),
            (0, 2 * target[begins] + 1, areas[begins]),
            (2 * every + 1, 2 * every + 2, 0.0),
            (2 * source[onward] + 2, 2 * target[onward] + 1, 2.0 * areas[onward]),
            (2 * source[ends] + 2, axis, areas[ends]),
            (np.append(2 * self.last + 2, axis), 0, 0.0),
        )
        start, end, area = map(np.concatenate, zip(*(np.broadcast_arrays(*step) for step in steps), strict=True))
        order = np.argsort(end, kind="stable")
        start, end, area = start[order], end[order], area[order].astype(np.float32)
        paths = Paths(Graph.of(start, end, area, axis + 1), 0, self.most + 2)
        yield [paths]
        self._forget()
        self.totals[self.minimum :] = paths.totals[2 + self.minimum :]
        self.found = dict.fromkeys(np.flatnonzero(np.isfinite(self.totals)).tolist(), paths)

    def improve(self, number: int, *, roughly: bool = False) -> Iterator[list[Paths]]:
        """The search knows no better cycle."""
        return iter(())

    def refine(self, number: int) -> Iterator[list[Paths]]:
        """The search knows no better cycle."""
        return iter(())

    def reroute(self, number: int) -> Iterator[list[Paths]]:
        """Search from scratch."""
        return self.solve()

    def cycle(self, number: int) -> IntArray:
        """(number,) the lines of the best cycle, ascending."""
        half = np.unique((self.found[number].cycle(number + 2)[1:] - 1) // 2)
        half = half[half < self.half]
        lines: IntArray = np.unique(np.concatenate((half, self.image[half])))
        return lines

    def symmetrise(self) -> None:
        """Let what is free of a line be free of its image."""
        self.free = np.minimum(self.free, self.free[::-1, self.image])
