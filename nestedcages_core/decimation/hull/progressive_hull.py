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

from collections.abc import Callable, Sequence
from math import hypot, inf

from ...geometry.loops import Loops
from ...geometry.precision import MOST_ROUNDS
from ...geometry.predicates import orientation_sign
from ...tasks import Stage, drain
from .hull_moves import NEGLIGIBLE_COST, PIVOT_RATIO_LOOP, HullMoves, MoveQueue, Place, Weights, corner, pivoted
from .linked_loops import LinkedLoops

PAUSE = 512
"""Number of moves, some hundredths of a second, after which progress is reported."""

NUDGE_ULPS = (0.0, 1.0, 3.0, 9.0, 27.0, 81.0, 243.0, 729.0)
"""Units in the last place by which a new vertex is pushed outwards until the exact tests hold."""

REACH_GROWTH = 4.0
"""Factor on the reach of new vertices when no move is left within it."""


class ProgressiveHull:
    """State of the greedy: the loops and a queue of moves, those of vertex v in slot 2 v, of its edge in 2 v + 1."""

    def __init__(self, outline: Loops, weights: Weights, minimum: Sequence[int]) -> None:
        """minimum: vertices that each loop keeps, at least 3."""
        self.weights = weights
        self.minimum = list(minimum)
        self.loops = loops = LinkedLoops(outline, weights.reach)
        self.reach = weights.reach * loops.diameter
        self.queue = MoveQueue(2 * loops.total, NEGLIGIBLE_COST * loops.diameter**2)
        self.moves = HullMoves(loops, weights, self.queue.stamps)
        self._blocked: set[tuple[float, ...]] = set()
        self._reach_rounds, self._out_of_reach = 0, False
        self._consider_all()

    def run(self, count: int, max_cost: float = inf) -> Loops:
        """Remove vertices until `count` are left, or as many as can be removed by moves that cost up to `max_cost`."""
        return drain(self.steps(count, max_cost))

    def steps(self, count: int, max_cost: float = inf) -> Stage[float, Loops]:
        """The same as a generator: yields the fraction done at first and every `PAUSE` moves.

        Runs to ever smaller counts make the same moves as one to the smallest.
        """
        loops = self.loops
        first, moves = loops.total, 0
        yield 0.0  # between the costs of all moves and the first one
        while loops.total > count:
            moves += 1
            if moves % PAUSE == 0:
                yield (first - loops.total) / (first - count)
            move = self.queue.pop(max_cost)
            if move is not None:
                b, loop = move[0] // 2, loops.loop_of[move[0] // 2]
                if loops.sizes[loop] > self.minimum[loop]:
                    make, place = self._prepared(*move)
                    if place is not None:
                        make(b, *place)
            elif max_cost < inf or not self._farther():
                break
        return loops.outline()

    def _farther(self) -> bool:
        """Whether new vertices may lie farther out than before, where some were out of reach."""
        if self._reach_rounds == MOST_ROUNDS or not self._out_of_reach:
            return False
        self._reach_rounds += 1
        self._out_of_reach = False
        self.reach *= REACH_GROWTH
        self._consider_all()
        return True

    # Moves and their costs

    def _consider_all(self) -> None:
        for entrance in self.loops.entrance:
            self.queue.push(self.moves.of(entrance))

    def _consider_around(self, first: int, last: int) -> None:
        """Update the moves of the vertices first .. last and the edges between them, whose neighbours have changed."""
        small = self.loops.sizes[self.loops.loop_of[first]] <= PIVOT_RATIO_LOOP
        self.queue.push(self.moves.of(first) if small else self.moves.of(first, last))

    # Where its new vertices go

    def _prepared(self, slot: int, ratio: Place) -> tuple[Callable[..., None], Place | None]:
        """What makes a move, and its new vertices: x and y each; None if they are out of reach."""
        b, loops = slot // 2, self.loops
        if slot % 2:
            x, y = corner(loops, b)
            return self._extend, None if self._is_far(x, y) else (x, y)
        if not ratio:
            return self._drop, ()
        place = pivoted(loops, b, *ratio)
        return self._pivot, None if self._is_far(*place[:2]) or self._is_far(*place[2:]) else place

    def _is_far(self, x: float, y: float) -> bool:
        """Whether a point is out of reach; noted."""
        x, y = x - self.loops.centre[0], y - self.loops.centre[1]
        far = not x * x + y * y < self.reach * self.reach
        self._out_of_reach |= far
        return far

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
        following = loops.next
        a, c = loops.previous[b], following[b]
        d = following[c]
        ax, ay, bx, by, cx, cy, dx, dy = X[a], Y[a], X[b], Y[b], X[c], Y[c], X[d], Y[d]
        move = (b, x, y, bx, by, cx, cy)
        if move in self._blocked:
            return
        ux, uy, wx, wy, qx, qy = bx - ax, by - ay, cx - bx, cy - by, dx - cx, dy - cy
        u, q = hypot(ux, uy), hypot(qx, qy)
        if not (u and q):
            return  # a vertex was rounded onto its neighbour
        ulp, out_x, out_y = loops.ulp, uy / u + qy / q, -ux / u - qx / q
        for nudge in NUDGE_ULPS:
            px, py = x + nudge * ulp * out_x, y + nudge * ulp * out_y
            if (
                orientation_sign(ax, ay, bx, by, px, py) <= 0
                and orientation_sign(cx, cy, dx, dy, px, py) <= 0
                and orientation_sign(bx, by, cx, cy, px, py) < 0
            ):
                break
        else:
            self._blocked.add(move)
            return
        if ux * wy - uy * wx > 0.0 and wx * qy - wy * qx > 0.0:
            blocked = loops.edge_in_triangle(bx, by, px, py, cx, cy, own=(a, b, c))
        else:
            # two sides of the triangle are boundary, so no edge gets in without a vertex
            blocked = loops.vertex_in_triangle(bx, by, px, py, cx, cy, own=(b, c))
        if blocked:
            self._blocked.add(move)
            return
        self._discard(c)
        loops.remove(c, (b, px, py))
        self._consider_around(loops.previous[a], following[d])

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
        self._discard(c)
        loops.remove(c, (a, sx, sy), (b, tx, ty))
        self._consider_around(loops.previous[z], loops.next[d])

    def _discard(self, vertex: int) -> None:
        stamps = self.queue.stamps
        stamps[2 * vertex] += 1
        stamps[2 * vertex + 1] += 1
