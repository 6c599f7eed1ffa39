"""Validation of plain arrays, done once; each fault gets one sentence with its place and its remedy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...errors import InvalidMeshError, unreadable
from ..arrays import AnyArray, FloatArray, IntArray
from ..loops import Loops
from ..predicates import orientation, segments_intersect
from ..vectors import place

MAX_COORDINATE, MIN_EXTENT = 1e150, 1e-150
"""Largest coordinate and smallest bounding box, in input units, whose squares stay within the range of a double."""


def as_vertices(data: Any) -> FloatArray:
    """A read-only copy as (n, 2) float64, finite and of a workable size. Raises InvalidMeshError."""
    given = as_array(data, "vertices")
    if given.size == 0:
        raise InvalidMeshError(
            "The mesh is empty: it has no vertices; give at least one loop of three vertices.", code="mesh.empty"
        )
    if given.ndim != 2 or given.shape[1] != 2:
        raise unreadable(
            f"The vertices have shape {given.shape}, but (n, 2) is needed; give two coordinates per vertex."
        )
    vertices = converted(given, np.float64, "vertices")
    if not np.isfinite(vertices).all():
        bad = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
        raise InvalidMeshError(
            f"Vertex {bad[0]} has the coordinates {place(vertices[bad[0]])}; give finite numbers, or remove the "
            "vertex.",
            code="mesh.not_finite",
            vertex=bad[0],
        )
    extent = float(np.abs(vertices).max())
    if extent > MAX_COORDINATE:
        far = int(np.abs(vertices).max(axis=1).argmax())
        raise InvalidMeshError(
            f"Vertex {far} at {place(vertices[far])} is farther out than {MAX_COORDINATE:g}, where areas leave the "
            "range of floating-point numbers; scale the shape down.",
            code="mesh.out_of_range",
            vertex=far,
            place=vertices[far],
        )
    size = max(np.ptp(vertices[:, 0]), np.ptp(vertices[:, 1]))
    if len(vertices) > 1 and 0.0 < size < MIN_EXTENT:
        raise InvalidMeshError(
            f"The whole shape around {place(vertices[0])} is smaller than {MIN_EXTENT:g}, where areas leave the "
            "range of floating-point numbers; scale it up.",
            code="mesh.out_of_range",
            place=vertices[0],
        )
    vertices.flags.writeable = False
    return vertices


def as_array(data: Any, what: str) -> AnyArray:
    try:
        return np.asarray(data)
    except Exception as error:
        raise unreadable(
            f"The {what} cannot be read as an array ({error}); give one row of two numbers each."
        ) from error


def converted(given: AnyArray, dtype: type[np.float64], what: str) -> FloatArray:
    """A float64 copy of an array of real numbers."""
    try:
        if given.dtype.kind not in "iufO":
            raise TypeError(f"they are of type {given.dtype}")
        with np.errstate(all="ignore"):
            return np.array(given, dtype=dtype, order="C", subok=False)
    except Exception as error:
        raise unreadable(f"The {what} are not all real numbers ({error}); give numbers only.") from error


def as_rings(loops: Iterable[ArrayLike]) -> tuple[FloatArray, list[int]]:
    """The points of closed loops (k, 2), one after the other, and their numbers; without repeated closing points.

    Raises InvalidMeshError.
    """
    try:
        given = [np.asarray(loop) for loop in loops]
    except Exception as error:
        raise unreadable(
            f"The loops cannot be read as arrays ({error}); give a list of loops, each with rows (x, y)."
        ) from error
    if not given:
        raise InvalidMeshError(
            "The mesh is empty: there are no loops; give at least one loop of three points.", code="mesh.empty"
        )
    rings = []
    for k, points in enumerate(given):
        if points.ndim != 2 or points.shape[1] != 2:
            raise unreadable(
                f"Loop {k} has shape {points.shape}, but (k, 2) is needed; give a list of loops, each with rows (x, y)."
            )
        ring = points[:-1] if len(points) > 1 and bool(np.all(points[0] == points[-1])) else points
        if len(ring) < 3:
            at = f" at {place(as_vertices(ring)[0])}" if len(ring) else ""
            raise InvalidMeshError(
                f"Loop {k}{at} has {len(ring)} of the three vertices that a loop needs; add some, or remove it.",
                code="mesh.open",
            )
        rings.append(ring)
    try:
        together = np.concatenate(rings)
    except TypeError as error:
        kinds = ", ".join(dict.fromkeys(str(ring.dtype) for ring in rings))
        raise unreadable(f"The loops hold different kinds of values ({kinds}); give numbers.") from error
    return as_vertices(together), [len(ring) for ring in rings]


def check_simple(order: Loops) -> None:
    """Check that loops neither cross nor touch each other or themselves. Raises InvalidMeshError with a place."""
    points, vertex, loop, ahead, ends = order.vertices, order.numbers, order.loop, order.ahead, order.ends
    flat = np.flatnonzero((points[:, 0] == ends[:, 0]) & (points[:, 1] == ends[:, 1]))
    if len(flat):
        k = flat[0]
        raise InvalidMeshError(
            f"Vertices {vertex[k]} and {vertex[ahead[k]]} follow each other in loop {loop[k]} and both lie at "
            f"{place(points[k])}; remove one of them.",
            code="mesh.repeated_vertex",
            loops=[loop[k]],
            vertices=[vertex[k], vertex[ahead[k]]],
            place=points[k],
        )
    _check_fold_back(order)
    tree = order.tree
    for i, j in tree.blocks(slim=True):
        apart = (ahead[i] != j) & (ahead[j] != i)
        i, j = i[apart], j[apart]
        hit = segments_intersect(*tree.segments(i), *tree.segments(j))
        if hit.any():
            from .meeting_edges import raise_contact  # for the message

            raise_contact(order, i[hit], j[hit])


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
        raise InvalidMeshError(
            f"Loop {order.loop[k]} turns back over its own edge at vertex {order.numbers[k]}, {place(points[k])}; "
            "move or remove the vertex.",
            code="mesh.spike",
            loops=[order.loop[k]],
            vertices=[order.numbers[k]],
            place=points[k],
        )


def as_edges(data: Any, count: int) -> IntArray:
    """A copy as (m, 2) int64 that joins `count` vertices into closed loops. Raises InvalidMeshError."""
    given = as_array(data, "edges")
    if given.size == 0:
        raise InvalidMeshError("The mesh has no edges; join the vertices into closed loops.", code="mesh.empty")
    if given.ndim != 2 or given.shape[1] != 2:
        raise unreadable(f"The edges have shape {given.shape}, but (m, 2) is needed; give two vertex indices per edge.")
    if given.dtype.kind not in "iu":
        numbers = converted(given, np.float64, "edges")
        bad = np.flatnonzero(~(np.floor(numbers) == numbers).all(axis=1))
        if len(bad):
            raise InvalidMeshError(
                f"Edge {bad[0]} joins {place(numbers[bad[0]])}, but vertex indices are whole numbers; "
                "give an array of integers.",
                code="mesh.edge_index",
                edges=[bad[0]],
            )
        given = numbers
    if given.min() < 0 or given.max() >= count:
        outside = np.flatnonzero(((given < 0) | (given >= count)).any(axis=1))
        i, j = (f"{k:.17g}" if given.dtype.kind == "f" else str(k) for k in given[outside[0]].tolist())
        raise InvalidMeshError(
            f"Edge {outside[0]} joins vertices {i} and {j}, but the {count} vertices are numbered from 0 to "
            f"{count - 1}; correct the index.",
            code="mesh.edge_index",
            edges=[outside[0]],
        )
    edges: IntArray = given.astype(np.int64)
    _check_degrees(edges, count)
    return edges


def _check_degrees(edges: IntArray, count: int) -> None:
    """Raise unless every vertex is the end of exactly two different edges."""
    selfish = np.flatnonzero(edges[:, 0] == edges[:, 1])
    if len(selfish):
        raise InvalidMeshError(
            f"Edge {selfish[0]} joins vertex {edges[selfish[0], 0]} to itself; remove the edge.",
            code="mesh.edge_index",
            edges=[selfish[0]],
        )
    degree = np.bincount(edges.ravel(), minlength=count)
    wrong = np.flatnonzero(degree != 2)
    if len(wrong) or _has_two_gon(edges, count):
        low, high = edges.min(axis=1), edges.max(axis=1)
        order = np.lexsort((high, low))
        same = np.flatnonzero((low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1]))
        if len(same):
            i, j = sorted(order[same[0] : same[0] + 2])
            raise InvalidMeshError(
                f"Edges {i} and {j} both join vertices {low[i]} and {high[i]}; remove one: a loop has each edge once "
                "and at least three vertices.",
                code="mesh.edge_index",
                edges=[i, j],
            )
    if not len(wrong):
        return
    vertex, found = wrong[0], degree[wrong[0]]
    if found == 0:
        raise InvalidMeshError(
            f"Vertex {vertex} belongs to no edge; remove it, or join it into a loop.",
            code="mesh.open",
            vertices=[vertex],
        )
    if found == 1:
        raise InvalidMeshError(
            f"The loop is open at vertex {vertex}, where only one edge ends; close it with an edge.",
            code="mesh.open",
            vertices=[vertex],
        )
    raise InvalidMeshError(
        f"At vertex {vertex} meet {found} edges, but loops pass each vertex once; split the vertex or remove an edge.",
        code="mesh.open",
        vertices=[vertex],
    )


def _has_two_gon(edges: IntArray, count: int) -> bool:
    """Whether two edges join the same two vertices, given that every degree is two."""
    ends = edges.ravel()
    total = np.bincount(ends, weights=ends[np.arange(len(ends)) ^ 1], minlength=count)
    suspects = np.flatnonzero(total[edges[:, 0]] == 2.0 * edges[:, 1])
    if len(suspects) < 2:
        return False
    pairs = np.sort(edges[suspects], axis=1)
    return len(np.unique(pairs, axis=0)) < len(pairs)
