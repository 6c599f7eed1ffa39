"""From edges to lines of points, closed ones and open ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Minimum number of points of a closed loop.
SMALLEST_LOOP = 3
# Points closer to each other than this fraction of the extent are doubles.
DOUBLED = 1e-6


class Chains(NamedTuple):
    """Vertex indices along each connected line of edges: closed ones, open ones, and vertices where more than two edges
    meet.
    """

    closed: list[NDArray[np.int64]]
    opened: list[NDArray[np.int64]]
    branching: NDArray[np.int64]


def chains(edges: NDArray[np.int64], vertex_count: int) -> Chains:
    """Chains of edges (m, 2) between `vertex_count` vertices; no chains if there is a branching vertex."""
    degree = np.bincount(edges.ravel(), minlength=vertex_count)
    branching = np.flatnonzero(degree > 2)
    if len(branching):
        return Chains([], [], branching)
    # Half-edges sorted by their start: those of vertex v are at first[v] and, if there are two, first[v] + 1.
    starts, ends = edges.ravel(), edges[:, ::-1].ravel()
    order = np.argsort(starts, kind="stable")
    neighbours = ends[order].tolist()
    first = np.concatenate([[0], np.cumsum(degree)]).tolist()
    visited = np.zeros(vertex_count, dtype=bool).tolist()

    def follow(start: int) -> NDArray[np.int64]:
        path = [start]
        visited[start] = True
        # Along the first edge in its direction, then on to vertices not visited yet.
        current = start
        while True:
            onward = [v for v in neighbours[first[current] : first[current + 1]] if not visited[v]]
            if not onward:
                return np.array(path, dtype=np.int64)
            current = onward[0]
            visited[current] = True
            path.append(current)

    opened = [follow(int(v)) for v in np.flatnonzero(degree == 1) if not visited[v]]
    closed = [follow(int(v)) for v in np.flatnonzero(degree == 2) if not visited[v]]
    return Chains(closed, opened, branching)


def without_doubles(points: NDArray[np.float32], extent: float) -> NDArray[np.float32]:
    """A closed loop (k, 3) without points closer to the one before than `DOUBLED` of `extent`."""
    gaps = np.linalg.norm(points.astype(float) - np.roll(points, 1, axis=0).astype(float), axis=1)
    kept = gaps > DOUBLED * extent
    return points if kept.all() else points[kept]
