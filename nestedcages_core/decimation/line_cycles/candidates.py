"""Candidate lines of one loop: tangents of stretches, long edges, lines over pockets, lines about tips."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import TINY, FloatArray, IntArray
from ...geometry.precision import INPUT_ROUND_OFF, ROUND_OFF
from ...geometry.vectors import cross, dot, norm
from .chain import Chain, Lines
from .places import DECIMALS

STRETCHES = (1, 2, 3, 4, 6, 9, 13, 19, 28, 40, 60)
"""Lengths of stretches, in places: about a factor of √2 apart."""

LONG_EDGE = 0.3
"""Length, in mean distances of places, from which an edge is a candidate itself."""

TILTS = tuple(0.5 * 3.0**-k for k in range(9))
"""Turns of lines about tips, in turns of the corner: down to what a needle of a ten-thousandth needs."""

TIP = 2.0
"""Turn of a corner, in radians, from which it is a tip."""

MOST_AT_CORNERS = 60
"""Lines through the corners of a convex loop, at most."""

BLOCK_EDGES = 16
"""Consecutive edges that rays look at together."""


def candidates(chain: Chain, at: IntArray, longest: float, shift: float, *, corners: bool = False) -> Lines:
    """The candidate lines of a chain with places at some vertices (N,), in order.

    longest: of the stretches, in places. shift: distance that lines will keep from the chain.
    corners: whether the chain is convex, and lines through its corners are wanted.
    """
    parts = [*_along_edges(chain, len(at)), *_over_pockets(chain, at), *_about_tips(chain, at, shift)]
    if corners:
        parts.append(_at_corners(chain, at))
    if len(chain.pins):
        parts.append(_through_pins(chain, at))
    for stretch in STRETCHES:
        if stretch < len(at) and stretch <= longest:
            last = np.roll(at, -stretch)
            parts.append(supporting_lines(chain, at, np.where(last <= at, last + chain.size, last)))
    lines = Lines.joined(parts).ordered(chain)
    return lines.beside_pins(chain) if len(chain.pins) else lines


def supporting_lines(chain: Chain, first: IntArray, last: IntArray, direction: FloatArray | None = None) -> Lines:
    """Tangents of stretches of vertices first .. last, which may pass the end of the chain, along their chords, or
    along given directions (K, 2)."""
    if direction is None:
        direction = chain.vertices[last % chain.size] - chain.vertices[first]
    length = norm(direction)
    sound = length > 0.0
    first, last, direction = first[sound], last[sound], direction[sound] / length[sound, None]
    counts = last - first + 1
    begins, stretch = np.cumsum(counts) - counts, np.repeat(np.arange(len(counts)), counts)
    rows = np.arange(len(stretch))
    number = rows - begins[stretch]
    at = chain.vertices[(first[stretch] + number) % chain.size] - chain.vertices[0]
    height = direction[stretch, 1] * at[:, 0] - direction[stretch, 0] * at[:, 1]
    touched = height >= np.maximum.reduceat(height, begins)[stretch] - INPUT_ROUND_OFF * length.max()
    one = np.minimum.reduceat(np.where(touched, rows, len(rows)), begins)
    two = np.maximum.reduceat(np.where(touched, rows, -1), begins)
    middle = 0.5 * (at[one] + at[two]) + chain.vertices[0]
    return Lines.of(middle, first + 0.5 * (number[one] + number[two]), direction)


def _along_edges(chain: Chain, count: int) -> list[Lines]:
    """Lines of long edges, at their middles and at their convex ends, beyond which neighbours may meet them."""
    edge = np.flatnonzero(chain.lengths > LONG_EDGE * chain.length / count)
    edge = (
        edge if len(edge) <= 2 * count else np.argsort(-np.round(chain.lengths, DECIMALS), kind="stable")[: 2 * count]
    )
    convex = cross(np.roll(chain.edges, 1, axis=0), chain.edges) > 0.0
    start, ahead = chain.vertices[edge], chain.edges[edge]
    direction = ahead / chain.lengths[edge, None]
    lines = [Lines.of(start + part * ahead, np.asarray(edge + part, np.float64), direction) for part in (0.0, 0.5, 1.0)]
    return [lines[1], lines[0].take(convex[edge]), lines[2].take(convex[(edge + 1) % chain.size])]


def _over_pockets(chain: Chain, at: IntArray) -> list[Lines]:
    """Lines that touch the chain at two places, over the pockets of least area; by each of the two contacts."""
    here, count = chain.vertices[at], len(at)
    before, after = chain.vertices[at - 1] - here, chain.vertices[(at + 1) % chain.size] - here
    x, y = here.T
    dx, dy = x - x[:, None], y - y[:, None]
    slack = -ROUND_OFF * float((dx * dx + dy * dy).max())
    touching = (np.mod(np.arange(count)[None] - np.arange(count)[:, None] - 1, count) <= count - 2) & (
        (dx != 0.0) | (dy != 0.0)
    )
    for neighbour in (before[:, None], after[:, None], before[None], after[None]):
        touching &= dx * neighbour[..., 1] - dy * neighbour[..., 0] >= slack
    i, j = np.nonzero(touching)
    own, swept = here - chain.vertices[0], chain.swept[at]
    area = cross(own[i], own[j]) - (swept[j] - swept[i] + np.where(j < i, chain.swept[-1], 0.0))
    i, j, area = i[area > 0.0], j[area > 0.0], area[area > 0.0]
    least = np.argsort(np.round(area, DECIMALS), kind="stable")
    rest = least[count:]  # of which those of the convex hull are kept
    beyond = cross((here[j] - here[i])[rest][:, None], here[None] - here[i[rest]][:, None]) >= slack
    least = np.concatenate((least[:count], rest[beyond.all(axis=1)]))
    i, j = i[least], j[least]
    direction: FloatArray = (here[j] - here[i]) / norm(here[j] - here[i])[:, None]
    passed = np.mod(at[j] - at[i], chain.size).astype(np.float64)
    return [
        Lines(here[k], at[k].astype(np.float64), direction, over) for k, over in ((i, np.zeros(len(i))), (j, passed))
    ]


def _about_tips(chain: Chain, at: IntArray, shift: float) -> list[Lines]:
    """Lines through tips, turned from their edges ever less, until the shift decides."""
    turn = chain.turned(at, chain.edges[at])
    at, turn = at[turn > TIP], turn[turn > TIP]
    parts = []
    for tilt in TILTS:
        for edge, sign in ((at - 1, 1.0), (at, -1.0)):
            some = tilt * turn * chain.lengths[edge] > shift
            angle = chain.angles[edge[some]] + sign * tilt * turn[some]
            direction = np.stack((np.cos(angle), np.sin(angle)), axis=1)
            parts.append(Lines.of(chain.vertices[at[some]], at[some].astype(np.float64), direction))
    return parts


def _at_corners(chain: Chain, at: IntArray) -> Lines:
    """Lines through corners of a convex chain, turned between their edges."""
    turn = chain.turned(at, chain.edges[at])
    parts = (np.arange(MOST_AT_CORNERS // len(at)) + 0.5) / max(1, MOST_AT_CORNERS // len(at))
    angle = (chain.angles[at - 1][:, None] + parts * turn[:, None]).ravel()
    corner = np.repeat(at, len(parts))
    direction = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return Lines.of(chain.vertices[corner], corner.astype(np.float64), direction)


def _through_pins(chain: Chain, at: IntArray) -> Lines:
    """Lines through the pins that touch stretches before and after them."""
    parts = []
    for pin in chain.pins.tolist():
        for sign in (1, -1):
            number = np.mod(sign * (at - pin), chain.size)
            steps = np.unique(number[number > 0])[: max(STRETCHES)]
            ends = steps[[k - 1 for k in STRETCHES if k <= len(steps)]]
            to = sign * (chain.vertices[(pin + sign * np.arange(1, ends.max() + 1)) % chain.size] - chain.vertices[pin])
            angle = np.unwrap(np.arctan2(to[:, 1], to[:, 0]))
            steepest = np.minimum.accumulate(angle) if sign > 0 else np.maximum.accumulate(angle)
            chosen = steepest[ends - 1]
            direction = np.stack((np.cos(chosen), np.sin(chosen)), axis=1)
            point = np.tile(chain.vertices[pin], (len(ends), 1))
            parts.append(Lines.of(point, np.full(len(ends), float(pin)), direction))
    return Lines.joined(parts)


class Obstacles:
    """All loops of an outline, in blocks of edges with circles around them. Unit: the outline's diameter."""

    def __init__(self, loops: list[FloatArray], regions: IntArray) -> None:
        """regions: (L,) the empty region that each loop bounds."""
        # the last edge of each loop is repeated, so that no block has edges of two loops
        padded = [np.minimum(np.arange(-(-len(loop) // BLOCK_EDGES) * BLOCK_EDGES), len(loop) - 1) for loop in loops]
        self.region = np.repeat(regions, [len(order) for order in padded])
        self.starts = np.concatenate([loop[order] for loop, order in zip(loops, padded, strict=True)])
        self.ends = np.concatenate([loop[(order + 1) % len(loop)] for loop, order in zip(loops, padded, strict=True)])
        blocks = np.stack((self.starts.reshape(-1, BLOCK_EDGES, 2), self.ends.reshape(-1, BLOCK_EDGES, 2)), axis=1)
        self.blocks: FloatArray = blocks.reshape(-1, 2 * BLOCK_EDGES, 2)
        self.centres: FloatArray = self.blocks.mean(axis=1)
        self.radii: FloatArray = norm(self.blocks - self.centres[:, None]).max(axis=1) + ROUND_OFF

    def free(self, lines: Lines, reach: float, region: int, distance: float) -> FloatArray:
        """(2, K) how far each line runs from its point forwards and backwards, at most the reach.

        distance: that it keeps from all edges; 0: it meets none.

        Negative where the point lies in the solid, too close to it, or in another empty region.
        """
        right, origin = lines.right, lines.point
        level = (right * origin).sum(axis=1)
        # the blocks that a ray of any of these lines can reach
        middle = 0.5 * (origin.min(axis=0) + origin.max(axis=0))
        around = float(norm(origin - middle).max()) + reach + distance
        close = np.flatnonzero(norm(self.centres - middle) <= around + self.radii)
        k, block = np.nonzero(np.abs(level[:, None] - right @ self.centres[close].T) <= self.radii[close] + distance)
        block = close[block]
        near = self.blocks[block]
        heights = level[k, None] - (right[k, 0, None] * near[:, :, 0] + right[k, 1, None] * near[:, :, 1])
        left = heights > 0.0
        hit, edge = np.nonzero(left[:, :BLOCK_EDGES] != left[:, BLOCK_EDGES:])
        here, there, left = heights[hit, edge], heights[hit, BLOCK_EDGES + edge], left[hit, edge]
        ray, edge = k[hit], block[hit] * BLOCK_EDGES + edge
        start = self.starts[edge]
        crossing = start + (self.ends[edge] - start) * (here / (here - there))[:, None]
        along = ((crossing - origin[ray]) * lines.direction[ray]).sum(axis=1)
        way, length = (along < 0.0).astype(np.int64), np.abs(along)
        free, leaving = np.full((2, 2, len(lines)), reach)
        np.minimum.at(free, (way, ray), length)
        out = (left == (along < 0.0)) | (self.region[edge] != region)
        np.minimum.at(leaving, (way[out], ray[out]), length[out])
        inside = ((leaving <= free) & (leaving < reach)).any(axis=0)
        if distance > 0.0:
            free = np.minimum(free, self._to_distance(distance, lines, k, block, heights))
        return np.where(inside, -1.0, free)

    def _to_distance(self, d: float, lines: Lines, k: IntArray, block: IntArray, heights: FloatArray) -> FloatArray:
        """(2, K) how far each line keeps a distance d forwards and backwards; -1 where its point does not.

        k, block: (P,) lines and blocks that can meet; heights: (P, 2 * BLOCK_EDGES) of the starts and ends of the edges
        of these over the lines. Those points of a line that are closer than d to an edge end at a + (d² - h²)½, for the
        point of the edge, at the place a along the line and the height h, where this is largest: at an end of the edge,
        or where h = d cos α, with its angle α to the line. They begin likewise.
        """
        here, there = heights[:, :BLOCK_EDGES], heights[:, BLOCK_EDGES:]
        row, edge = np.nonzero((np.minimum(here, there) < d) & (np.maximum(here, there) > -d))
        here, there, k, edge = here[row, edge], there[row, edge], k[row], block[row] * BLOCK_EDGES + edge
        start = dot(self.starts[edge] - lines.point[k], lines.direction[k])
        run, rise = dot(self.ends[edge] - self.starts[edge], lines.direction[k]), there - here
        low, high = np.minimum(here, there), np.maximum(here, there)
        steepest, level = d * np.copysign(run, run * rise) / np.maximum(np.hypot(run, rise), TINY), rise == 0.0
        bounds = []
        for sign in (-1.0, 1.0):
            height = np.clip(sign * steepest, low, high)
            part = np.where(level, sign * run > 0.0, (height - here) / np.where(level, 1.0, rise))
            bounds.append(start + part * run + sign * np.sqrt(np.maximum(d**2 - height**2, 0.0)))
        begin, end = bounds
        kept = np.full((2, len(lines)), np.inf)
        for way, first, last in ((0, begin, end), (1, -end, -begin)):
            ahead = last > 0.0
            np.minimum.at(kept[way], k[ahead], np.where(first > 0.0, first, -1.0)[ahead])
        return kept
