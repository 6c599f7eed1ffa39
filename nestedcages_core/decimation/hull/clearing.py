"""Clearing: move an outline outwards to a clearance from the fine mesh, and fill the gaps too narrow for it.

See docs/ablation.md: clearing; clearing: small details built over; clearing: narrow gaps filled.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.broad_phase import near_pairs
from ...geometry.distance import point_edge
from ...geometry.loops import Loops
from ...geometry.mesh import Mesh
from ...geometry.vectors import cross
from ..base import LEAST_PER_LOOP
from .hull_moves import Weights
from .linked_loops import LinkedLoops
from .offset import strict_offset
from .progressive_hull import ProgressiveHull

HULL_OFFSET = 5e-5
"""Distance, in diameters, between hull and fine mesh where there is space, unless the clearance is larger."""

CLOSED_GAP_WIDTH = 1e-9
"""Width, in diameters, below which gaps are filled first: no cage could keep a distance in them
(docs/ablation.md: filling of gaps like round-off)."""

CLEARANCE_RESERVE = 1.05
"""Distance in clearances that outlines keep where there is space: slack for later stages."""

MAX_WIDENINGS = 12
"""Maximum number of consecutive outward steps; short edges and gaps limit each."""

STALLED_RATIO = 0.97
"""Ratio of the largest shortfalls after and before a step above which no further step is made."""

NEGLIGIBLE_SHORTFALL = 1e-6
"""Shortfall, as a fraction of the distance, that needs no further step: far within the reserve."""

MAX_ROUNDS = 12
"""Maximum number of rounds that remove obstacles to wider steps: small details first, then narrow gaps."""

SMALL_DETAIL = 0.2
"""Size in clearances of details that are filled where they keep an outline from reaching the clearance."""

NARROW_GAP = 2.2
"""Width in clearances below which a gap is filled if an outline in it does not reach the clearance; 2 fit exactly."""


def cleared(outline: Loops, fine: Mesh, clearance: float) -> Loops:
    """The outline moved outwards until it keeps the clearance; gaps too narrow for that are filled."""
    for _ in range(MAX_ROUNDS):
        outline, kept = _widened(outline, fine, CLEARANCE_RESERVE * clearance)
        if kept:
            break
        tight = shortfall(outline, fine, clearance) > 0.0
        if not tight.any():
            break
        size = len(outline.vertices)
        outline = without_small_details(outline, (SMALL_DETAIL * clearance) ** 2)
        if len(outline.vertices) == size:
            outline = _without(outline, _in_narrow_gaps(outline, tight, NARROW_GAP * clearance))
        if len(outline.vertices) == size:  # last, since filling a gap may free the corners at its mouth
            outline = _without(outline, tight)
        if len(outline.vertices) == size:
            break
    return outline


def _widened(outline: Loops, fine: Mesh, distance: float) -> tuple[Loops, bool]:
    """The outline with edges closer than `distance` moved outwards, as far as gaps allow; whether all are now."""
    last = np.inf
    for _ in range(MAX_WIDENINGS):
        missing = shortfall(outline, fine, distance)
        worst = float(missing.max())
        if worst <= NEGLIGIBLE_SHORTFALL * distance:
            return outline, True
        if worst > STALLED_RATIO * last:
            break
        wider, stuck = strict_offset(outline, missing, fine.edge_tree)
        if len(stuck):
            break
        outline, last = wider, worst
    return outline, False


def shortfall(outline: Loops, fine: Mesh, distance: float) -> FloatArray:
    """(n,) how much farther out each vertex must move for both its edges to keep a distance."""
    starts, ends = outline.vertices, outline.vertices.take(outline.successor, axis=0)
    fine_starts, fine_ends = fine.edge_tree.starts, fine.edge_tree.ends
    missing = np.zeros(len(starts))
    point, edge = near_pairs(fine.vertices, starts, ends, distance)
    near = fine.vertices.take(point, axis=0), starts.take(edge, axis=0), ends.take(edge, axis=0)
    short = distance - point_edge(*near).distance
    np.maximum.at(missing, edge, short)
    np.maximum.at(missing, outline.successor[edge], short)
    vertex, edge = near_pairs(starts, fine_starts, fine_ends, distance)
    near = starts.take(vertex, axis=0), fine_starts.take(edge, axis=0), fine_ends.take(edge, axis=0)
    short = distance - point_edge(*near).distance
    np.maximum.at(missing, vertex, short)
    return missing


def _in_narrow_gaps(outline: Loops, tight: BoolArray, width: float) -> BoolArray:
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
    unwanted = _in_narrow_gaps(outline, np.ones(len(outline.vertices), dtype=bool), width)
    return _without(outline, unwanted, exact=True)


def without_small_details(outline: Loops, area: float) -> Loops:
    """The outline with details below an area filled, since short edges keep steps short."""
    minimum = [LEAST_PER_LOOP] * len(outline.sizes)
    return ProgressiveHull(outline, Weights(pivot=None), minimum).run(sum(minimum), area)


def _without(outline: Loops, unwanted: BoolArray, *, exact: bool = False) -> Loops:
    """The outline without the unwanted (n,) vertices that can be dropped, which fills the pockets they line."""
    if not unwanted.any():
        return outline
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
