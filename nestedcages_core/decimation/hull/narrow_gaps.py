"""Gaps of an outline that are too narrow for a cage, and how they are filled.

See docs/ablation.md: clearing: narrow gaps filled; filling of gaps like round-off.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from ...geometry.arrays import BoolArray, IntArray
from ...geometry.broad_phase import near_pairs
from ...geometry.distance import point_edge
from ...geometry.loops import Loops
from ...geometry.vectors import cross
from ..budget import LEAST_PER_LOOP

HULL_OFFSET = 5e-5
"""Distance, in diameters, between hull and fine mesh where there is space, unless the clearance is larger."""


CLEARANCE_RESERVE = 1.05
"""Distance in clearances that outlines keep where there is space: slack for later stages."""


def in_narrow_gaps(outline: Loops, tight: BoolArray, width: float) -> BoolArray:
    """(n,) the vertices of pockets whose mouth is narrower than `width` and has a tight (n,) vertex or edge at it.

    A vertex and an edge of a loop are the mouth of a pocket if the vertex lies outside the edge and the stretch of
    loop between them runs clockwise. Where both stretches do, as in the neck of a hole, the one with less area counts.
    """
    starts, ends = outline.vertices, outline.vertices[outline.successor]
    loop = np.repeat(np.arange(len(outline.sizes)), outline.sizes)
    vertex, edge = near_pairs(starts, starts, ends, width)
    end = outline.successor[edge]
    mouth = (loop[vertex] == loop[edge]) & (vertex != edge) & (vertex != end)
    mouth &= tight[vertex] | tight[edge] | tight[end]
    vertex, edge, end = vertex[mouth], edge[mouth], end[mouth]
    outside = cross(ends[edge] - starts[edge], starts[vertex] - starts[edge]) < 0.0
    vertex, edge, end = vertex[outside], edge[outside], end[outside]

    # twice the area of the stretch vertex .. edge, closed by the mouth, and of the rest of the loop
    here = starts - starts.mean(axis=0)
    swept = np.concatenate(([0.0], np.cumsum(cross(here, here[outline.successor]))))
    middle = point_edge(here[vertex], here[edge], here[end]).parameter[:, None]
    middle = here[edge] + middle * (here[end] - here[edge])
    begin, size = outline.begins[loop[vertex]], outline.sizes[loop[vertex]]
    whole = swept[begin + size] - swept[begin]
    forward = swept[edge] - swept[vertex] + np.where(edge < vertex, whole, 0.0)
    forward += cross(here[edge], middle) + cross(middle, here[vertex])
    ahead = np.abs(forward) <= np.abs(whole - forward)
    pocket = np.where(ahead, forward, whole - forward) < 0.0
    first, last = np.where(ahead, vertex + 1, end), np.where(ahead, edge, vertex - 1)
    return _covered(len(starts), first[pocket], last[pocket], begin[pocket], size[pocket])


def is_narrow(outline: Loops, regions: IntArray, width: float) -> bool:
    """Whether two loops that bound the same empty region, of the (L,) given ones, are closer than a width."""
    if len(outline.sizes) == 1:
        return False
    vertex, edge = near_pairs(outline.vertices, outline.vertices, outline.ends, width)
    one, other = outline.loop[vertex], outline.loop[edge]
    return bool(((one != other) & (regions[one] == regions[other])).any())


def _covered(count: int, first: IntArray, last: IntArray, begin: IntArray, size: IntArray) -> BoolArray:
    """(count,) whether each vertex lies in one of K stretches first .. last, within loops that begin and have sizes."""
    first, last = begin + (first - begin) % size, begin + (last - begin) % size
    wraps = first > last
    change = np.zeros(count + 1, dtype=np.int64)
    np.add.at(change, np.concatenate((first, begin[wraps])), 1)
    np.add.at(change, np.concatenate((last + 1, (begin + size)[wraps])), -1)
    covered: BoolArray = np.cumsum(change[:-1]) > 0
    return covered


def without_gaps(outline: Loops, width: float) -> Loops:
    """The outline with all gaps narrower than `width` filled."""
    unwanted = in_narrow_gaps(outline, np.ones(len(outline.vertices), dtype=bool), width)
    return without(outline, unwanted, exact=True)


def without(outline: Loops, unwanted: BoolArray, *, exact: bool = False) -> Loops:
    """The outline without the unwanted (n,) vertices that can be dropped, which fills the pockets they line."""
    if not unwanted.any():
        return outline
    from .linked_loops import LinkedLoops  # few outlines have such gaps

    loops = LinkedLoops(outline, reach=1.0)
    waiting = deque(np.flatnonzero(unwanted).tolist())
    while waiting:
        vertex = waiting.popleft()
        spare = loops.alive[vertex] and loops.sizes[loops.loop_of[vertex]] > LEAST_PER_LOOP
        if spare and loops.can_drop(vertex, exact=exact):
            neighbours = loops.previous[vertex], loops.next[vertex]
            loops.remove(vertex)
            waiting.extend(v for v in neighbours if unwanted[v])
    return loops.outline()
