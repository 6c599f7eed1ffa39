"""Ranges d̂ of the barrier, shorter where walls face each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.broad_phase import near_pairs
from ..geometry.distance import point_edge
from ..geometry.vectors import dot, norm, rotated_right
from .pairs import Bodies, Pairs


@dataclass(frozen=True, eq=False)
class BarrierRanges:
    """Range d̂ of each vertex and edge; lengths."""

    cage_vertex: FloatArray
    """(m,) against the cage itself."""
    cage_edge: FloatArray
    """(m,) by start vertex, against the cage itself."""
    fine_vertex: FloatArray
    """(n,) against cage edges."""
    fine_edge: FloatArray
    """(n,) by start vertex, against cage vertices."""

    @classmethod
    def local(cls, bodies: Bodies, cage: FloatArray, home: FloatArray, base: float) -> BarrierRanges:
        """``base`` (a length), or half the gap between walls that face each other where that is less.

        home, cage: final positions (n, 2) of the fine mesh and positions (m, 2) of the cage, where gaps are measured.
        """
        fine_gap = facing_gaps(home, bodies.fine.successor, bodies.fine.predecessor, 2.0 * base)
        cage_gap = facing_gaps(cage, bodies.cage.successor, bodies.cage.predecessor, 2.0 * base)
        fine = np.minimum(base, 0.5 * fine_gap)
        own = np.minimum(base, 0.5 * cage_gap)  # cage against cage
        return cls(
            own,
            np.minimum(own, own[bodies.cage.successor]),
            fine,
            np.minimum(fine, fine[bodies.fine.successor]),
        )

    def of(self, bodies: Bodies, pairs: Pairs) -> FloatArray:
        """(K,) d̂ of each pair; of a vertex and an edge of the cage, the smaller one."""
        m = bodies.m
        d_hat = np.empty(len(pairs))
        d_hat[pairs.fine_cage] = self.fine_vertex[pairs.point[pairs.fine_cage] - m]
        d_hat[pairs.cage_fine] = self.fine_edge[pairs.start[pairs.cage_fine] - m]
        own = pairs.cage_cage
        d_hat[own] = np.minimum(self.cage_vertex[pairs.point[own]], self.cage_edge[pairs.start[own]])
        return d_hat

    @property
    def largest(self) -> float:
        """Distance beyond which no pair has a barrier."""
        return float(max(self.cage_vertex.max(), self.fine_vertex.max()))


def facing_gaps(vertices: FloatArray, successor: IntArray, predecessor: IntArray, reach: float) -> FloatArray:
    """(k,) distance from each vertex to the nearest edge that faces it across the outside, infinite beyond ``reach``.

    A vertex and an edge face each other if each is on the outer side of the other and their normals are opposed.
    """
    ends = vertices[successor]
    normal = rotated_right(ends - vertices) / np.maximum(norm(ends - vertices), TINY)[:, None]
    vertex_normal = normal + normal[predecessor]
    point, edge = near_pairs(vertices, vertices, ends, reach)
    opposed = (point != edge) & (point != successor[edge]) & (dot(vertex_normal[point], normal[edge]) < 0.0)
    point, edge = point[opposed], edge[opposed]
    pair = point_edge(vertices[point], vertices[edge], ends[edge])
    facing = (dot(pair.normal, normal[edge]) > 0.0) & (dot(pair.normal, vertex_normal[point]) < 0.0)
    gap = np.full(len(vertices), np.inf)
    np.minimum.at(gap, point[facing], pair.distance[facing])
    return gap
