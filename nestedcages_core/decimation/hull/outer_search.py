"""The outer hull of an offset outline by greedy runs, certified."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...errors import InvalidMeshError, NestingError
from ...geometry.arrays import FloatArray
from ...geometry.broad_phase import near_pairs
from ...geometry.distance import point_edge
from ...geometry.loops import Loops
from ...geometry.mesh import Mesh
from ...geometry.precision import ROUND_OFF
from ...geometry.vectors import place as in_words
from ...tasks import Stage, mapped
from ..budget import count_fault
from ..request import Request
from .hull_moves import Weights
from .narrow_gaps import CLEARANCE_RESERVE, HULL_OFFSET, without_gaps
from .offset import cleared, offsetting, without_small_details
from .progressive_hull import ProgressiveHull

ROUGH_WEIGHTS = Weights(drop=0.55, extend=1.1, slide=0.8, pivot=1.1, spike=0.03)
"""Cheap notches: best on rough shapes, where notches should be filled before bumps are extended."""

FURTHER_WEIGHTS = (Weights(), Weights(drop=2.0, pivot=0.5, reach=8.0), Weights(drop=0.4, extend=0.4, slide=2.0))
"""Other weights, tried where the first run leaves too many vertices."""

MIN_STAGE_SIZE, STAGE_SIZE_FACTOR = 100, 3
"""Size at which an outline is moved to the clearance: a minimum, and a multiple of the wanted number of vertices."""

MANY_STAGES, THINNED = 20, 0.02
"""Vertices for each of that size from which an outline is thinned first, and how far, in distances of the hull."""

LEAST_CHORDS = 8
"""Chords that each loop keeps, if it has as many edges."""


def greedy_hull(request: Request, clearance: float) -> Stage[float, Mesh]:
    """The hull of a request. Raises NestingError."""
    outline = without_gaps(request.outline, ROUND_OFF * request.outline.diameter)
    plain = without_small_details(outline, 0.0)  # (docs/ablation.md: details like round-off built over)
    yield 0.0
    smallest: Loops | None = None
    starts = [outline, plain] if len(plain.vertices) < len(outline.vertices) else [outline]
    if request.per_loop is None and len(outline.vertices) > MANY_STAGES * _stage_size(request):
        starts.insert(0, thinned(outline, THINNED * HULL_OFFSET * outline.diameter))
    for start in starts:
        distance = max(HULL_OFFSET * outline.diameter, CLEARANCE_RESERVE * clearance)
        offset, stuck = yield from mapped(offsetting(start, distance, request.fine.edge_tree), lambda _: 0.0)
        runs = _progressive_hulls(offset, request, clearance) if len(stuck) == 0 else iter(())
        while True:
            try:
                found = next(runs)
            except StopIteration:
                break
            if isinstance(found, float):
                yield found
                continue
            if len(found.vertices) > request.target:
                smallest = min(smallest or found, found, key=lambda hull: len(hull.vertices))
            elif (mesh := _certified(found, request, clearance)) is not None:
                return mesh
    if smallest is not None:
        raise NestingError(count_fault(request.total, len(smallest.vertices)))
    tightest = _tightest(outline)
    raise NestingError(
        f"There is no room for a cage near {in_words(tightest)}: a gap there is too narrow "
        "for numbers of this size; widen it, or move the shape closer to the origin.",
        code="clearance.no_room",
        place=tightest,
    )


def _progressive_hulls(outline: Loops, request: Request, clearance: float) -> Iterator[float | Loops]:
    """Hulls of an outline by runs with different weights, and the fraction done in between."""
    # without pivots, which would cost area and a third of the time
    rough = ProgressiveHull(outline, replace(ROUGH_WEIGHTS, pivot=None), request.minimum)
    stage = yield from rough.steps(_stage_size(request))
    stage = cleared(stage, request.fine, clearance)
    for weights in (ROUGH_WEIGHTS, *FURTHER_WEIGHTS):
        yield (yield from ProgressiveHull(stage, weights, request.minimum).steps(request.target))


def _stage_size(request: Request) -> int:
    return max(MIN_STAGE_SIZE, STAGE_SIZE_FACTOR * request.target)


def _certified(hull: Loops, request: Request, clearance: float) -> Mesh | None:
    """The mesh of a hull, if it strictly encloses the fine mesh."""
    try:
        mesh = request.coarse(hull)
    except InvalidMeshError:
        return None
    if CLEARANCE_RESERVE * clearance > HULL_OFFSET * request.outline.diameter:
        mesh = request.with_room(mesh, clearance)
    return mesh if request.nests(mesh) else None


def _tightest(outline: Loops) -> FloatArray:
    """The vertex closest to an edge that does not end in it."""
    starts, successor = outline.vertices, outline.successor
    vertex, edge = near_pairs(starts, starts, starts[successor], HULL_OFFSET * outline.diameter)
    apart = (vertex != edge) & (vertex != successor[edge])
    vertex, edge = vertex[apart], edge[apart]
    distance = point_edge(starts[vertex], starts[edge], starts[successor[edge]]).distance
    place: FloatArray = starts[vertex[distance.argmin()] if len(vertex) else 0]
    return place


def thinned(outline: Loops, tolerance: float) -> Loops:
    """The outline with chords of 2, 4, 8, … edges from which no vertex in between is farther than a tolerance."""
    rings = [_thinned(ring, tolerance) for ring in outline.split()]
    return Loops.of(np.concatenate(rings), [len(ring) for ring in rings])


def _thinned(ring: FloatArray, tolerance: float) -> FloatArray:
    """The same for a loop (k, 2)."""
    kept, straight, length = np.ones(len(ring), bool), np.ones(len(ring), bool), 2
    while straight.any() and len(ring) >= LEAST_CHORDS * length:
        count = len(ring) // length
        straight = straight[: 2 * count : 2] & straight[1 : 2 * count : 2]
        first = length * np.flatnonzero(straight)
        start, end = (ring[at % len(ring)].repeat(length - 1, axis=0) for at in (first, first + length))
        between = ring[(first[:, None] + np.arange(1, length)).ravel()]
        distance = point_edge(between, start, end).distance.reshape(len(first), length - 1).max(axis=1)
        straight[first // length] = distance <= tolerance
        kept[length * np.flatnonzero(straight) + length // 2] = False
        length *= 2
    left: FloatArray = ring[kept]
    return left
