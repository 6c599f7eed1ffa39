"""Moves along chords of the outline, between cage vertices on it."""

from __future__ import annotations

import numpy as np

from .nodes import CORNER, ENTER, LEAVE, Nodes
from .outline import LOWER, cross

ALLOWED = ((CORNER, CORNER), (CORNER, LEAVE), (ENTER, CORNER), (ENTER, LEAVE))
"""Kinds of both ends."""
STRICTLY = 1e-11
"""Cross product above which a point lies off a line."""
INWARD = 1e-12
"""Cross product above which a chord leaves a vertex into the solid."""
LONGEST_CUT = 4
"""Most edges of a part of the outline that is tried as a cut through chords."""
SPARSE = 8
"""Every so many edges are tried first."""
CHUNK = 2_000_000
"""Pairs of chords and edges that are looked at in one go."""


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
