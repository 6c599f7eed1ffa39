"""Candidate lines of outlines: tangents of stretches, long edges, lines over pockets, lines about tips."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import near_pairs, position_in_group
from ..geometry.convex_hull import convex_hull
from ..geometry.precision import INPUT_ROUND_OFF, ROUND_OFF
from ..geometry.vectors import cross, norm
from .outline import Lines, Outline, largest
from .sampling import DECIMALS

STRETCHES = np.array((1, 2, 3, 4, 6, 9, 13, 19, 28, 40, 60))
"""Lengths of stretches, in samples: about a factor of √2 apart."""

EVERY_STRETCH = np.array((*range(1, 15), *STRETCHES[7:]))
"""Those of holes, whose lines touch stretches at their ends: nothing evens their lengths out."""

LONG_EDGE = 0.3
"""Length, in mean distances of samples, from which an edge is a candidate itself."""

DEEP_EDGE = 0.7
"""The same of edges in pockets, which neighbours may meet anywhere."""

FORWARD = 8.0
"""Distance of their contacts from reflex ends, in shifts, so that neighbours there can meet before them."""

TILTS = 0.5 * 9.0 ** -np.arange(5)
"""Turns of lines about tips, in turns of the corner: down to what a needle of a ten-thousandth needs."""

TIP = 2.0
"""Turn of a corner, in radians, from which it is a tip."""

MAX_AT_CORNERS = 60
"""Maximum number of lines through the corners of a convex outline."""

FEW_SAMPLES, MANY_SAMPLES, BLOCK_PAIRS = 64, 1024, 2**15
"""Samples of a loop up to which its pairs are looked at with those of other loops, and from which near ones are sought;
pairs of a block otherwise."""

SHORT = 0.1
"""Length of lines in diameters of the loop up to which near ones are few."""

ALL_PAIRS, LONGEST_LINE = 512, 12.0
"""Samples of a loop up to which lines over its pockets may have any length; otherwise the longest, in mean distances of
samples, of which a cage has about three an edge."""


class Samples:
    """Vertices of an outline at which stretches begin, in order."""

    def __init__(self, outline: Outline, at: IntArray) -> None:
        """at: (N,) ascending vertices."""
        self.at, self.loop, loops = at, outline.loop[at], len(outline.sizes)
        self.counts: IntArray = np.bincount(self.loop, minlength=loops)
        """(L,) samples of each loop."""
        self.begins: IntArray = np.cumsum(self.counts) - self.counts
        self.spacing: FloatArray = outline.perimeters / self.counts
        """(L,) the mean distance of samples."""
        self.longest: FloatArray = np.where(self.counts > ALL_PAIRS, LONGEST_LINE * self.spacing, np.inf)
        """(L,) largest length of lines over pockets."""

    def after(self, steps: IntArray) -> IntArray:
        """(..., N) the numbers of the samples that are some steps ahead of each on its loop."""
        begin = self.begins[self.loop]
        return np.asarray(begin + np.mod(np.arange(len(self.at)) - begin + steps, self.counts[self.loop]))

    def pairs(self, points: FloatArray, kept: BoolArray) -> Iterator[tuple[IntArray, IntArray]]:
        """The pairs of some samples (N,) of the same loop at points (N, 2), as far as `longest`, to be broadcast."""
        others = np.where(self.counts <= FEW_SAMPLES, self.counts, 0)[self.loop]
        i = np.repeat(np.arange(len(others)), others)
        j = self.begins[self.loop[i]] + position_in_group(others)
        both = kept[i] & kept[j]
        yield i[both], j[both]
        for k in np.flatnonzero(self.counts > FEW_SAMPLES).tolist():
            own = self.begins[k] + np.flatnonzero(kept[self.begins[k] : self.begins[k] + self.counts[k]])
            if len(own) > MANY_SAMPLES and self.longest[k] < SHORT * np.ptp(points[own], axis=0).max():
                i, j = near_pairs(points[own], points[own], points[own], float(self.longest[k]))
                yield own[i], own[j]
                continue
            for first in range(0, len(own), rows := 1 + BLOCK_PAIRS // (1 + len(own))):
                yield own[first : first + rows, None], own


def tangents(outline: Outline, at: IntArray, longest: FloatArray, shift: FloatArray, corners: BoolArray) -> Lines:
    """The candidate lines of an outline with samples at some vertices (N,) of each loop, in order.

    longest: (L,) of the stretches, in samples. shift: (L,) distance that lines will keep from each loop.
    corners: (L,) loops that are convex, and lines through whose corners are wanted.
    """
    some = Samples(outline, at)
    parts = [*_along_edges(outline, some, shift), *_over_pockets(outline, some), _about_tips(outline, at, shift)]
    if corners.any():
        parts.append(_at_corners(outline, some, corners))
    if len(outline.pins):
        parts.append(_through_pins(outline, some))
    stretches, loop = EVERY_STRETCH[:, None], some.loop
    usual = np.isin(stretches, STRETCHES) | outline.is_hole[loop]
    long, first = np.nonzero(usual & (some.counts[loop] > stretches) & (longest[loop] >= stretches))
    last = at[some.after(stretches)[long, first]]
    first = at[first]
    last += np.where(last <= first, outline.sizes[outline.loop[first]], 0)
    parts.append(supporting_lines(outline, first, last))
    lines = Lines.joined(parts).ordered(outline)
    return lines.beside_pins(outline) if len(outline.pins) else lines


def supporting_lines(outline: Outline, first: IntArray, last: IntArray, direction: FloatArray | None = None) -> Lines:
    """Tangents of stretches of vertices first .. last, which may pass the end of their loop, along their chords, or
    along given directions (K, 2)."""
    loop = outline.loop[first]
    twice = outline.vertices[outline.twice]  # no stretch passes the end of this
    first, last = first + outline.begins[loop], last + outline.begins[loop]
    if direction is None:
        direction = twice[last] - twice[first]
    length = norm(direction)
    sound = length > 0.0
    first, last, loop, direction = first[sound], last[sound], loop[sound], direction[sound] / length[sound, None]
    if len(first) == 0:
        return Lines.of(np.zeros((0, 2)), first, direction)
    counts = last - first + 1
    begins, stretch = np.cumsum(counts) - counts, np.repeat(np.arange(len(counts)), counts)
    vertex = np.arange(len(stretch)) + (first - begins).take(stretch)
    x, y = (twice - outline.vertices[0]).T.take(vertex, axis=1)
    u, v = direction.T
    height = v.take(stretch) * x - u.take(stretch) * y
    least = np.maximum.reduceat(height, begins) - INPUT_ROUND_OFF * length.max()
    touched = np.flatnonzero(height >= least.take(stretch))
    new = np.flatnonzero(np.diff(stretch.take(touched), prepend=-1))
    one, two = touched.take(new), touched.take(np.append(new[1:], len(touched)) - 1)
    middle = 0.5 * np.stack((x.take(one) + x.take(two), y.take(one) + y.take(two)), axis=1) + outline.vertices[0]
    place = 0.5 * (vertex.take(one) + vertex.take(two)) - outline.begins[loop]
    return Lines.of(middle, outline.wrapped(place, loop), direction)


def _along_edges(outline: Outline, some: Samples, shift: FloatArray) -> list[Lines]:
    """Lines of long edges, at their middles and at their convex ends, beyond which neighbours may meet them; and next
    to the reflex ends of longer ones, since in pockets neighbours may meet them before."""
    loop = outline.loop
    long = outline.lengths > LONG_EDGE * some.spacing[loop]
    edge = np.flatnonzero(long & largest(np.round(outline.lengths, DECIMALS), loop, 2 * some.counts))
    loop, ends = loop[edge], outline.loops.ahead[edge]
    convex = cross(outline.edges[outline.loops.back], outline.edges) > 0.0
    start, ahead, length = outline.vertices[edge], outline.edges[edge], outline.lengths[edge]
    direction = ahead / length[:, None]
    deep = length > DEEP_EDGE * some.spacing[loop]
    inwards = np.minimum(FORWARD * shift[loop] / length, 0.25)

    def at(part: FloatArray, which: BoolArray) -> Lines:
        place = outline.wrapped(edge + part, loop)
        return Lines.of(start + part[:, None] * ahead, place, direction, length).take(which)

    lines = [at(np.full(len(edge), 0.5), np.ones(len(edge), bool))]
    for end, is_convex in ((0.0, convex[edge]), (1.0, convex[ends])):
        lines.append(at(np.where(is_convex, end, np.abs(end - inwards)), is_convex | deep))
    return lines


def _over_pockets(outline: Outline, some: Samples) -> list[Lines]:
    """Lines that touch a loop at two samples, over the pockets of least area; by each of the two contacts."""
    at, here, begins, counts = some.at, outline.vertices[some.at], some.begins, some.counts
    slack = -ROUND_OFF * float(outline.diameters.max()) ** 2
    (x, y), edges = here.T, [(outline.vertices[end[at]] - here).T for end in (outline.loops.back, outline.loops.ahead)]
    convex = cross(*(edge.T for edge in edges)) <= -slack  # lines that touch other corners run in the solid
    pairs: list[tuple[IntArray, IntArray]] = []
    for i, j in some.pairs(here, convex):
        dx, dy = x[j] - x[i], y[j] - y[i]
        squared, loop = dx * dx + dy * dy, some.loop[i]
        touching = (squared > 0.0) & (squared <= some.longest[loop] ** 2)
        for u, v in edges:
            for end in (i, j):
                touching &= dx * v[end] - dy * u[end] >= slack
        pairs.append((np.broadcast_to(i, dx.shape)[touching], np.broadcast_to(j, dx.shape)[touching]))
    i, j = (np.concatenate(each) for each in zip(*pairs, strict=True))
    loop = some.loop[i]
    own, swept = here - outline.origins[some.loop], outline.swept[at]
    area = cross(own[i], own[j]) - (swept[j] - swept[i] + np.where(j < i, outline.areas[loop], 0.0))
    i, j, loop, area = i[area > 0.0], j[area > 0.0], loop[area > 0.0], area[area > 0.0]
    least = largest(-np.round(area, DECIMALS), loop, counts)
    for k in np.unique(loop[~least]).tolist():  # edges of the convex hull are candidates whatever their pockets
        hull = here[begins[k] : begins[k] + counts[k]]
        hull, rest = hull[convex_hull(hull)], np.flatnonzero(~least & (loop == k))
        ends, place = np.unique((i[rest], j[rest]), return_inverse=True)
        ahead = np.roll(hull, -1, axis=0) - hull
        depth = (cross(ahead, here[ends][:, None] - hull) / norm(ahead)).min(axis=1).take(place.reshape(2, -1))
        rest = rest[depth.max(axis=0) * norm(here[j[rest]] - here[i[rest]]) <= -slack]
        beyond = cross((here[j] - here[i])[rest][:, None], hull[None] - here[i[rest]][:, None]) >= slack
        least[rest] = beyond.all(axis=1)
    i, j, loop = i[least], j[least], loop[least]
    span = norm(here[j] - here[i])
    direction = (here[j] - here[i]) / span[:, None]
    skipped = np.mod(at[j] - at[i], outline.sizes[loop]).astype(np.float64)
    over = Lines.of(here[j], at[j], direction, span).but(skipped=skipped)
    return [Lines.of(here[i], at[i], direction, span), over]


def _about_tips(outline: Outline, at: IntArray, shift: FloatArray) -> Lines:
    """Lines through tips, turned from their edges ever less, until the shift decides."""
    turn = outline.turned(at, outline.edges[at])
    at, turn = at[turn > TIP], turn[turn > TIP]
    tilt, edge = TILTS[:, None, None] * turn, np.stack((outline.loops.back[at], at))
    chosen = tilt * outline.lengths[edge] > shift[outline.loop[at]]
    angle = (outline.angles[edge] + np.array([[1.0], [-1.0]]) * tilt)[chosen]
    return _through_vertices(outline, np.broadcast_to(at, chosen.shape)[chosen], angle)


def _at_corners(outline: Outline, some: Samples, corners: BoolArray) -> Lines:
    """Lines through corners of convex loops, turned between their edges."""
    numbers = np.where(corners, MAX_AT_CORNERS // some.counts, 0)[some.loop]
    at = np.repeat(some.at, numbers)
    part = (position_in_group(numbers) + 0.5) / np.repeat(numbers, numbers)
    angle = outline.angles[outline.loops.back[at]] + part * outline.turned(at, outline.edges[at])
    return _through_vertices(outline, at, angle)


def _through_pins(outline: Outline, some: Samples) -> Lines:
    """Lines through the pins that touch stretches before and after them."""
    parts = []
    for pin in outline.pins.tolist():
        loop = int(outline.loop[pin])
        begin, size, at = int(outline.begins[loop]), int(outline.sizes[loop]), some.at[some.loop == loop]
        for sign in (1, -1):
            number = np.mod(sign * (at - pin), size)
            steps = np.unique(number[number > 0])[: STRETCHES.max()]
            ends = steps[STRETCHES[len(steps) >= STRETCHES] - 1]
            vertex = begin + (pin - begin + sign * np.arange(1, ends.max() + 1)) % size
            to = sign * (outline.vertices[vertex] - outline.vertices[pin])
            angle = np.unwrap(np.arctan2(to[:, 1], to[:, 0]))
            steepest = np.minimum.accumulate(angle) if sign > 0 else np.maximum.accumulate(angle)
            parts.append(_through_vertices(outline, np.full(len(ends), pin), steepest[ends - 1]))
    return Lines.joined(parts)


def _through_vertices(outline: Outline, vertex: IntArray, angle: FloatArray) -> Lines:
    """Lines through vertices at angles to the x axis."""
    return Lines.of(outline.vertices[vertex], vertex, np.stack((np.cos(angle), np.sin(angle)), axis=1))
