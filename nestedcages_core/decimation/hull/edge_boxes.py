"""The bounding boxes of edges that change one by one: which of them touch another box."""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.predicates import BoxTree

MAX_AT_ONCE = 2048
"""Number of boxes up to which all are compared at once, in 4 μs; it takes 2 μs for a hundred."""

BLOCK = 256
"""Number of edges that share a box, where there are more of them: neighbours on a loop, or on loops close by."""


class EdgeBoxes:
    """Boxes of edges, compared all at once: in Python, a grid or a tree looks at fewer boxes and takes longer.

    Many boxes are compared in blocks, whose own boxes grow with those of their edges and never shrink.
    """

    def __init__(self, starts: FloatArray, ends: FloatArray) -> None:
        """starts, ends: (n, 2)."""
        bounds = np.concatenate((np.maximum(starts, ends), -np.minimum(starts, ends)), axis=1)
        self._slots: list[int] | None = None
        """Where each edge is, if they are sorted."""
        order = np.arange(len(starts))
        if len(order) > MAX_AT_ONCE:
            order = BoxTree(starts, ends).order
            self._slots = np.argsort(order).tolist()
        self._reset(bounds[order], order)

    def _reset(self, bounds: FloatArray, order: IntArray) -> None:
        """bounds: (n, 4) high x, high y, -low x, -low y; order: (n,) the edges that they belong to."""
        self._order = order
        self._bounds = np.ascontiguousarray(bounds.T)
        self._query = np.empty((4, 1))
        # items of memory views are set in half the time of those of arrays
        views: list[Any] = [memoryview(row) for row in (*self._bounds, self._query[:, 0])]
        self._high_x, self._high_y, self._low_x, self._low_y, self._asked = views
        self._blocks: EdgeBoxes | None = None
        if len(bounds) > MAX_AT_ONCE:
            self._blocks = object.__new__(EdgeBoxes)
            begins = np.arange(0, len(bounds), BLOCK)
            self._blocks._reset(np.maximum.reduceat(bounds, begins), np.arange(len(begins)))

    def insert(self, edge: int, ax: float, ay: float, bx: float, by: float) -> None:
        """Set the box of an edge, from (ax, ay) to (bx, by)."""
        edge = edge if self._slots is None else self._slots[edge]
        self._high_x[edge], self._low_x[edge] = (bx, -ax) if ax < bx else (ax, -bx)
        self._high_y[edge], self._low_y[edge] = (by, -ay) if ay < by else (ay, -by)
        if self._blocks is not None:
            grown, block = self._blocks._bounds, edge // BLOCK
            grown[:, block] = np.maximum(grown[:, block], self._bounds[:, edge])

    def remove(self, edge: int) -> None:
        """Remove an edge."""
        self._high_x[edge if self._slots is None else self._slots[edge]] = -inf

    def near(self, low_x: float, low_y: float, high_x: float, high_y: float) -> list[int]:
        """The edges whose boxes touch the given box."""
        asked = self._asked
        asked[0], asked[1], asked[2], asked[3] = low_x, low_y, -high_x, -high_y
        if self._blocks is None:
            found: list[int] = np.logical_and.reduce(self._bounds >= self._query).nonzero()[0].tolist()
            return found
        found = []
        for block in self._blocks.near(low_x, low_y, high_x, high_y):
            begin = block * BLOCK
            touching = np.logical_and.reduce(self._bounds[:, begin : begin + BLOCK] >= self._query)
            found += self._order[begin + touching.nonzero()[0]].tolist()
        return found
