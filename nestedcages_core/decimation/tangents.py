"""Candidate lines of one outline: tangents of stretches, long edges, lines over pockets, lines about tips."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import near_pairs
from ..geometry.convex_hull import convex_hull
from ..geometry.precision import INPUT_ROUND_OFF, ROUND_OFF
from ..geometry.vectors import cross, norm
from .outline import Lines, Outline
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

ALL_PAIRS, LONGEST_LINE, SAMPLES_PER_LINE = 512, 4.0, 3.0
"""Samples up to which lines over pockets are sought among all pairs; otherwise the longest of them, in mean edges of
the cage, which has about as many samples."""


def tangents(outline: Outline, at: IntArray, longest: float, shift: float, *, corners: bool = False) -> Lines:
    """The candidate lines of an outline with samples at some vertices (N,), in order.

    longest: of the stretches, in samples. shift: distance that lines will keep from the outline.
    corners: whether the outline is convex, and lines through its corners are wanted.
    """
    parts = [*_along_edges(outline, len(at), shift), *_over_pockets(outline, at), _about_tips(outline, at, shift)]
    if corners:
        parts.append(_at_corners(outline, at))
    if len(outline.pins):
        parts.append(_through_pins(outline, at))
    stretches = EVERY_STRETCH if outline.is_hole else STRETCHES
    stretches = stretches[(len(at) > stretches) & (longest >= stretches)]
    last = at[(np.arange(len(at)) + stretches[:, None]) % len(at)]
    last += np.where(last <= at, outline.size, 0)
    parts.append(supporting_lines(outline, np.tile(at, len(stretches)), last.ravel()))
    lines = Lines.joined(parts).ordered(outline)
    return lines.beside_pins(outline) if len(outline.pins) else lines


def supporting_lines(outline: Outline, first: IntArray, last: IntArray, direction: FloatArray | None = None) -> Lines:
    """Tangents of stretches of vertices first .. last, which may pass the end of the outline, along their chords, or
    along given directions (K, 2)."""
    if direction is None:
        direction = outline.vertices[last % outline.size] - outline.vertices[first]
    length = norm(direction)
    sound = length > 0.0
    first, last, direction = first[sound], last[sound], direction[sound] / length[sound, None]
    if len(first) == 0:
        return Lines.of(np.zeros((0, 2)), first, direction)
    counts = last - first + 1
    begins, stretch = np.cumsum(counts) - counts, np.repeat(np.arange(len(counts)), counts)
    vertex = np.arange(len(stretch)) + (first - begins).take(stretch)
    x, y = (np.tile(outline.vertices, (2, 1)) - outline.vertices[0]).T.take(vertex, axis=1)
    u, v = direction.T
    height = v.take(stretch) * x - u.take(stretch) * y
    least = np.maximum.reduceat(height, begins) - INPUT_ROUND_OFF * length.max()
    touched = np.flatnonzero(height >= least.take(stretch))
    new = np.flatnonzero(np.diff(stretch.take(touched), prepend=-1))
    one, two = touched.take(new), touched.take(np.append(new[1:], len(touched)) - 1)
    middle = 0.5 * np.stack((x.take(one) + x.take(two), y.take(one) + y.take(two)), axis=1) + outline.vertices[0]
    return Lines.of(middle, 0.5 * (vertex.take(one) + vertex.take(two)), direction)


def _along_edges(outline: Outline, count: int, shift: float) -> list[Lines]:
    """Lines of long edges, at their middles and at their convex ends, beyond which neighbours may meet them; and next
    to the reflex ends of longer ones, since in pockets neighbours may meet them before."""
    edge = np.flatnonzero(outline.lengths > LONG_EDGE * outline.length / count)
    if len(edge) > 2 * count:
        edge = np.argsort(-np.round(outline.lengths, DECIMALS), kind="stable")[: 2 * count]
    convex = cross(np.roll(outline.edges, 1, axis=0), outline.edges) > 0.0
    start, ahead, length = outline.vertices[edge], outline.edges[edge], outline.lengths[edge]
    direction = ahead / length[:, None]
    deep = length > DEEP_EDGE * outline.length / count
    inwards = np.minimum(FORWARD * shift / length, 0.25)

    def at(part: FloatArray, which: BoolArray) -> Lines:
        return Lines.of(start + part[:, None] * ahead, edge + part, direction, length).take(which)

    lines = [at(np.full(len(edge), 0.5), np.ones(len(edge), bool))]
    for end, is_convex in ((0.0, convex[edge]), (1.0, convex[(edge + 1) % outline.size])):
        lines.append(at(np.where(is_convex, end, np.abs(end - inwards)), is_convex | deep))
    return lines


def _over_pockets(outline: Outline, at: IntArray) -> list[Lines]:
    """Lines that touch the outline at two samples, over the pockets of least area; by each of the two contacts."""
    here, count = outline.vertices[at], len(at)
    before, after = outline.vertices[at - 1] - here, outline.vertices[(at + 1) % outline.size] - here
    if count <= ALL_PAIRS:
        i, j = (each.ravel() for each in np.indices((count, count)))
    else:  # lines of a cage of so many vertices are short
        i, j = near_pairs(here, here, here, LONGEST_LINE * SAMPLES_PER_LINE * outline.length / count)
    dx, dy = (here[j] - here[i]).T
    slack = -ROUND_OFF * float((dx * dx + dy * dy).max())
    touching = (np.mod(j - i - 1, count) <= count - 2) & ((dx != 0.0) | (dy != 0.0))
    for neighbour in (before[i], after[i], before[j], after[j]):
        touching &= dx * neighbour[:, 1] - dy * neighbour[:, 0] >= slack
    i, j = i[touching], j[touching]
    own, swept = here - outline.vertices[0], outline.swept[at]
    area = cross(own[i], own[j]) - (swept[j] - swept[i] + np.where(j < i, outline.swept[-1], 0.0))
    i, j, area = i[area > 0.0], j[area > 0.0], area[area > 0.0]
    least = np.argsort(np.round(area, DECIMALS), kind="stable")
    least, rest = least[:count], least[count:]
    if len(rest):  # edges of the convex hull are candidates whatever their pockets
        hull = here[convex_hull(here)]
        beyond = cross((here[j] - here[i])[rest][:, None], hull[None] - here[i[rest]][:, None]) >= slack
        least = np.concatenate((least, rest[beyond.all(axis=1)]))
    i, j = i[least], j[least]
    span = norm(here[j] - here[i])
    direction = (here[j] - here[i]) / span[:, None]
    skipped = np.mod(at[j] - at[i], outline.size).astype(np.float64)
    over = Lines.of(here[j], at[j], direction, span).but(skipped=skipped)
    return [Lines.of(here[i], at[i], direction, span), over]


def _about_tips(outline: Outline, at: IntArray, shift: float) -> Lines:
    """Lines through tips, turned from their edges ever less, until the shift decides."""
    turn = outline.turned(at, outline.edges[at])
    at, turn = at[turn > TIP], turn[turn > TIP]
    tilt, edge = TILTS[:, None, None] * turn, np.stack((at - 1, at))
    chosen = tilt * outline.lengths[edge] > shift
    angle = (outline.angles[edge] + np.array([[1.0], [-1.0]]) * tilt)[chosen]
    return _through_vertices(outline, np.broadcast_to(at, chosen.shape)[chosen], angle)


def _at_corners(outline: Outline, at: IntArray) -> Lines:
    """Lines through corners of a convex outline, turned between their edges."""
    turn = outline.turned(at, outline.edges[at])
    number = MAX_AT_CORNERS // len(at)
    angle = outline.angles[at - 1][:, None] + (np.arange(number) + 0.5) / max(1, number) * turn[:, None]
    return _through_vertices(outline, np.repeat(at, number), angle.ravel())


def _through_pins(outline: Outline, at: IntArray) -> Lines:
    """Lines through the pins that touch stretches before and after them."""
    parts = []
    for pin in outline.pins.tolist():
        for sign in (1, -1):
            number = np.mod(sign * (at - pin), outline.size)
            steps = np.unique(number[number > 0])[: STRETCHES.max()]
            ends = steps[STRETCHES[len(steps) >= STRETCHES] - 1]
            vertex = (pin + sign * np.arange(1, ends.max() + 1)) % outline.size
            to = sign * (outline.vertices[vertex] - outline.vertices[pin])
            angle = np.unwrap(np.arctan2(to[:, 1], to[:, 0]))
            steepest = np.minimum.accumulate(angle) if sign > 0 else np.maximum.accumulate(angle)
            parts.append(_through_vertices(outline, np.full(len(ends), pin), steepest[ends - 1]))
    return Lines.joined(parts)


def _through_vertices(outline: Outline, vertex: IntArray, angle: FloatArray) -> Lines:
    """Lines through vertices at angles to the x axis."""
    return Lines.of(outline.vertices[vertex], vertex, np.stack((np.cos(angle), np.sin(angle)), axis=1))
