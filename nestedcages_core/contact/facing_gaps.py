"""Gaps between walls that face each other, by descending a tree over the edges.

A node of the tree covers consecutive edges by a ball and by a range of directions of their normals. Next to a vertex of
a smooth boundary all normals point the same way, so few nodes are opened however many edges are near.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.broad_phase import near_pairs
from ..geometry.distance import point_edge
from ..geometry.predicates.box_tree import FANOUT, children
from ..geometry.vectors import dot, norm, rotated_right

FEW_VERTICES = 500
"""Number of vertices up to which all pairs within reach are measured (measured)."""

FIRST_RADIUS, RADIUS_GROWTH = 4.0, 4.0
"""First radius of the search, in mean edge lengths, and its growth for vertices that face nothing within it."""

BLOCK = 4096
"""Vertices searched for together; bounds the memory."""

ANGLE_ROUNDING = 1e-9
"""Bound on the rounding error of a sum of angles, in radians."""


def facing_gaps(vertices: FloatArray, successor: IntArray, predecessor: IntArray, reach: float) -> FloatArray:
    """(k,) distance from each vertex to the nearest edge that faces it across the outside, infinite beyond ``reach``.

    A vertex and an edge face each other if each is on the outer side of the other and their normals are opposed.
    """
    walls = _Walls(vertices, successor, predecessor)
    if len(vertices) <= FEW_VERTICES:
        return walls.gaps(*near_pairs(vertices, vertices, walls.ends, reach), reach)
    levels = _levels(walls)
    gap = np.full(len(vertices), np.inf)
    left = np.arange(len(vertices))
    radius = FIRST_RADIUS * float(norm(walls.ends - vertices).mean())
    while len(left):
        radius = min(radius, reach)
        for first in range(0, len(left), BLOCK):
            pairs = _candidates(walls, levels, left[first : first + BLOCK], radius)
            gap = np.minimum(gap, walls.gaps(*pairs, radius))
        if radius == reach:
            break
        left = left[np.isinf(gap[left])]
        radius *= RADIUS_GROWTH
    return gap


class _Walls:
    """The edges of closed loops, by start vertex, and the outward normals of edges and vertices."""

    def __init__(self, vertices: FloatArray, successor: IntArray, predecessor: IntArray) -> None:
        self.vertices, self.successor = vertices, successor
        self.ends = vertices[successor]
        edge = self.ends - vertices
        self.normal = rotated_right(edge) / np.maximum(norm(edge), TINY)[:, None]
        self.vertex_normal = self.normal + self.normal[predecessor]

    def gaps(self, point: IntArray, edge: IntArray, radius: float) -> FloatArray:
        """(k,) least distance below a radius of each vertex among those pairs (point, edge) that face each other."""
        foreign = (point != edge) & (point != self.successor[edge])
        point, edge = point[foreign], edge[foreign]
        pair = point_edge(self.vertices[point], self.vertices[edge], self.ends[edge])
        normal, vertex_normal = self.normal[edge], self.vertex_normal[point]
        facing = dot(pair.normal, normal) > 0.0
        facing &= dot(pair.normal, vertex_normal) < 0.0
        facing &= dot(vertex_normal, normal) < 0.0
        facing &= pair.distance < radius
        gap = np.full(len(self.vertices), np.inf)
        np.minimum.at(gap, point[facing], pair.distance[facing])
        return gap


class _Level(NamedTuple):
    """Nodes of one level of the tree."""

    centre: FloatArray
    """(N, 2) of the balls around their edges."""
    radius: FloatArray
    """(N,)."""
    direction: FloatArray
    """(N,) middle of the directions of their normals, an angle."""
    spread: FloatArray
    """(N,) largest difference from it."""


def _levels(walls: _Walls) -> list[_Level]:
    """The tree: single edges first, then FANOUT consecutive ones, and so on."""
    middle = 0.5 * (walls.vertices + walls.ends)
    none = np.zeros(len(middle))
    levels = [_Level(middle, 0.5 * norm(walls.ends - walls.vertices), _angle(walls.normal), none)]
    while len(levels[-1].radius) > FANOUT:
        below = levels[-1]
        begins = np.arange(0, len(below.radius), FANOUT)
        owner = np.arange(len(below.radius)) // FANOUT
        centre = np.add.reduceat(below.centre, begins) / np.bincount(owner)[:, None]
        radius = np.maximum.reduceat(norm(below.centre - centre[owner]) + below.radius, begins)
        unit = np.stack([np.cos(below.direction), np.sin(below.direction)], axis=1)
        direction = _angle(np.add.reduceat(unit, begins))
        spread = np.maximum.reduceat(_between(below.direction, direction[owner]) + below.spread, begins)
        levels.append(_Level(centre, radius, direction, spread))
    return levels


def _candidates(walls: _Walls, levels: list[_Level], points: IntArray, radius: float) -> tuple[IntArray, IntArray]:
    """A superset (point, edge) of the pairs of some vertices with facing edges closer than a radius."""
    top = len(levels[-1].radius)
    point, node = np.repeat(points, top), np.tile(np.arange(top), len(points))
    facing = _angle(walls.vertex_normal)
    for level in reversed(levels):
        if level is not levels[-1]:
            point, node = np.repeat(point, FANOUT), children(node)
            exist = node < len(level.radius)
            point, node = point[exist], node[exist]
        offset = walls.vertices[point] - level.centre[node]
        distance, size = norm(offset), level.radius[node]
        kept = np.flatnonzero(distance - size <= radius * (1.0 + ANGLE_ROUNDING))
        point, node, offset = point[kept], node[kept], offset[kept]
        # the direction from the edges to the vertex, the normals of the edges and of the vertex, and their ranges
        away, away_spread = _angle(offset), _half_angle(size[kept], distance[kept]) + ANGLE_ROUNDING
        normal, normal_spread, own = level.direction[node], level.spread[node], facing[point]
        open_ = _between(own, normal) + normal_spread > 0.5 * np.pi - ANGLE_ROUNDING
        open_ &= _between(away, normal) - normal_spread - away_spread < 0.5 * np.pi
        open_ &= _between(away, own) + away_spread > 0.5 * np.pi
        point, node = point[open_], node[open_]
    return point, node


def _half_angle(size: FloatArray, distance: FloatArray) -> FloatArray:
    """Half of the angle at which balls of some sizes are seen from a distance; π from inside."""
    return np.where(size < distance, np.arcsin(np.minimum(size / np.maximum(distance, TINY), 1.0)), np.pi)


def _angle(vectors: FloatArray) -> FloatArray:
    """(K,) directions of vectors (K, 2)."""
    angle: FloatArray = np.arctan2(vectors[:, 1], vectors[:, 0])
    return angle


def _between(one: FloatArray, other: FloatArray) -> FloatArray:
    """Angles between two directions each, from 0 to π."""
    return np.asarray(np.pi - np.abs(np.pi - np.abs(one - other)))
