"""Greedy runs of hulls are remembered: another number of vertices around the same shape goes on where one has ended.

A run to few vertices passes all larger numbers: a record of its moves has the hull for each of them. Where
one number is tried after the other, as with a slider or for levels within a distance, most runs are known. What is
remembered changes no result.
"""

from __future__ import annotations

from collections.abc import Sequence
from threading import Lock

import numpy as np

from ...cache import Memory
from ...tasks import Stage
from ..outline import Outline
from .hull_moves import Weights
from .linked_loops import Removal
from .progressive_hull import ProgressiveHull

CAPACITY, BYTES_PER_VERTEX = 32_000_000, 2_000
"""Bytes of all runs that are remembered, and of a run per vertex of its outline, as measured: outlines of up to 4,000
vertices are remembered."""


class RememberedHull(ProgressiveHull):
    """A progressive hull whose runs go on where the last one has ended; a shorter run takes no time."""

    def __init__(self, outline: Outline, weights: Weights, minimum: Sequence[int]) -> None:
        super().__init__(outline, weights, minimum)
        self.start = outline
        self.sound = True
        """False while moves are made, and for good if one was interrupted in the middle."""
        self._removals: list[Removal] = []
        self.loops.removals = self._removals
        self._lock = Lock()

    def steps(self, count: int, max_cost: float = np.inf) -> Stage[float, Outline]:
        """As in `ProgressiveHull`, whatever counts were asked for before; ``max_cost`` must be infinite."""
        run = self._moving(count, max_cost)
        while True:
            with self._lock:
                self.sound = False
                done = next(run, None)
                self.sound = True
            if done is None:
                return self._outline_at(count)
            yield done

    def _outline_at(self, count: int) -> Outline:
        """The outline when it first had as few vertices, or the last one."""
        if count <= self.loops.total:
            return self.loops.outline()
        start, removals = self.start, self._removals[: max(0, len(self.start.vertices) - count)]
        alive = np.ones(len(start.vertices), dtype=bool)
        alive[[vertex for vertex, _ in removals]] = False
        moved = {v: (x, y, first, last) for _, moves in removals for v, x, y, first, last in moves}
        vertices, spans = start.vertices.copy(), start.spans.copy()
        if moved:
            where, changes = list(moved), list(moved.values())
            vertices[where] = [change[:2] for change in changes]
            spans[where] = [change[2:] for change in changes]
        sizes = np.add.reduceat(alive, start.begins, dtype=np.int64)
        return Outline(vertices[alive], tuple(sizes.tolist()), spans[alive])


_runs: Memory[RememberedHull] = Memory(CAPACITY)


def remembered_hull(outline: Outline, weights: Weights, minimum: Sequence[int]) -> ProgressiveHull:
    """The progressive hull of an outline: one that has been run already, if there is one."""
    size = BYTES_PER_VERTEX * len(outline.vertices)
    if not _runs.has_room(size):
        return ProgressiveHull(outline, weights, minimum)
    key = outline.key, weights, tuple(minimum)
    run = _runs.get(key)
    if run is None or not run.sound:
        run = RememberedHull(outline, weights, minimum)
        _runs.put(key, run, size)
    return run
