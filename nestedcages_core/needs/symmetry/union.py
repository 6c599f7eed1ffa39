"""Union and intersection of solids whose outlines may cross, touch and coincide: an arrangement of their edges.

Vertices closer than a tolerance are merged, and edges are divided at crossings and at vertices on them, until nothing
changes. A piece is on the outline of the result where the solid lies on one side of it only. The result is accurate to
the tolerance; exact predicates judge what is built on it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from ...errors import InvalidMeshError
from ...geometry.arrays import FloatArray, IntArray
from ...geometry.broad_phase import near_pairs
from ...geometry.mesh import Mesh
from ...geometry.predicates import BoxTree, segments_intersect, winding_number
from ...geometry.vectors import cross

MERGED = 1e-9
"""Distance, in diagonals, below which vertices are merged and a vertex lies on an edge."""

MAX_ROUNDS = 12
"""Maximum number of rounds that divide edges; new vertices rarely need more than two."""

NEGLIGIBLE_LOOP = 1e-12
"""Area, in squared diagonals, below which a loop of the result is dropped."""


def overlay(meshes: Sequence[Mesh], *, intersection: bool = False) -> Mesh:
    """The union of the solids of some meshes, or their intersection.

    Raises InvalidMeshError where the result is empty or its loops touch.
    """
    points = np.concatenate([mesh.vertices for mesh in meshes])
    low, high = points.min(axis=0), points.max(axis=0)
    diagonal = float(np.hypot(*(high - low)))
    firsts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    owner = np.repeat(np.arange(len(meshes)), np.diff(firsts))
    start = np.arange(len(points))
    end = np.concatenate([mesh.successor + first for mesh, first in zip(meshes, firsts[:-1], strict=True)])
    points, start, end, owner = _arranged(points, start, end, owner, MERGED * diagonal)
    start, end = _boundary(points, start, end, owner, len(meshes), intersection)
    loops = [loop for loop in _linked(points, start, end) if abs(_area(loop)) > NEGLIGIBLE_LOOP * diagonal**2]
    if not loops:
        raise InvalidMeshError("The shapes have nothing in common.", code="overlay.empty")
    return Mesh.from_loops(loops)


def _arranged(
    points: FloatArray, start: IntArray, end: IntArray, owner: IntArray, tolerance: float
) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    """Points, and pieces of edges between them that meet at their ends only. Raises InvalidMeshError."""
    for _ in range(MAX_ROUNDS):
        points, start, end, owner = _merged(points, start, end, owner, tolerance)
        unique, piece = np.unique(np.sort(np.stack([start, end], axis=1), axis=1), axis=0, return_inverse=True)
        a, b = points[unique[:, 0]], points[unique[:, 1]]
        used = np.unique(unique)
        vertex, edge = near_pairs(points[used], a, b, tolerance)
        vertex = used[vertex]
        inside = (vertex != unique[edge, 0]) & (vertex != unique[edge, 1])
        vertex, edge = vertex[inside], edge[inside]
        if len(vertex) == 0:
            i, j = BoxTree(a, b).self_pairs()
            apart = (unique[i][:, :, None] != unique[j][:, None, :]).all(axis=(1, 2))
            i, j = i[apart], j[apart]
            hit = segments_intersect(a[i], b[i], a[j], b[j])
            i, j = i[hit], j[hit]
            if len(i) == 0:
                return points, start, end, owner
            along, across = b[i] - a[i], b[j] - a[j]
            share = cross(a[j] - a[i], across) / cross(along, across)
            new = a[i] + np.clip(share, 0.0, 1.0)[:, None] * along
            number = len(points) + np.arange(len(i))
            points = np.concatenate([points, new])
            vertex, edge = np.concatenate([number, number]), np.concatenate([i, j])
        start, end, owner = _divided(points, start, end, owner, piece, unique, vertex, edge)
    raise InvalidMeshError(
        "The outlines cross each other in too many places that are too close together.", code="mesh.crossing"
    )


def _merged(
    points: FloatArray, start: IntArray, end: IntArray, owner: IntArray, tolerance: float
) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    """The same with points closer than the tolerance made one: the first of them."""
    pairs = scipy.spatial.cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    if len(pairs):
        count = len(points)
        graph = scipy.sparse.coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
        _, group = scipy.sparse.csgraph.connected_components(graph, directed=False)
        first = np.full(count, count)
        np.minimum.at(first, group, np.arange(count))
        name = first[group]
        start, end = name[start], name[end]
        kept = start != end
        start, end, owner = start[kept], end[kept], owner[kept]
    return points, start, end, owner


def _divided(
    points: FloatArray,
    start: IntArray,
    end: IntArray,
    owner: IntArray,
    piece: IntArray,
    unique: IntArray,
    vertex: IntArray,
    edge: IntArray,
) -> tuple[IntArray, IntArray, IntArray]:
    """The edges with those divided that have vertices (K,) on their undirected pieces (K,)."""
    a = points[unique[:, 0]]
    along = points[unique[:, 1]] - a
    place = ((points[vertex] - a[edge]) * along[edge]).sum(axis=1)
    order = np.lexsort((place, edge))
    vertex, edge = vertex[order], edge[order]
    new_start, new_end, new_owner = [], [], []
    bounds = np.searchsorted(edge, np.arange(len(unique) + 1))
    cut = np.diff(bounds)[piece] > 0
    for k in np.flatnonzero(cut).tolist():
        between = vertex[bounds[piece[k]] : bounds[piece[k] + 1]].tolist()
        chain = [start[k], *(between if start[k] == unique[piece[k], 0] else between[::-1]), end[k]]
        new_start += chain[:-1]
        new_end += chain[1:]
        new_owner += [owner[k]] * (len(chain) - 1)
    return (
        np.concatenate([start[~cut], np.array(new_start, np.int64)]),
        np.concatenate([end[~cut], np.array(new_end, np.int64)]),
        np.concatenate([owner[~cut], np.array(new_owner, np.int64)]),
    )


def _boundary(
    points: FloatArray, start: IntArray, end: IntArray, owner: IntArray, count: int, intersection: bool
) -> tuple[IntArray, IntArray]:
    """The pieces with the resulting solid on their left only."""
    forward = start < end
    undirected = np.stack([np.where(forward, start, end), np.where(forward, end, start)], axis=1)
    unique, piece = np.unique(undirected, axis=0, return_inverse=True)
    middle = 0.5 * (points[unique[:, 0]] + points[unique[:, 1]])
    left, right = np.full((2, len(unique)), intersection)
    combine = np.logical_and if intersection else np.logical_or
    for k in range(count):
        mine = owner == k
        net: FloatArray = np.zeros(len(unique))
        np.add.at(net, piece[mine], np.where(forward[mine], 1.0, -1.0))
        beside = np.flatnonzero(net == 0.0)
        bounding = np.flatnonzero(mine)[net[piece[mine]] != 0.0]
        inside = np.zeros(len(unique), bool)
        inside[beside] = winding_number(middle[beside], points[start[bounding]], points[end[bounding]]) > 0
        left = combine(left, np.where(net == 0, inside, net > 0))
        right = combine(right, np.where(net == 0, inside, net < 0))
    ahead, back = unique[left & ~right], unique[right & ~left]
    return np.concatenate([ahead[:, 0], back[:, 1]]), np.concatenate([ahead[:, 1], back[:, 0]])


def _linked(points: FloatArray, start: IntArray, end: IntArray) -> list[FloatArray]:
    """The loops of directed pieces with the solid on their left; corners of it that meet in a point stay apart."""
    leaving: dict[int, list[int]] = {}
    for k, vertex in enumerate(start.tolist()):
        leaving.setdefault(vertex, []).append(k)
    angle = np.arctan2(*(points[end] - points[start]).T[::-1])
    following = np.empty(len(start), np.int64)
    for k, vertex in enumerate(end.tolist()):
        choices = leaving[vertex]
        clockwise = (angle[k] + np.pi - angle[choices]) % (2.0 * np.pi)
        following[k] = choices[int(np.argmin(clockwise))]
    loops, seen = [], np.zeros(len(start), bool)
    for first in range(len(start)):
        walked = []
        k = first
        while not seen[k]:
            seen[k] = True
            walked.append(start[k])
            k = following[k]
        if len(walked) > 2:
            loops.append(points[walked])
    return loops


def _area(loop: FloatArray) -> float:
    here = loop - loop[0]
    return 0.5 * float(cross(here, np.roll(here, -1, axis=0)).sum())
