"""A priority queue of moves. Most of them become obsolete before their turn."""

from __future__ import annotations

from collections.abc import Iterable
from heapq import heappop, heappush
from math import inf
from typing import TypeAlias

Place: TypeAlias = tuple[float, ...]
"""Parameters of a move, or the coordinates of its new vertices."""

NEGLIGIBLE_COST = 1e-15
"""Cost in squared diameters at round-off level; moves that cost less are free."""

COST_SPLITTER = 2.0**27 + 1.0
"""Rounds costs to 26 bits (Dekker 1971), so that equal moves of a symmetric shape tie despite round-off."""


class MoveQueue:
    """Moves belong to slots; renewing a slot discards its moves. Among equal costs the first slot goes first."""

    def __init__(self, slots: int, negligible: float) -> None:
        """Costs up to `negligible` count as 0."""
        self.stamps = [0] * slots
        """Number of renewals per slot."""
        self._negligible = negligible
        self._heap: list[tuple[float, int, int, Place]] = []

    def renew(self, slot: int) -> None:
        """Discard the moves of a slot."""
        self.stamps[slot] += 1

    def push(self, moves: Iterable[tuple[float, int, Place]]) -> None:
        """Add moves: cost, slot and place each."""
        stamps, heap, negligible = self.stamps, self._heap, self._negligible
        for cost, slot, place in moves:
            scaled = cost * COST_SPLITTER
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
