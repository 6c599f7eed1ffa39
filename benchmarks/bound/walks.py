"""The cheapest closed walk once around the outline with at most m cage vertices, and the moves of all cheap ones."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from .corners import Moves
from .nodes import EDGE, Nodes

FEWEST_GROUPS, MOST_GROUPS, WORK = 24, 400, 4e7
"""Groups of first nodes that are searched at once: bounds, and moves times groups."""


class Cheap(NamedTuple):
    """What a search found."""

    least: float
    """Lower bound on the area of all closed walks."""
    moves: np.ndarray
    """(K,) whether a move can be on a walk below the threshold."""
    through: np.ndarray
    """(N,) lower bound on walks through a node."""


class Layers:
    """Moves sorted for min-plus products, apart by the cage vertices that they cost, 0 or 1."""

    def __init__(self, moves: Moves, cost: np.ndarray, head: np.ndarray, tail: np.ndarray) -> None:
        order = np.argsort(head, kind="stable")
        self.parts = []
        for price in (0, 1):
            of = order[cost[order] == price]
            heads, begins = np.unique(head[of], return_index=True)
            self.parts.append((tail[of], moves.area[of], heads, begins))

    def relax(self, price: int, before: np.ndarray, now: np.ndarray) -> None:
        """now[head] = min(now[head], before[tail] + area)."""
        tail, area, heads, begins = self.parts[price]
        if len(tail):
            now[heads] = np.minimum(now[heads], np.minimum.reduceat(before[tail] + area, begins))

    def run(self, tables: np.ndarray) -> None:
        """Fill tables (m + 1, N): least area to or from each node with at most so many cage vertices."""
        for k, now in enumerate(tables):
            if k:
                self.relax(1, tables[k - 1], now)
                np.minimum(now, tables[k - 1], out=now)
            self.relax(0, now, now)


def cheap_walks(nodes: Nodes, moves: Moves, most: int, below: float) -> Cheap:
    """Search closed walks of at most ``most`` cage vertices and of less area than ``below``."""
    search = _Search(nodes, moves, most)
    groups = search.groups(below)
    keep, through, least = np.zeros(len(moves.source), bool), np.full(len(nodes.kind), np.inf), np.inf
    for low, _, group in groups:
        least = min(least, low)
        if low < below:
            total = search.totals(group)
            keep |= total < below
            np.minimum.at(through, moves.source, total)
            np.minimum.at(through, moves.target, total)
    return Cheap(least, keep, through)


class _Search:
    def __init__(self, nodes: Nodes, moves: Moves, most: int) -> None:
        self.moves, self.most, self.count = moves, most, len(nodes.kind)
        edges = nodes.kind == EDGE
        # a cage vertex is counted by the move that comes to it; one on the outline is no more on leaving it by an edge
        self.cost = np.where(edges[moves.target] & ~edges[moves.source], 0, 1)
        around = 2 * len(nodes.outline)
        place = (nodes.key - _best_cut(nodes.key, moves, around)) % around
        self.crossing = place[moves.target] < place[moves.source]
        inner = ~self.crossing
        kept, cost = moves.take(inner), self.cost[inner]
        self.ahead = Layers(kept, cost, kept.target, kept.source)
        self.back = Layers(kept, cost, kept.source, kept.target)
        self.over = np.flatnonzero(self.crossing)
        sources = np.unique(moves.source[self.over])
        self.sources = sources[np.lexsort((nodes.low[sources], place[sources]))]

    def groups(self, below: float) -> list[tuple[float, int, np.ndarray]]:
        """First nodes in groups, each with a lower bound; the one with the least is halved again and again."""
        if not len(self.sources):
            return []
        budget = int(np.clip(WORK / max(len(self.moves.source), 1), FEWEST_GROUPS, MOST_GROUPS))
        heap, number = [(self.bound(self.sources), 0, self.sources)], 0
        while number < budget and heap[0][0] < below and len(heap[0][2]) > 1:
            low, _, group = heapq.heappop(heap)
            for half in np.array_split(group, 2):
                number += 1
                heapq.heappush(heap, (max(low, self.bound(half)), number, half))
        return heap

    def bound(self, group: np.ndarray) -> float:
        """Least area of walks from a group of first nodes to the same group."""
        return float(self.forward(group)[self.most, group].min())

    def forward(self, group: np.ndarray) -> np.ndarray:
        """(m + 1, N) least areas from the group, over its moves that cross the cut."""
        over = self._over(group)
        tables = np.full((self.most + 1, self.count), np.inf)
        for price in (0, 1):
            of = over[self.cost[over] == price]
            np.minimum.at(tables[price], self.moves.target[of], self.moves.area[of])
        self.ahead.run(tables)
        return tables

    def totals(self, group: np.ndarray) -> np.ndarray:
        """(K,) least areas of walks from the group to itself through each move."""
        ahead, back = self.forward(group), np.full((self.most + 1, self.count), np.inf)
        back[0, group] = 0.0
        self.back.run(back)
        source, target, area = self.moves
        total = np.full(len(source), np.inf)
        inner = np.flatnonzero(~self.crossing)
        inner = inner[np.isfinite(ahead[self.most, source[inner]] + back[self.most, target[inner]])]
        best = np.full(len(inner), np.inf)
        for k in range(self.most + 1):
            left = self.most - k - self.cost[inner]
            rest = np.where(left >= 0, back[np.maximum(left, 0), target[inner]], np.inf)
            np.minimum(best, ahead[k, source[inner]] + rest, out=best)
        total[inner] = best + area[inner]
        over = self._over(group)
        total[over] = area[over] + back[self.most - self.cost[over], target[over]]
        return total

    def _over(self, group: np.ndarray) -> np.ndarray:
        there = np.zeros(self.count, bool)
        there[group] = True
        return self.over[there[self.moves.source[self.over]]]


def _best_cut(key: np.ndarray, moves: Moves, around: int) -> int:
    """The vertex of the outline, as an even place, that moves from the fewest nodes pass."""
    source, reach = moves.source, (key[moves.target] - key[moves.source]) % around
    nodes = np.unique(source)
    farthest = np.zeros(len(key), int)
    np.maximum.at(farthest, source, reach)
    passed = np.zeros(2 * around + 2, int)
    np.add.at(passed, key[nodes] + 1, 1)
    np.add.at(passed, key[nodes] + farthest[nodes] + 1, -1)
    passed = np.cumsum(passed)
    return 2 * int(np.argmin((passed[:around] + passed[around : 2 * around])[::2]))
