"""Offset: loops moved outwards, less in narrow gaps, until they touch nothing, or keep a clearance, by exact tests."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.broad_phase import near_pairs
from ...geometry.distance import point_edge
from ...geometry.loops import Loops
from ...geometry.mesh import Mesh
from ...geometry.precision import MOST_HALVINGS, MOST_ROUNDS, NEGLIGIBLE, PART_OF_GAP, PROGRESS_RATIO
from ...geometry.predicates import BoxTree, orientation, segments_intersect
from ...geometry.vectors import cross, dot, norm, rotated_right
from ...tasks import Stage, drain
from ..budget import LEAST_PER_LOOP
from .hull_moves import Weights
from .narrow_gaps import CLEARANCE_RESERVE, in_narrow_gaps, without
from .progressive_hull import ProgressiveHull

MITRE_LIMIT = 2.5
"""Longest step of a vertex in units of the distance its edges move: convex corners below 47 degrees are bevelled, which
takes two vertices, and notches below 47 degrees are followed less far."""

EDGE_FRACTION = 0.2
"""Longest step of a vertex in units of its shorter edge; below 0.5, so that no edge flips."""

SCALE_STEP = 8.0
"""Ratio of steps that share one search radius for gaps."""

ONE_SEARCH = 1000
"""Number of vertices up to which all steps share a search if its radius is less than the mean edge length: it finds few
pairs then, and gaps wider than a step needs do not matter."""

SMALL_DETAIL = 0.2
"""Size in clearances of details that are filled where they keep an outline from reaching the clearance."""


def strict_offset(outline: Loops, distance: FloatArray | float, obstacle: BoxTree) -> tuple[Loops, IntArray]:
    """The outline with its edges moved outwards by `distance`, less in narrow gaps; and the vertices that are stuck.

    distance: a length, or one per vertex (n,); 0 keeps a vertex where it is. obstacle: further edges to stay clear of,
    in addition to those of the result.

    The result has a vertex more for every sharp convex corner that moves. Where the second array (K,), indices of
    input vertices, is empty, its moved edges touch neither each other nor the obstacle, exactly.
    """
    return drain(offsetting(outline, distance, obstacle))


def offsetting(outline: Loops, distance: FloatArray | float, obstacle: BoxTree) -> Stage[None, tuple[Loops, IntArray]]:
    """`strict_offset` as a generator that yields between its searches."""
    lengths = norm(outline.ends - outline.vertices)
    distance = np.broadcast_to(distance, len(lengths))
    longest = np.minimum(MITRE_LIMIT * distance, EDGE_FRACTION * np.minimum(lengths, lengths[outline.predecessor]))
    longest = np.minimum(longest, (yield from _room_in_gaps(outline, longest)))
    outline, source, direction = _mitred(outline, longest > 0.0)
    step = np.minimum(distance[source], longest[source] / norm(direction))
    changed = step > 0.0
    touching = np.zeros(0, dtype=np.int64)
    for _ in range(MOST_HALVINGS):
        yield
        moved = outline.moved(outline.vertices + step[:, None] * direction)
        touching = _touching_edges(moved, np.flatnonzero(changed | changed[outline.successor]), obstacle)
        if len(touching) == 0:
            break
        changed = np.zeros(len(step), dtype=bool)
        for vertex in (touching, outline.successor[touching]):
            changed[vertex] = changed[outline.successor[vertex]] = changed[outline.predecessor[vertex]] = True
        step[changed] *= 0.5
    return moved, np.unique(source[np.concatenate((touching, outline.successor[touching]))])


def _room_in_gaps(outline: Loops, reach: FloatArray) -> Stage[None, FloatArray]:
    """(n,) upper bound on each step: a fraction of the gaps between the vertex, or its edges, and what faces them.

    reach: (n,) upper bound on each step without gaps; much wider gaps are not searched.
    """
    starts, ends = outline.vertices, outline.ends
    room = np.full(len(starts), np.inf)
    edge_reach = np.maximum(reach, reach[outline.successor])
    if not edge_reach.any():
        return room
    scale, mean_length = float(edge_reach.max()), float(norm(ends - starts).mean())

    def of_scale(length: FloatArray) -> BoolArray:
        return np.asarray((length <= scale) & (length * SCALE_STEP > scale))

    while True:
        radius = scale / PART_OF_GAP
        everything = np.arange(len(starts))
        points, edges = np.flatnonzero(of_scale(reach)), np.flatnonzero(of_scale(edge_reach))
        few = len(starts) <= ONE_SEARCH and radius <= mean_length
        searches = [(points, everything), (everything, edges)]
        if few or len(points) == len(starts) or len(edges) == len(starts):
            searches = [(everything, everything)]
        for points, edges in searches:
            yield
            near = near_pairs(starts.take(points, axis=0), starts.take(edges, axis=0), ends.take(edges, axis=0), radius)
            vertex, edge = points.take(near[0]), edges.take(near[1])
            foreign = ((vertex != edge) & (vertex != outline.successor.take(edge))).nonzero()[0]
            vertex, edge = vertex.take(foreign), edge.take(foreign)
            pair = starts.take(edge, axis=0), ends.take(edge, axis=0), starts.take(vertex, axis=0)
            facing = (orientation(*pair) < 0).nonzero()[0]
            vertex, edge = vertex.take(facing), edge.take(facing)
            end = outline.successor.take(edge)
            start, stop, place = (corner.take(facing, axis=0) for corner in pair)
            gap = PART_OF_GAP * point_edge(place, start, stop).distance
            for one in (vertex, edge, end):
                np.minimum.at(room, one, gap)
        smaller = edge_reach[(edge_reach > 0.0) & (edge_reach * SCALE_STEP <= scale)]
        if few or len(smaller) == 0:
            return room
        scale = float(smaller.max())


def _mitred(outline: Loops, moving: BoolArray) -> tuple[Loops, IntArray, FloatArray]:
    """The outline with moving (n,) sharp corners doubled; the old index (N,) of each vertex, and how it moves (N, 2).

    With the unit normals n₁, n₂ of its edges, a vertex that goes 2 (n₁ + n₂) / |n₁ + n₂|² moves both by one length. At
    a sharp convex corner of half angle α, whose tip points along t, the two vertices of a cut that is one length away
    go n₁ + h e₁ and n₂ - h e₂, with h = (1 - sin α) / cos α and e₁, e₂ along the edges.
    """
    after = outline.ends - outline.vertices
    after = after / norm(after)[:, None]
    before = after.take(outline.predecessor, axis=0)
    n1, n2 = rotated_right(before), rotated_right(after)
    sine = 0.5 * norm(n1 + n2)  # of half the angle between the edges
    sharp = sine * MITRE_LIMIT < 1.0
    tip = (before - after) / np.maximum(norm(before - after), 1.0)[:, None]
    mitre = (n1 + n2) / (2.0 * np.maximum(sine, 1.0 / MITRE_LIMIT) ** 2)[:, None]
    direction = np.where(sharp[:, None], -MITRE_LIMIT * tip, mitre)
    cut = moving & sharp & (cross(before, after) >= 0.0)

    source = np.repeat(np.arange(len(cut)), np.where(cut, 2, 1))
    second = np.flatnonzero(np.diff(source, prepend=-1) == 0)
    h = ((1.0 - sine) / np.sqrt(np.maximum(1.0 - sine**2, 0.5)))[:, None]
    direction = direction.take(source, axis=0)
    corner = source[second]
    direction[second - 1] = (n1 + h * before).take(corner, axis=0)
    direction[second] = (n2 - h * after).take(corner, axis=0)
    doubled = np.add.reduceat(np.where(cut, 2, 1), outline.begins)
    return Loops.of(outline.vertices.take(source, axis=0), doubled), source, direction


def _touching_edges(outline: Loops, watched: IntArray, obstacle: BoxTree) -> IntArray:
    """Edges that touch the obstacle or an edge that is not their neighbour, or fold back on a neighbour.

    watched: (W,) the edges to test against all others.
    """
    everything = outline.tree
    if len(watched) == len(everything):
        i, j = everything.self_pairs()
        k, other = everything.pairs(obstacle)
    else:
        part = BoxTree(*everything.segments(watched))
        i, j = part.pairs(everything)
        i = watched[i]
        k, other = part.pairs(obstacle)
        k = watched[k]
    apart = (i != j) & (outline.successor[i] != j) & (outline.successor[j] != i)
    i, j = i[apart], j[apart]
    crossing = segments_intersect(*everything.segments(i), *everything.segments(j))
    against = segments_intersect(*everything.segments(k), *obstacle.segments(other))
    folded = watched[_folds_back(outline, watched)]
    touching: IntArray = np.unique(np.concatenate((i[crossing], j[crossing], k[against], folded)))
    return touching


def _folds_back(outline: Loops, edges: IntArray) -> BoolArray:
    """(K,) whether the edge after each of some edges (K,) runs back over it."""
    middle = outline.successor[edges]
    a, b, c = (outline.vertices.take(v, axis=0) for v in (edges, middle, outline.successor[middle]))
    folded: BoolArray = orientation(a, b, c) == 0
    flat = folded.nonzero()[0]
    folded[flat] = dot((b - a)[flat], (c - b)[flat]) <= 0.0
    return folded


def cleared(outline: Loops, fine: Mesh, clearance: float) -> Loops:
    """The outline moved outwards until it keeps the clearance; gaps too narrow for that are filled.

    See docs/ablation.md: clearing; clearing: small details built over.
    """
    for _ in range(MOST_ROUNDS):
        outline, kept = _widened(outline, fine, CLEARANCE_RESERVE * clearance)
        if kept:
            break
        tight = shortfall(outline, fine, clearance) > 0.0
        if not tight.any():
            break
        size = len(outline.vertices)
        outline = without_small_details(outline, (SMALL_DETAIL * clearance) ** 2)
        if len(outline.vertices) == size:
            outline = without(outline, in_narrow_gaps(outline, tight, 2.0 * CLEARANCE_RESERVE * clearance))
        if len(outline.vertices) == size:  # last, since filling a gap may free the corners at its mouth
            outline = without(outline, tight)
        if len(outline.vertices) == size:
            break
    return outline


def _widened(outline: Loops, fine: Mesh, distance: float) -> tuple[Loops, bool]:
    """The outline with edges closer than `distance` moved outwards, as far as gaps allow; whether all are now."""
    last = np.inf
    for _ in range(MOST_ROUNDS):
        missing = shortfall(outline, fine, distance)
        worst = float(missing.max())
        if worst <= NEGLIGIBLE * distance:
            return outline, True
        if worst > PROGRESS_RATIO * last:
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


def without_small_details(outline: Loops, area: float) -> Loops:
    """The outline with details below an area filled, since short edges keep steps short."""
    minimum = [LEAST_PER_LOOP] * len(outline.sizes)
    return ProgressiveHull(outline, Weights(pivot=None), minimum).run(sum(minimum), area)
