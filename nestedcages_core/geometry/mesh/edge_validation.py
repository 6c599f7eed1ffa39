"""Validation of edges, for meshes that are given by them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...errors import InvalidMeshError
from ..arrays import IntArray
from ..vectors import place
from .validation import as_array, converted


def as_edges(data: Any, count: int) -> IntArray:
    """A copy as (m, 2) int64 that joins `count` vertices into closed loops. Raises InvalidMeshError."""
    given = as_array(data, "edges")
    if given.size == 0:
        raise InvalidMeshError("The mesh has no edges; join the vertices into closed loops.", code="mesh.empty")
    if given.ndim != 2 or given.shape[1] != 2:
        raise InvalidMeshError(
            f"The edges have shape {given.shape}, but (m, 2) is needed; give two vertex indices per edge.",
            code="mesh.unreadable",
        )
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
