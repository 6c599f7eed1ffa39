"""Whether a mesh comes close to itself."""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..broad_phase import near_pairs
from ..predicates import orientation
from .mesh import Mesh

TOUCHING = 1e-9
"""Distance over the diagonal below which parts touch: less than the coordinates of maps resolve."""

SAMPLE = 64
"""Number of vertices that are looked at first, and by how much the next ones are more."""


def has_gaps(mesh: Mesh, width: float) -> bool:
    """Whether parts of a mesh are that close to each other, apart from short edges and sharp corners, or a hole is as
    narrow. Thin parts are no gaps."""
    lengths = np.array([mesh.edge_lengths[loop].sum() for loop in mesh.loops])
    if (2.0 * np.abs(mesh.loop_areas) < width * lengths)[mesh.loop_signs < 0].any():
        return True
    first, size, order = 0, SAMPLE, np.arange(len(mesh.vertices))
    if len(order) > size:
        order = np.random.default_rng(0).permutation(order)  # crowds show before they make all pairs
    while first < len(order):
        if len(close_vertices(mesh, width, np.sort(order[first : first + size]))):
            return True
        first, size = first + size, SAMPLE * size
    return False


def close_vertices(mesh: Mesh, width: float, chosen: IntArray | None = None) -> IntArray:
    """The vertices, of some or all, across gaps from edges that are that close and not next to them."""
    chosen = np.arange(len(mesh.vertices)) if chosen is None else chosen
    near, edge = near_pairs(mesh.vertices[chosen], mesh.vertices, mesh.edge_ends, width)
    vertex, end, after = chosen[near], mesh.successor[edge], mesh.successor
    apart = (edge != vertex) & (end != vertex) & (edge != after[vertex]) & (after[end] != vertex)
    apart[apart] = orientation(*(mesh.vertices[k[apart]] for k in (edge, end, vertex))) < 0
    return np.asarray(np.unique(vertex[apart]))
