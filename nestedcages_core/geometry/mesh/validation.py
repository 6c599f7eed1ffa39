"""Validation of plain arrays, done once; each fault has one sentence with its place and its remedy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...errors import InvalidMeshError, unreadable
from ..arrays import AnyArray, FloatArray, IntArray
from ..loops import Loops
from ..predicates import orientation, segments_intersect
from ..vectors import crossing_point, format_point

MAX_COORDINATE, MIN_EXTENT = 1e150, 1e-150
"""Largest coordinate and smallest bounding box, in input units, whose squares stay within the range of a double."""


def as_vertices(data: Any) -> FloatArray:
    """A read-only copy as (n, 2) float64, finite and of a workable size. Raises InvalidMeshError."""
    given = _as_array(data, "vertices")
    if given.size == 0:
        said = "The mesh is empty: it has no vertices; give at least one loop of three vertices."
        raise InvalidMeshError(said, code="mesh.empty")
    if given.ndim != 2 or given.shape[1] != 2:
        raise unreadable(f"The vertices have shape {given.shape}, but (n, 2) is needed; give two numbers per vertex.")
    vertices = _as_floats(given, "vertices")
    if not np.isfinite(vertices).all():
        bad = int(np.isfinite(vertices).all(axis=1).argmin())
        said = f"Vertex {bad} has the coordinates {format_point(vertices[bad])}; give finite numbers, or remove it."
        raise InvalidMeshError(said, code="mesh.not_finite", vertex=bad)
    if np.abs(vertices).max() > MAX_COORDINATE:
        far = int(np.abs(vertices).max(axis=1).argmax())
        where = f"{format_point(vertices[far])} is farther out than {MAX_COORDINATE:g}"
        said = f"Vertex {far} at {where}, {_OUT_OF_RANGE} down."
        raise InvalidMeshError(said, code="mesh.out_of_range", vertex=far, place=vertices[far])
    if len(vertices) > 1 and 0.0 < np.ptp(vertices, axis=0).max() < MIN_EXTENT:
        said = f"The shape around {format_point(vertices[0])} is smaller than {MIN_EXTENT:g}, {_OUT_OF_RANGE} up."
        raise InvalidMeshError(said, code="mesh.out_of_range", place=vertices[0])
    vertices.flags.writeable = False
    return vertices


_OUT_OF_RANGE = "where areas leave the range of floating-point numbers; scale it"


def as_rings(loops: Iterable[ArrayLike]) -> tuple[FloatArray, list[int]]:
    """The points of closed loops (k, 2), one after the other, and their numbers; without repeated closing points.

    Raises InvalidMeshError.
    """
    try:
        given = [np.asarray(loop) for loop in loops]
    except Exception as error:
        said = f"The loops cannot be read as arrays ({error}); give a list of loops, each with rows (x, y)."
        raise unreadable(said) from error
    if not given:
        said = "The mesh is empty: there are no loops; give at least one loop of three points."
        raise InvalidMeshError(said, code="mesh.empty")
    rings = []
    for k, points in enumerate(given):
        if points.ndim != 2 or points.shape[1] != 2:
            raise unreadable(f"Loop {k} has shape {points.shape}, but (k, 2) is needed; give rows (x, y).")
        ring = points[:-1] if len(points) > 1 and bool(np.all(points[0] == points[-1])) else points
        if len(ring) < 3:
            at = f" at {format_point(as_vertices(ring)[0])}" if len(ring) else ""
            said = f"Loop {k}{at} has {len(ring)} of the three vertices that a loop needs; add some, or remove it."
            raise InvalidMeshError(said, code="mesh.open")
        rings.append(ring)
    try:
        together = np.concatenate(rings)
    except TypeError as error:
        kinds = ", ".join(dict.fromkeys(str(ring.dtype) for ring in rings))
        raise unreadable(f"The loops hold different kinds of values ({kinds}); give numbers.") from error
    return as_vertices(together), [len(ring) for ring in rings]


def as_edges(data: Any, count: int) -> IntArray:
    """A copy as (m, 2) int64 that joins `count` vertices into closed loops. Raises InvalidMeshError."""
    given = _as_array(data, "edges")
    if given.size == 0:
        raise InvalidMeshError("The mesh has no edges; join the vertices into closed loops.", code="mesh.empty")
    if given.ndim != 2 or given.shape[1] != 2:
        raise unreadable(f"The edges have shape {given.shape}, but (m, 2) is needed; give two vertex indices per edge.")
    if given.dtype.kind not in "iu":
        given = _as_floats(given, "edges")
    wrong = (given < 0) | (given >= count)
    if given.dtype.kind == "f":
        wrong |= np.floor(given) != given
    if wrong.any():
        k = int(wrong.any(axis=1).argmax())
        said = (
            f"Edge {k} joins {' and '.join(map(str, given[k].tolist()))}, but the {count} vertices are numbered from 0 "
            f"to {count - 1}, in whole numbers; correct the index."
        )
        raise InvalidMeshError(said, code="mesh.edge_index", edges=[k])
    edges: IntArray = given.astype(np.int64)
    _check_degrees(edges, count)
    return edges


def _as_array(data: Any, what: str) -> AnyArray:
    try:
        return np.asarray(data)
    except Exception as error:
        said = f"The {what} cannot be read as an array ({error}); give one row of two numbers each."
        raise unreadable(said) from error


def _as_floats(given: AnyArray, what: str) -> FloatArray:
    """A float64 copy of an array of real numbers."""
    try:
        if given.dtype.kind not in "iufO":
            raise TypeError(f"they are of type {given.dtype}")
        with np.errstate(all="ignore"):
            return np.array(given, dtype=np.float64, order="C", subok=False)
    except Exception as error:
        raise unreadable(f"The {what} are not all real numbers ({error}); give numbers only.") from error


def _check_degrees(edges: IntArray, count: int) -> None:
    """Raise unless every vertex is the end of exactly two different edges."""
    low, high = np.minimum(*edges.T), np.maximum(*edges.T)
    if (low == high).any():
        k = int((low == high).argmax())
        said = f"Edge {k} joins vertex {low[k]} to itself; remove the edge."
        raise InvalidMeshError(said, code="mesh.edge_index", edges=[k])
    key = low * count + high
    order = key.argsort(kind="stable")
    same = np.flatnonzero(np.diff(key[order]) == 0)
    if len(same):
        i, j = order[same[0] : same[0] + 2]
        said = (
            f"Edges {i} and {j} both join vertices {low[i]} and {high[i]}; remove one: a loop has each edge once "
            "and at least three vertices."
        )
        raise InvalidMeshError(said, code="mesh.edge_index", edges=[i, j])
    degree = np.bincount(edges.ravel(), minlength=count)
    if (degree != 2).any():
        vertex = int((degree != 2).argmax())
        said = f"At vertex {vertex} meet {degree[vertex]} edges, but loops pass each vertex once; split or remove it."
        if degree[vertex] < 2:
            said = f"Loops are open at vertex {vertex}, the end of {degree[vertex]} edges; close them, or remove it."
        raise InvalidMeshError(said, code="mesh.open", vertices=[vertex])


def check_simple(order: Loops) -> None:
    """Check that loops neither cross nor touch each other or themselves. Raises InvalidMeshError with a place."""
    points, vertex, loop, ahead, ends = order.vertices, order.numbers, order.loop, order.ahead, order.ends
    flat = np.flatnonzero((points[:, 0] == ends[:, 0]) & (points[:, 1] == ends[:, 1]))
    if len(flat):
        k = flat[0]
        pair, where = [vertex[k], vertex[ahead[k]]], f"in loop {loop[k]} and both lie at {format_point(points[k])}"
        said = f"Vertices {pair[0]} and {pair[1]} follow each other {where}; remove one of them."
        raise InvalidMeshError(said, code="mesh.repeated_vertex", loops=[loop[k]], vertices=pair, place=points[k])
    _check_fold_back(order)
    tree = order.tree
    for i, j in tree.blocks():
        apart = (ahead[i] != j) & (ahead[j] != i)
        i, j = i[apart], j[apart]
        hit = segments_intersect(*tree.segments(i), *tree.segments(j))
        if hit.any():
            _raise_contact(order, i[hit], j[hit])


def _check_fold_back(order: Loops) -> None:
    """Raise where a loop runs straight back over the edge it came by."""
    points, ahead = order.vertices, order.ahead
    corner = points.take(ahead, axis=0)
    after = corner.take(ahead, axis=0)
    straight = np.flatnonzero(orientation(points, corner, after) == 0)
    before, corner, after = points[straight], corner[straight], after[straight]
    back = (np.sign(corner - before) != np.sign(after - corner)).any(axis=1)
    if back.any():
        k = ahead[straight[back.argmax()]]
        loop, vertex = order.loop[k], order.numbers[k]
        said = f"Loop {loop} turns back over itself at vertex {vertex}, {format_point(points[k])}; move or remove it."
        raise InvalidMeshError(said, code="mesh.spike", loops=[loop], vertices=[vertex], place=points[k])


def _raise_contact(order: Loops, i: IntArray, j: IntArray) -> None:
    """Raise for the first of the pairs (i, j) of edges in contact: a shared point, a touch or a crossing."""
    points, vertex, loop, ahead, ends = order.vertices, order.numbers, order.loop, order.ahead, order.ends

    def edge(k: int) -> str:
        return f"edge {vertex[k]}-{vertex[ahead[k]]} of loop {loop[k]}"

    for here, there in ((i, j), (ahead[i], j), (i, ahead[j]), (ahead[i], ahead[j])):
        same = (points[here] == points[there]).all(axis=1)
        if same.any():
            k, m = here[same.argmax()], there[same.argmax()]
            said = (
                f"Vertices {vertex[k]} of loop {loop[k]} and {vertex[m]} of loop {loop[m]} both lie at "
                f"{format_point(points[k])}; move one of them, so that the boundary does not touch itself."
            )
            pair = [vertex[k], vertex[m]]
            raise InvalidMeshError(
                said, code="mesh.repeated_vertex", loops=[loop[k], loop[m]], vertices=pair, place=points[k]
            )
    first = np.lexsort((j, i))[0]
    k, m = i[first], j[first]
    loops, at = list(dict.fromkeys([loop[k], loop[m]])), crossing_point(points[k], ends[k], points[m], ends[m])
    corners = [vertex[k], vertex[ahead[k]], vertex[m], vertex[ahead[m]]]
    for a, b in ((k, m), (ahead[k], m), (m, k), (ahead[m], k)):
        if segments_intersect(points[[a]], points[[a]], points[[b]], ends[[b]])[0]:
            loops, at, corners = [loop[a], loop[b]], points[a], [vertex[a], vertex[b], vertex[ahead[b]]]
            said = (
                f"Vertex {vertex[a]} of loop {loop[a]} lies on {edge(b)} at {format_point(at)}; move it off the edge."
            )
            break
    else:
        what = f"Loop {loop[k]} crosses itself" if len(loops) == 1 else f"Loops {loop[k]} and {loop[m]} cross"
        remedy = "move their vertices apart" if len(loops) == 1 else "move them apart, or unite them"
        said = f"{what} near {format_point(at)}: {edge(k)} meets {edge(m)}; {remedy}."
    raise InvalidMeshError(said, code="mesh.crossing", loops=loops, vertices=corners, place=at)
