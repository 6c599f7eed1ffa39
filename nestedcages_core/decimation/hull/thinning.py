"""Thinning: rounds of the moves of a progressive hull, many at once, in arrays; for outlines of many vertices.

A round makes all moves that are the cheapest on their stretch and whose added triangles touch neither other edges nor
each other, so they could also be made one by one in any order. A move takes a tenth of the time of `ProgressiveHull`,
but the order is only roughly cheapest first: `ProgressiveHull` makes the last moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.predicates import BoxTree, orientation
from ...geometry.vectors import cross, norm
from ...tasks import Stage, drain
from ..outline import Outline
from .hull_moves import SMALLEST_DIVISOR, TURN_ROUNDING, Weights
from .linked_loops import MARGIN_ULPS
from .progressive_hull import NEGLIGIBLE_AREA, NUDGE_ULPS

LARGE = 3000
"""Size of an outline from which thinning pays: the hull at 4,000 vertices takes 0.4 of the time, at 8,000 0.3."""

MIN_SIZE_LEFT, SIZE_FACTOR_LEFT = 400, 8
"""Size of the outline that thinning leaves: a minimum, and a multiple of the wanted number of vertices. Both are about
twice what the restarts of the search begin at; excess did not change with more."""

SMALLEST_LOOP = 16
"""Number of vertices below which a loop is not thinned."""

COSTS_PER_OCTAVE = 4.0
"""Classes of cost per factor of two. Within a class moves are chosen at random: along smooth curves cost changes so
slowly that few moves are cheaper than all others around them."""

STALLED_SHARE = 0.005
"""Fraction of the vertices that a round has to remove, unless fewer are too many, for another one to follow."""


class _Moves(NamedTuple):
    """K moves: the vertex b is dropped, or moved to a point and the vertex after it removed."""

    vertex: IntArray
    """(K,) b."""
    extends: BoolArray
    """(K,) whether it is moved."""
    convex: BoolArray
    """(K,) whether it is moved and both it and the vertex after it are convex: edges may enter from outside."""
    point: FloatArray
    """(K, 2) where it is moved to, or where it is."""
    cost: FloatArray
    """(K,) area, weighted."""

    def chosen(self, which: BoolArray | IntArray) -> _Moves:
        """Some of them."""
        vertex, extends, convex, point, cost = self
        return _Moves(vertex[which], extends[which], convex[which], point[which], cost[which])


def thinned(outline: Outline, count: int, minimum: Sequence[int], weights: Weights) -> Outline:
    """A large outline with fewer vertices, by moves that only add area; small outlines are returned unchanged.

    count: the number of vertices that is wanted in the end; several times as many are left. minimum: vertices that each
    loop keeps. weights: of the costs, without noise or factors per loop; there are no pivots.
    """
    return drain(thinning_rounds(outline, count, minimum, weights))


def thinning_rounds(outline: Outline, count: int, minimum: Sequence[int], weights: Weights) -> Stage[None, Outline]:
    """`thinned` as a generator that yields before every round."""
    if len(outline.vertices) < LARGE:
        return outline
    count = max(MIN_SIZE_LEFT, SIZE_FACTOR_LEFT * count)
    random = np.random.default_rng(weights.seed)
    ulp = float(np.spacing(max(np.abs(outline.vertices).max(), weights.reach * outline.diameter)))
    centre, reach = outline.centre, weights.reach * outline.diameter
    while len(outline.vertices) > count:
        yield
        loop = np.repeat(np.arange(len(outline.sizes)), outline.sizes)
        large = np.array(outline.sizes) >= np.maximum(2 * np.array(minimum), SMALLEST_LOOP)
        moves = _cheapest_at(outline, large[loop], weights, centre, reach)
        moves = _one_per_stretch(outline, moves, random)
        moves = _outward(outline, moves, ulp)
        moves = _unblocked(outline, moves, MARGIN_ULPS * ulp)
        excess = len(outline.vertices) - count
        if len(moves.vertex) > excess:
            moves = moves.chosen(np.sort(np.argsort(moves.cost, kind="stable")[:excess]))
        if len(moves.vertex) < min(excess, STALLED_SHARE * len(outline.vertices)):
            break
        outline = _made(outline, moves, loop)
    return outline


def _cheapest_at(outline: Outline, allowed: BoolArray, weights: Weights, centre: FloatArray, reach: float) -> _Moves:
    """The cheaper one of the moves at each allowed (n,) vertex that has any: drop it, or extend its edge away.

    Costs as in `ProgressiveHull`.
    """
    b = outline.vertices
    after, before = outline.successor, outline.predecessor
    edge = b[after] - b
    u, w, q = edge[before], edge, edge[after]
    turn = cross(u, w)
    straight = turn <= TURN_ROUNDING * (np.abs(u[:, 0] * w[:, 1]) + np.abs(u[:, 1] * w[:, 0]))
    drop = np.where(straight, 0.5 * weights.drop * np.abs(turn), np.inf)

    turn_c, den = turn[after], cross(u, q)
    squared = (w * w).sum(axis=1)
    convex = (turn > 0.0) & (turn_c > 0.0)
    possible = np.where(convex, den > 0.0, (turn * turn_c < 0.0) & (np.maximum(turn, turn_c) < -den))
    possible &= squared >= SMALLEST_DIVISOR
    den, squared = np.where(possible, den, 1.0), np.where(possible, squared, 1.0)
    s, t = turn_c / den, -turn / den  # b + s u = c + t q
    nearer_b = np.abs(s) * np.abs(u).sum(axis=1) <= np.abs(t) * np.abs(q).sum(axis=1)
    point = np.where(nearer_b[:, None], b + s[:, None] * u, b[after] + t[:, None] * q)
    possible &= ((point - centre) ** 2).sum(axis=1) < reach * reach
    area = 0.5 * np.abs(s * turn)
    extend = np.where(convex, weights.extend, weights.slide) * area + weights.spike * 2.0 * area * (
        2.0 * area / squared
    )
    extend = np.where(possible, extend, np.inf)

    extends = extend < drop
    cost = np.minimum(drop, extend)
    vertex = np.flatnonzero(np.isfinite(cost) & allowed)
    extends = extends[vertex]
    at = np.where(extends[:, None], point[vertex], b[vertex])
    return _Moves(vertex, extends, extends & convex[vertex], at, cost[vertex])


def _one_per_stretch(outline: Outline, moves: _Moves, random: np.random.Generator) -> _Moves:
    """Moves that are cheapest within three vertices on either side: two of them share no vertex."""
    count = len(outline.vertices)
    share = np.maximum(moves.cost / outline.diameter**2, NEGLIGIBLE_AREA)
    octave = np.floor(COSTS_PER_OCTAVE * np.log2(share)).astype(np.int64)
    key = np.full(count, np.iinfo(np.int64).max)
    key[moves.vertex] = octave * count + random.permutation(count)[moves.vertex]
    least = key
    for _ in range(3):
        least = np.minimum(least, np.minimum(least[outline.successor], least[outline.predecessor]))
    return moves.chosen(key[moves.vertex] == least[moves.vertex])


def _outward(outline: Outline, moves: _Moves, ulp: float) -> _Moves:
    """The moves that add area by exact tests, their points pushed outwards by a few roundings where that takes it."""
    after, before = outline.successor, outline.predecessor
    b = moves.vertex
    A, B, C, D = (outline.vertices[v] for v in (before[b], b, after[b], after[after[b]]))
    sound = ~moves.extends & (orientation(A, C, B) >= 0)
    along_u, along_q = B - A, D - C
    lengths = norm(along_u), norm(along_q)
    waiting = np.flatnonzero(moves.extends & (lengths[0] > 0.0) & (lengths[1] > 0.0))
    point = moves.point.copy()
    for nudge in NUDGE_ULPS:
        if len(waiting) == 0:
            break
        k = waiting
        out = along_u[k] / lengths[0][k, None] + along_q[k] / lengths[1][k, None]
        point[k] = moves.point[k] + nudge * ulp * np.stack((out[:, 1], -out[:, 0]), axis=1)
        outside = (orientation(A[k], B[k], point[k]) <= 0) & (orientation(C[k], D[k], point[k]) <= 0)
        outside &= orientation(B[k], C[k], point[k]) < 0
        sound[k[outside]] = True
        waiting = k[~outside]
    return moves._replace(point=point).chosen(sound)


def _unblocked(outline: Outline, moves: _Moves, margin: float) -> _Moves:
    """The moves whose triangles, widened by the margin, touch neither the outline beyond them nor each other."""
    after, before = outline.successor, outline.predecessor
    b = moves.vertex
    c = after[b]
    first = np.where(moves.extends, b, before[b])
    corners = np.stack(
        (
            outline.vertices[first],
            np.where(moves.extends[:, None], moves.point, outline.vertices[c]),
            outline.vertices[np.where(moves.extends, c, b)],
        ),
        axis=1,
    )
    low, high = corners.min(axis=1) - margin, corners.max(axis=1) + margin
    boxes, tree = BoxTree(low, high), outline.tree
    free = np.ones(len(b), dtype=bool)
    for triangle, edge in boxes.blocks(tree):
        own = (edge == before[b[triangle]]) | (edge == b[triangle]) | (edge == c[triangle])
        end = after[edge]
        through = moves.convex[triangle] & ~own
        hit = through & _edges_touch(corners[triangle], outline.vertices[edge], outline.vertices[end], margin)
        # where two sides are boundary, no edge gets in without a vertex
        own_vertex = (edge == first[triangle]) | (edge == b[triangle]) | (edge == c[triangle])
        inside = ~moves.convex[triangle] & ~own_vertex
        hit |= inside & _points_inside(corners[triangle], outline.vertices[edge], margin)
        free[triangle[hit]] = False
    for i, j in boxes.blocks():
        both = free[i] & free[j]
        i, j = i[both], j[both]
        free[np.where(moves.cost[i] > moves.cost[j], i, j)] = False
    return moves.chosen(free)


def _points_inside(corners: FloatArray, points: FloatArray, margin: float) -> BoolArray:
    """(K,) whether points (K, 2) lie in counter-clockwise triangles (K, 3, 2) widened by the margin."""
    inside: BoolArray = ((points >= corners.min(axis=1) - margin) & (points <= corners.max(axis=1) + margin)).all(
        axis=1
    )
    for k in range(3):
        start, side = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        inside &= cross(side, points - start) >= -margin * np.abs(side).sum(axis=1)
    return inside


def _edges_touch(corners: FloatArray, starts: FloatArray, ends: FloatArray, margin: float) -> BoolArray:
    """(K,) whether edges (K, 2) touch counter-clockwise triangles (K, 3, 2) widened by the margin: separating axes."""
    touch = np.ones(len(starts), dtype=bool)
    for k in range(3):
        start, side = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        beyond = -margin * np.abs(side).sum(axis=1)
        touch &= (cross(side, starts - start) >= beyond) | (cross(side, ends - start) >= beyond)
    along = ends - starts
    beside = margin * np.abs(along).sum(axis=1)
    sides = cross(along[:, None], corners - starts[:, None])
    return np.asarray(touch & (sides.min(axis=1) <= beside) & (sides.max(axis=1) >= -beside))


def _made(outline: Outline, moves: _Moves, loop: IntArray) -> Outline:
    """The outline after moves that share no vertices."""
    vertices, spans = outline.vertices.copy(), outline.spans.copy()
    moved = moves.vertex[moves.extends]
    merged = outline.successor[moved]
    vertices[moved] = moves.point[moves.extends]
    spans[moved, 1] = spans[merged, 1]
    kept = np.ones(len(vertices), dtype=bool)
    kept[moves.vertex[~moves.extends]] = kept[merged] = False
    sizes = np.bincount(loop[kept], minlength=len(outline.sizes))
    return Outline(vertices[kept], tuple(sizes.tolist()), spans[kept])
