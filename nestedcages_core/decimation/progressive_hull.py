"""Greedy outer hull: closed loops lose vertices one by one, by moves that only ever add area, cheapest first.

The solid lies on the left of every edge, so outer loops run counter-clockwise and holes clockwise, and one code serves
both. Each move works on a short chain of vertices and removes one of them:

    drop    a b c      -> a c       b reflex or straight
    extend  a b c d    -> a x d     x where the lines a-b and c-d meet outside b-c; b, c or both are convex
    pivot   z a b c d  -> z p q d   a, b, c convex: p and q on the lines z-a and d-c, the edge p-q touched by b

Since solids only grow, an obstacle to a move stays one, and the move is discarded for good. After the
progressive hulls of Sander, Gu, Gortler, Hoppe, Snyder: Silhouette Clipping (2000); the pivot is added here.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, hypot, inf

from ..geometry.predicates import orientation_sign
from ..stages import Stage, drain
from .importance import PIN_REACH, Importance
from .linked_loops import LinkedLoops
from .move_queue import MoveQueue
from .outline import Outline

PAUSE = 512
"""Number of moves, some hundredths of a second, after which progress is reported."""

TURN_ROUNDING = 4e-16
"""Relative error of a 2x2 determinant of differences of doubles, rounded up."""

NUDGE_ULPS = (0.0, 1.0, 3.0, 9.0, 27.0, 81.0, 243.0, 729.0)
"""Units in the last place by which a new vertex is pushed outwards until the exact tests hold."""

NEGLIGIBLE_AREA = 1e-15
"""Area in squared diameters at round-off level; moves that cost less are free."""

SMALLEST_DIVISOR = 1e-300
"""Squared lengths and cross products, in squared input units, that are too small to be divided by."""

REACH_GROWTH, MAX_REACH_ROUNDS = 4.0, 5
"""Factor on the reach of new vertices when no move is left within it; maximum number of its applications."""

SMALL_LOOP = 8
"""Size up to which all moves of a loop are reconsidered after each move."""

PIVOT_RATIOS = (1.0, 0.5, 2.0, 0.2, 5.0)
"""Ratios |b q| / |p b| that pivots try; the first, with b in the middle, adds the least area."""

PIVOT_RATIO_LOOP = 6
"""Size up to which a loop tries all ratios: few other moves are left, and the first may be blocked."""


@dataclass(frozen=True)
class Weights:
    """Cost weight per kind of move, per area added; randomised by restarts."""

    drop: float = 1.0
    extend: float = 1.0
    """Extend across two convex vertices."""
    slide: float = 1.0
    """Extend across a convex and a reflex vertex: one neighbour gets shorter."""
    pivot: float | None = 1.0
    """None: only loops of a few vertices pivot, which may have no other move."""
    spike: float = 0.02
    """Cost of the squared height of a new corner over the edge it replaces: against spikes."""
    noise: float = 0.0
    """Standard deviation of the logarithm of a random factor per vertex."""
    loops: tuple[float, ...] = ()
    """Factor per loop; empty for none."""
    reach: float = 1.5
    """Largest distance of new vertices from the centre, in diameters."""
    seed: int = 0


class ProgressiveHull:
    """State of the greedy: the loops and a queue of moves, those of vertex v in slot 2 v, of its edge in 2 v + 1."""

    def __init__(
        self, outline: Outline, weights: Weights, minimum: Sequence[int], importance: Importance | None = None
    ) -> None:
        """minimum: vertices that each loop keeps, at least 3; importance: weights and pins of the shape."""
        self.weights = weights
        self.minimum = list(minimum)
        self.loops = loops = LinkedLoops(outline, weights.reach)
        self.reach = weights.reach * loops.diameter
        draw = random.Random(weights.seed).gauss
        self.factor = [exp(weights.noise * draw(0.0, 1.0)) if weights.noise else 1.0 for _ in range(loops.total)]
        if weights.loops:
            self.factor = [f * weights.loops[k] for f, k in zip(self.factor, loops.loop_of, strict=True)]
        self.pinned: list[bool] | None = None
        if importance is not None:
            factors = importance.at(outline.vertices).tolist()
            self.factor = [f * w for f, w in zip(self.factor, factors, strict=True)]
            self.pinned = importance.pinned(outline).tolist()
            self._pin_reach = PIN_REACH * importance.fine.diagonal
        self.queue = MoveQueue(2 * loops.total, NEGLIGIBLE_AREA * loops.diameter**2)
        self._blocked: set[tuple[float, ...]] = set()
        self._reach_rounds = 0
        self._consider_all()

    def run(self, count: int, max_cost: float = inf) -> Outline:
        """Remove vertices until `count` are left, or as many as can be removed by moves that cost up to `max_cost`."""
        return drain(self.steps(count, max_cost))

    def steps(self, count: int, max_cost: float = inf) -> Stage[float, Outline]:
        """The same as a generator: yields the fraction done every `PAUSE` moves.

        Runs to ever smaller counts make the same moves as one to the smallest.
        """
        loops = self.loops
        first, moves = loops.total, 0
        while loops.total > count:
            moves += 1
            if moves % PAUSE == 0:
                yield (first - loops.total) / (first - count)
            move = self.queue.pop(max_cost)
            if move is not None:
                slot, place = move
                if loops.sizes[loops.loop_of[slot // 2]] > self.minimum[loops.loop_of[slot // 2]]:
                    make = self._extend if slot % 2 else self._pivot if place else self._drop
                    make(slot // 2, *place)
            elif max_cost < inf or self._reach_rounds == MAX_REACH_ROUNDS or loops.sizes == self.minimum:
                break
            else:
                self._reach_rounds += 1
                self.reach *= REACH_GROWTH
                self._consider_all()
        return loops.outline()

    # Moves and their costs

    def _consider_all(self) -> None:
        for vertex, alive in enumerate(self.loops.alive):
            if alive:
                self._consider_vertex(vertex)
                self._consider_edge(vertex)

    def _consider_around(self, first: int, last: int) -> None:
        """Update the moves of the vertices first .. last and the edges between them, whose neighbours have changed."""
        loops = self.loops
        if loops.sizes[loops.loop_of[first]] <= SMALL_LOOP:
            first, last = last, loops.previous[last]
            self._consider_edge(last)
        while first != last:
            self._consider_vertex(first)
            self._consider_edge(first)
            first = loops.next[first]
        self._consider_vertex(last)

    def _consider_vertex(self, b: int) -> None:
        """Drop b, or pivot about it."""
        loops, weights = self.loops, self.weights
        self.queue.renew(2 * b)
        X, Y = loops.x, loops.y
        a, c = loops.previous[b], loops.next[b]
        if self.pinned is not None and self.pinned[b]:
            return
        ax, ay, bx, by, cx, cy = X[a], Y[a], X[b], Y[b], X[c], Y[c]
        ux, uy, wx, wy = bx - ax, by - ay, cx - bx, cy - by
        turn = ux * wy - uy * wx
        if turn <= TURN_ROUNDING * (abs(ux * wy) + abs(uy * wx)):
            self.queue.push(2 * b, self.factor[b] * weights.drop * 0.5 * abs(turn))
            return
        size = loops.sizes[loops.loop_of[b]]
        if size == 3 or (weights.pivot is None and size > PIVOT_RATIO_LOOP):
            return
        z, d = loops.previous[a], loops.next[c]
        fx, fy, gx, gy = ax - X[z], ay - Y[z], cx - X[d], cy - Y[d]
        turn_a, turn_c, den = fx * uy - fy * ux, wy * gx - wx * gy, fx * gy - fy * gx
        if turn_a < 0.0 or turn_c < 0.0 or abs(den) < SMALLEST_DIVISOR:
            return
        if self.pinned is not None and (self.pinned[a] or self.pinned[c]):
            return
        for ratio in PIVOT_RATIOS if size <= PIVOT_RATIO_LOOP else PIVOT_RATIOS[:1]:
            # (a + s f) + ratio (c + t g) = (1 + ratio) b
            mx, my = ux - ratio * wx, uy - ratio * wy
            s, t = (mx * gy - my * gx) / den, (fx * my - fy * mx) / (den * ratio)
            px, py, qx, qy = ax + s * fx, ay + s * fy, cx + t * gx, cy + t * gy
            if s > 0.0 and t > 0.0 and self._within_reach(px, py) and self._within_reach(qx, qy):
                area = 0.5 * (s * turn_a + t * turn_c)
                spike = 0.25 * (s * s * (fx * fx + fy * fy) + t * t * (gx * gx + gy * gy))
                cost = self.factor[b] * ((weights.pivot or 1.0) * area + weights.spike * spike)
                self.queue.push(2 * b, cost, px, py, qx, qy)

    def _consider_edge(self, b: int) -> None:
        """Replace the edge from b to c by the corner where its neighbours' lines meet."""
        loops, weights = self.loops, self.weights
        self.queue.renew(2 * b + 1)
        X, Y = loops.x, loops.y
        a, c = loops.previous[b], loops.next[b]
        d = loops.next[c]
        bx, by, cx, cy = X[b], Y[b], X[c], Y[c]
        ux, uy, wx, wy, qx, qy = bx - X[a], by - Y[a], cx - bx, cy - by, X[d] - cx, Y[d] - cy
        turn_b, turn_c, den = ux * wy - uy * wx, wx * qy - wy * qx, ux * qy - uy * qx
        if turn_b > 0.0 and turn_c > 0.0:
            weight, possible = weights.extend, den > 0.0
        else:
            # one end is convex, and the neighbour at the other is shortened, by less than its length
            weight, possible = weights.slide, turn_b * turn_c < 0.0 and max(turn_b, turn_c) < -den
        squared = wx * wx + wy * wy
        if not possible or squared < SMALLEST_DIVISOR:
            return
        s, t = turn_c / den, -turn_b / den  # b + s u = c + t q
        nearer_b = abs(s) * (abs(ux) + abs(uy)) <= abs(t) * (abs(qx) + abs(qy))
        x, y = (bx + s * ux, by + s * uy) if nearer_b else (cx + t * qx, cy + t * qy)
        if self.pinned is not None and self._unpins(b, c, x, y):
            return
        if self._within_reach(x, y):
            area = 0.5 * abs(s * turn_b)
            height_squared = 2.0 * area * (2.0 * area / squared)  # area² may overflow or underflow
            self.queue.push(2 * b + 1, self.factor[b] * (weight * area + weights.spike * height_squared), x, y)

    def _unpins(self, b: int, c: int, x: float, y: float) -> bool:
        """Whether replacing both ends of an edge by a new vertex leaves the place of a pin, or joins two."""
        assert self.pinned is not None
        X, Y, held = self.loops.x, self.loops.y, [v for v in (b, c) if self.pinned[v]]
        return len(held) == 2 or any(hypot(x - X[v], y - Y[v]) > self._pin_reach for v in held)

    def _within_reach(self, x: float, y: float) -> bool:
        x, y = x - self.loops.centre[0], y - self.loops.centre[1]
        return x * x + y * y < self.reach * self.reach

    # Making a move, if nothing blocks it

    def _drop(self, b: int) -> None:
        loops = self.loops
        if loops.can_drop(b):
            a, c = loops.previous[b], loops.next[b]
            self._discard(b)
            loops.remove(b)
            self._consider_around(loops.previous[a], loops.next[c])

    def _extend(self, b: int, x: float, y: float) -> None:
        loops, X, Y = self.loops, self.loops.x, self.loops.y
        a, c = loops.previous[b], loops.next[b]
        d = loops.next[c]
        ax, ay, bx, by, cx, cy, dx, dy = X[a], Y[a], X[b], Y[b], X[c], Y[c], X[d], Y[d]
        move = (b, x, y, bx, by, cx, cy)
        u, q = hypot(bx - ax, by - ay), hypot(dx - cx, dy - cy)
        if move in self._blocked:
            return
        if not (u and q):
            return  # a vertex was rounded onto its neighbour
        out_x, out_y = (by - ay) / u + (dy - cy) / q, (ax - bx) / u + (cx - dx) / q
        for nudge in NUDGE_ULPS:
            px, py = x + nudge * loops.ulp * out_x, y + nudge * loops.ulp * out_y
            if (
                orientation_sign(ax, ay, bx, by, px, py) <= 0
                and orientation_sign(cx, cy, dx, dy, px, py) <= 0
                and orientation_sign(bx, by, cx, cy, px, py) < 0
            ):
                break
        else:
            self._blocked.add(move)
            return
        turn_b = (bx - ax) * (cy - by) - (by - ay) * (cx - bx)
        turn_c = (cx - bx) * (dy - cy) - (cy - by) * (dx - cx)
        if turn_b > 0.0 and turn_c > 0.0:
            blocked = loops.edge_in_triangle(bx, by, px, py, cx, cy, own=(a, b, c))
        else:
            # two sides of the triangle are boundary, so no edge gets in without a vertex
            blocked = loops.vertex_in_triangle(bx, by, px, py, cx, cy, own=(b, c))
        if blocked:
            self._blocked.add(move)
            return
        loops.last[b] = loops.last[c]
        if self.pinned is not None:
            self.pinned[b] |= self.pinned[c]
        self._discard(c)
        loops.remove(c, (b, px, py))
        self._consider_around(loops.previous[a], loops.next[d])

    def _pivot(self, b: int, px: float, py: float, qx: float, qy: float) -> None:
        loops, X, Y = self.loops, self.loops.x, self.loops.y
        a, c = loops.previous[b], loops.next[b]
        z, d = loops.previous[a], loops.next[c]
        zx, zy, ax, ay, bx, by, cx, cy, dx, dy = X[z], Y[z], X[a], Y[a], X[b], Y[b], X[c], Y[c], X[d], Y[d]
        move = (b, px, py, qx, qy, ax, ay, bx, by, cx, cy)
        if move in self._blocked:
            return
        self._blocked.add(move)
        f, g, e = hypot(ax - zx, ay - zy), hypot(dx - cx, dy - cy), hypot(qx - px, qy - py)
        if not (e and f and g):
            return  # both new points are the vertex itself, or a vertex was rounded onto its neighbour
        out_x, out_y = (qy - py) / e, (px - qx) / e
        p_out = out_x + (ay - zy) / f, out_y + (zx - ax) / f
        q_out = out_x + (dy - cy) / g, out_y + (cx - dx) / g
        for nudge in NUDGE_ULPS:
            length = nudge * loops.ulp
            sx, sy = px + length * p_out[0], py + length * p_out[1]
            tx, ty = qx + length * q_out[0], qy + length * q_out[1]
            if (
                orientation_sign(zx, zy, ax, ay, sx, sy) <= 0
                and orientation_sign(cx, cy, dx, dy, tx, ty) <= 0
                and orientation_sign(sx, sy, tx, ty, bx, by) >= 0
                and orientation_sign(ax, ay, bx, by, sx, sy) < 0
                and orientation_sign(bx, by, cx, cy, tx, ty) < 0
            ):
                break
        else:
            return
        if loops.edge_in_triangle(ax, ay, sx, sy, bx, by, own=(z, a, b)):
            return
        if loops.edge_in_triangle(bx, by, tx, ty, cx, cy, own=(a, b, c)):
            return
        loops.first[b], loops.last[b] = loops.first[c], loops.last[c]
        self._discard(c)
        loops.remove(c, (a, sx, sy), (b, tx, ty))
        self._consider_around(loops.previous[z], loops.next[d])

    def _discard(self, vertex: int) -> None:
        self.queue.renew(2 * vertex)
        self.queue.renew(2 * vertex + 1)
