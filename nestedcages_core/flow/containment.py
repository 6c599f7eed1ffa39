"""The certificate of the flow: the moved fine mesh is strictly inside the coarse one.

The fine mesh may cross itself as it moves, so "inside" is defined by winding numbers. Motion without contact preserves
them, and with them the original fine mesh lies strictly inside the coarse mesh, component by component.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import crossing_pairs, loop_windings, winding_number
from .base import Obstacle


def obstacle(fine: Mesh, coarse: Mesh, vertices: FloatArray) -> Obstacle | None:
    """None if the fine mesh with vertices (n, 2) is strictly inside the coarse one, else the first obstacle; exact."""
    moved = fine.moved(vertices)
    i, j = crossing_pairs(moved.edge_tree, coarse.edge_tree)
    if len(i):
        vertex, edge = moved.loop_order.numbers[i[0]], coarse.loop_order.numbers[j[0]]
        cause = (
            f"Fine loop {fine.loop_of_vertex[vertex]} still crosses coarse loop {coarse.loop_of_vertex[edge]}"
            f" ({len(i)} crossing edges), at fine vertex {vertex}"
        )
        return Obstacle.at(vertices[vertex], cause)
    first, coarse_first = (np.array([loop[0] for loop in mesh.loops]) for mesh in (fine, coarse))
    outside = (winding_number(vertices[first], coarse.vertices, coarse.edge_ends) != 1).nonzero()[0]
    if len(outside):
        return Obstacle.at(
            vertices[first[outside[0]]], f"Loop {outside[0]} of the fine mesh lies outside the coarse one"
        )
    part_of_vertex = fine.component_of_loop[fine.loop_of_vertex]
    within, _, _ = loop_windings(coarse.vertices[coarse_first], vertices, moved.edge_ends, part_of_vertex)
    if len(within):
        cause = f"Loop {within[0]} of the coarse mesh lies inside the fine one"
        return Obstacle.at(coarse.vertices[coarse_first[within[0]]], cause)
    return None
