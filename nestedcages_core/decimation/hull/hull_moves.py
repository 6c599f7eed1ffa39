"""The moves of a progressive hull: which there are, what they cost, and where their new vertices go."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from heapq import heappop, heappush
from math import inf
from typing import TypeAlias

from ...geometry.arrays import TINY
from ...geometry.predicates.orientation import FLOAT_BOUND, SPLITTER
from ..base import REACH
from .linked_loops import LinkedLoops

PIVOT_RATIOS = (1.0, 0.5, 2.0, 0.2, 5.0)
"""Ratios |b q| / |p b| that pivots try; the first, with b in the middle, adds the least area."""

PIVOT_RATIO_LOOP = 6
"""Size up to which a loop tries all ratios: few other moves are left, and the first may be blocked."""

Place: TypeAlias = tuple[float, ...]
"""Parameters of a move, or the coordinates of its new vertices."""

NEGLIGIBLE_COST = 1e-15
"""Cost in squared diameters at round-off level; moves that cost less are free."""


@dataclass(frozen=True)
class Weights:
    """Cost weight per kind of move, per area added."""

    drop: float = 1.0
    extend: float = 1.0
    """Extend across two convex vertices."""
    slide: float = 1.0
    """Extend across a convex and a reflex vertex: one neighbour gets shorter."""
    pivot: float | None = 1.0
    """None: only loops of a few vertices pivot, which may have no other move."""
    spike: float = 0.02
    """Cost of the squared height of a new corner over the edge it replaces: against spikes."""
    reach: float = REACH
    """Largest distance of new vertices from the centre, in diameters."""


HullMove: TypeAlias = tuple[float, int, Place]
"""Cost, slot, and the ratio of a pivot. The moves of vertex v are in slot 2 v, those of its edge in 2 v + 1."""


class HullMoves:
    """The moves of linked loops, and their costs."""

    def __init__(self, loops: LinkedLoops, weights: Weights, stamps: list[int]) -> None:
        """stamps: number of renewals per slot, counted here."""
        self.loops, self.weights, self.stamps = loops, weights, stamps

    def of(self, first: int, last: int = -1) -> list[HullMove]:
        """The moves of the vertices first .. last and of the edges between them, or of all around a loop.

        Their slots are renewed. What lies beyond first .. last has not changed, hence neither have drops of these two.
        """
        loops, weights, stamps = self.loops, self.weights, self.stamps
        drop_weight, spike_weight, pivot_weight = weights.drop, weights.spike, weights.pivot or 1.0
        X, Y, following, previous = loops.x, loops.y, loops.next, loops.previous
        size = loops.sizes[loops.loop_of[first]]
        pivots = size > 3 and (weights.pivot is not None or size <= PIVOT_RATIO_LOOP)
        ratios = PIVOT_RATIOS if size <= PIVOT_RATIO_LOOP else PIVOT_RATIOS[:1]
        found: list[HullMove] = []
        b, a, c = first, previous[first], following[first]
        z = previous[a]
        ax, ay, bx, by, cx, cy = X[a], Y[a], X[b], Y[b], X[c], Y[c]
        fx, fy, ux, uy, wx, wy = ax - X[z], ay - Y[z], bx - ax, by - ay, cx - bx, cy - by
        turn_a, turn_b = fx * uy - fy * ux, ux * wy - uy * wx
        while True:
            d = following[c]
            dx, dy = X[d], Y[d]
            qx, qy = dx - cx, dy - cy
            turn_c = wx * qy - wy * qx
            slot = 2 * b

            # drop b, or pivot about it
            if turn_b <= 0.0 or turn_b <= FLOAT_BOUND * (abs(ux * wy) + abs(uy * wx)):
                if last < 0 or (b != first and b != last):
                    stamps[slot] += 1
                    found.append((drop_weight * 0.5 * abs(turn_b), slot, ()))
            else:
                stamps[slot] += 1
                if pivots and turn_a >= 0.0 and turn_c >= 0.0:
                    den = fy * qx - fx * qy
                    for ratio in ratios if abs(den) >= TINY else ():
                        # (a + s f) + ratio (c - t q) = (1 + ratio) b
                        mx, my = ux - ratio * wx, uy - ratio * wy
                        s, t = (my * qx - mx * qy) / den, (fx * my - fy * mx) / (den * ratio)
                        if s > 0.0 and t > 0.0:
                            area = 0.5 * (s * turn_a + t * turn_c)
                            spike = 0.25 * (s * s * (fx * fx + fy * fy) + t * t * (qx * qx + qy * qy))
                            found.append((pivot_weight * area + spike_weight * spike, slot, (ratio,)))
            if b == last:
                break

            # replace the edge from b to c by the corner where its neighbours' lines meet
            slot += 1
            stamps[slot] += 1
            den = ux * qy - uy * qx
            if turn_b > 0.0 and turn_c > 0.0:
                weight, possible = weights.extend, den > 0.0
            else:
                # one end is convex, and the neighbour at the other is shortened, by less than its length
                weight, possible = weights.slide, turn_b * turn_c < 0.0 and turn_b < -den and turn_c < -den
            if possible and (squared := wx * wx + wy * wy) >= TINY:
                twice = turn_c / den * turn_b  # of the area; its square may overflow or underflow
                cost = weight * (0.5 * twice) + spike_weight * (twice * (twice / squared))
                found.append((cost, slot, ()))
            if c == first:
                break
            a, b, c = b, c, d
            ax, ay, bx, by, cx, cy = bx, by, cx, cy, dx, dy
            fx, fy, ux, uy, wx, wy = ux, uy, wx, wy, qx, qy
            turn_a, turn_b = turn_b, turn_c
        return found


def corner(loops: LinkedLoops, b: int) -> tuple[float, float]:
    """Where the lines of the edges before and after the edge from b meet."""
    X, Y = loops.x, loops.y
    a, c = loops.previous[b], loops.next[b]
    d = loops.next[c]
    bx, by, cx, cy = X[b], Y[b], X[c], Y[c]
    ux, uy, wx, wy, qx, qy = bx - X[a], by - Y[a], cx - bx, cy - by, X[d] - cx, Y[d] - cy
    den = ux * qy - uy * qx
    s, t = (wx * qy - wy * qx) / den, -(ux * wy - uy * wx) / den  # b + s u = c + t q
    nearer_b = abs(s) * (abs(ux) + abs(uy)) <= abs(t) * (abs(qx) + abs(qy))
    return (bx + s * ux, by + s * uy) if nearer_b else (cx + t * qx, cy + t * qy)


def pivoted(loops: LinkedLoops, b: int, ratio: float) -> tuple[float, float, float, float]:
    """Where an edge about b that b divides by a ratio meets the lines of the edges beyond its neighbours."""
    X, Y = loops.x, loops.y
    a, c = loops.previous[b], loops.next[b]
    z, d = loops.previous[a], loops.next[c]
    ax, ay, bx, by, cx, cy = X[a], Y[a], X[b], Y[b], X[c], Y[c]
    fx, fy, gx, gy = ax - X[z], ay - Y[z], cx - X[d], cy - Y[d]
    # (a + s f) + ratio (c + t g) = (1 + ratio) b
    mx, my, den = (bx - ax) - ratio * (cx - bx), (by - ay) - ratio * (cy - by), fx * gy - fy * gx
    s, t = (mx * gy - my * gx) / den, (fx * my - fy * mx) / (den * ratio)
    return ax + s * fx, ay + s * fy, cx + t * gx, cy + t * gy


class MoveQueue:
    """Moves belong to slots; renewing a slot discards its moves. Among equal costs the first slot goes first."""

    def __init__(self, slots: int, negligible: float) -> None:
        """Costs up to `negligible` count as 0."""
        self.stamps = [0] * slots
        """Number of renewals per slot."""
        self._negligible = negligible
        self._heap: list[tuple[float, int, int, Place]] = []

    def push(self, moves: Iterable[tuple[float, int, Place]]) -> None:
        """Add moves: cost, slot and place each."""
        stamps, heap, negligible = self.stamps, self._heap, self._negligible
        for cost, slot, place in moves:
            scaled = cost * SPLITTER
            # 26 bits, so that equal moves of a symmetric shape tie despite round-off
            cost = scaled - (scaled - cost) if cost > negligible else 0.0
            heappush(heap, (cost, slot, stamps[slot], place))

    def pop(self, max_cost: float = inf) -> tuple[int, Place] | None:
        """Slot and place of the cheapest move, which is discarded; None if none costs up to `max_cost`."""
        stamps, heap = self.stamps, self._heap
        while heap:
            cost, slot, stamp, place = move = heappop(heap)
            if stamps[slot] == stamp:
                if cost > max_cost:
                    heappush(heap, move)
                    return None
                return slot, place
        return None
