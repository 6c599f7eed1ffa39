"""Gaps between walls that face each other."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.broad_phase import near_pairs
from ..geometry.distance import point_edge
from ..geometry.vectors import dot, norm, rotated_right

BLOCK = 2048
"""Vertices searched for together; bounds the memory."""


def facing_gaps(vertices: FloatArray, successor: IntArray, predecessor: IntArray, reach: float) -> FloatArray:
    """(k,) distance from each vertex to the nearest edge that faces it across the outside, infinite beyond ``reach``.

    A vertex and an edge face each other if each is on the outer side of the other and their normals are opposed.
    """
    ends = vertices[successor]
    normal = rotated_right(ends - vertices) / np.maximum(norm(ends - vertices), TINY)[:, None]
    vertex_normal = normal + normal[predecessor]
    gap = np.full(len(vertices), np.inf)
    for first in range(0, len(vertices), BLOCK):
        point, edge = near_pairs(vertices[first : first + BLOCK], vertices, ends, reach)
        point += first
        opposed = (point != edge) & (point != successor[edge]) & (dot(vertex_normal[point], normal[edge]) < 0.0)
        point, edge = point[opposed], edge[opposed]
        pair = point_edge(vertices[point], vertices[edge], ends[edge])
        facing = (dot(pair.normal, normal[edge]) > 0.0) & (dot(pair.normal, vertex_normal[point]) < 0.0)
        np.minimum.at(gap, point[facing], pair.distance[facing])
    return gap
