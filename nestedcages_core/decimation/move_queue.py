"""A priority queue of moves. Most of them become obsolete before their turn."""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from math import inf

COST_SPLITTER = 2.0**27 + 1.0
"""Rounds costs to 26 bits (Dekker 1971), so that equal moves of a symmetric shape tie despite round-off."""

HEAP_DIVISOR = 4
"""An empty heap is refilled with the cheapest 1 / HEAP_DIVISOR of the waiting moves: a small heap stays in cache."""


class MoveQueue:
    """Each move belongs to a slot; renewing the slot discards its moves. Among equal costs the first slot goes first.

    Only the cheapest moves are in a heap; the others wait in a list, where becoming obsolete costs nothing.
    """

    def __init__(self, slots: int, negligible: float) -> None:
        """Costs up to `negligible` count as 0."""
        self._stamps = [0] * slots
        self._negligible = negligible
        self._heap: list[tuple[float, ...]] = []
        self._waiting: list[tuple[float, ...]] = []
        self._limit = -1.0

    def renew(self, slot: int) -> None:
        """Discard the moves of a slot."""
        self._stamps[slot] += 1

    def push(self, slot: int, cost: float, *place: float) -> None:
        """Add a move of a slot, with its parameters."""
        scaled = cost * COST_SPLITTER
        cost = scaled - (scaled - cost) if cost > self._negligible else 0.0
        if cost <= self._limit:
            heappush(self._heap, (cost, slot, self._stamps[slot], *place))
        else:
            self._waiting.append((cost, slot, self._stamps[slot], *place))

    def pop(self, max_cost: float = inf) -> tuple[int, tuple[float, ...]] | None:
        """Slot and place of the cheapest move, which is discarded; None if none costs up to `max_cost`."""
        stamps = self._stamps
        while True:
            while self._heap:
                cost, slot, stamp, *place = heappop(self._heap)
                if stamps[int(slot)] == stamp:
                    if cost > max_cost:
                        heappush(self._heap, (cost, slot, stamp, *place))
                        return None
                    return int(slot), tuple(place)
            waiting = [move for move in self._waiting if stamps[int(move[1])] == move[2]]
            if not waiting:
                self._waiting, self._limit = [], -1.0
                return None
            self._limit = sorted([move[0] for move in waiting])[len(waiting) // HEAP_DIVISOR]
            self._heap = [move for move in waiting if move[0] <= self._limit]
            self._waiting = [move for move in waiting if move[0] > self._limit]
            heapify(self._heap)
