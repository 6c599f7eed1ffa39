"""Greedy runs of hulls are remembered: another number of vertices around the same shape goes on where one has ended.

A run to few vertices passes all larger numbers on its way: a record of its moves has the hull for each of them. Where
one number is tried after the other, as with a slider or for levels within a distance, most runs are known. What is
remembered changes no result.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from hashlib import sha256
from threading import Lock

import numpy as np

from ..stages import Stage
from .linked_loops import Removal
from .outline import Outline
from .progressive_hull import ProgressiveHull, Weights

MAX_VERTICES = 16_000
"""Vertices of all outlines whose runs are remembered, about 2 kB each."""

MAX_SIZE = 4_000
"""Size of an outline up to which its runs are remembered."""


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
        run = super().steps(count, max_cost)
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


_runs: OrderedDict[bytes, RememberedHull] = OrderedDict()
_lock = Lock()


def remembered_hull(outline: Outline, weights: Weights, minimum: Sequence[int]) -> ProgressiveHull:
    """The progressive hull of an outline: one that has been run already, if there is one."""
    if len(outline.vertices) > MAX_SIZE:
        return ProgressiveHull(outline, weights, minimum)
    key = sha256(repr((outline.sizes, weights, list(minimum))).encode())
    key.update(outline.vertices.tobytes())
    key.update(outline.spans.tobytes())
    name = key.digest()
    with _lock:
        run = _runs.get(name)
        if run is not None and run.sound:
            _runs.move_to_end(name)
            return run
    run = RememberedHull(outline, weights, minimum)
    with _lock:
        _runs[name] = run
        while sum(len(each.start.vertices) for each in _runs.values()) > MAX_VERTICES:
            _runs.popitem(last=False)
    return run


def forget() -> None:
    """Forget all runs: frees their memory."""
    with _lock:
        _runs.clear()
