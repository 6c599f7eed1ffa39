"""Which edges of rings leave the solid of a mesh, by exact predicates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import AnyArray, BoolArray, FloatArray, IntArray
from ..broad_phase import BoxTree
from ..loops import Loops
from ..predicates import ON_BOUNDARY, orientation, winding_number
from .mesh import Mesh


def uncovered_edges(mesh: Mesh, rings: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """The edges of rings that leave the closed solid of a mesh; exact. Edges may run along its boundary.

    An edge that crosses no edge of the mesh lies on one side of the boundary between two contacts. The side is decided
    at a contact, where the edge leaves a vertex or an edge of the mesh. Without any contact a ring is inside or outside
    as a whole.

    Parameters
    ----------
    mesh : Mesh
        The solid.
    rings : sequence of (k, 2) array
        Not closed by a repeated first point; they may touch, overlap and cross each other.

    Returns
    -------
    starts, ends : (K, 2) array
        Ends of the edges that are not covered, and of some between these that may be.
    """
    order = Loops.of(np.concatenate(rings), [len(ring) for ring in rings])
    starts, ends = order.vertices, order.ends
    shared = np.isin(edge_keys(starts, ends), edge_keys(mesh.vertices, mesh.edge_ends))
    outside, touched = np.zeros(len(starts), bool), shared.copy()
    edges = np.flatnonzero(~shared & (starts != ends).any(axis=1))
    tree, other = BoxTree(starts[edges], ends[edges]), BoxTree(mesh.vertices, mesh.edge_ends)
    for i, vertex in tree.blocks(other) if len(edges) else ():
        (a, b), (p, q) = tree.segments(i), other.segments(vertex)
        edge = edges[i]
        from_edge = [orientation(p, q, end) for end in (a, b)]
        meets = orientation(a, b, p)
        crosses = (meets * orientation(a, b, q) < 0) & (from_edge[0] * from_edge[1] < 0)
        at_vertex = (meets == 0) & _in_box(p, a, b)
        outside[edge[crosses]] = True
        touched[edge[at_vertex]] = True
        for here, there, side in ((a, b, from_edge), (b, a, from_edge[::-1])):
            leaves = at_vertex & (p != there).any(axis=1)
            away = ~_is_inwards(mesh, vertex[leaves], there[leaves])
            outside[edge[leaves][away]] = True
            on_edge = (side[0] == 0) & _in_box(here, p, q) & (here != p).any(axis=1) & (here != q).any(axis=1)
            touched[edge[on_edge]] = True
            outside[edge[on_edge & (side[1] < 0)]] = True
    has_contact = np.bincount(order.loop, touched, len(order.sizes)) > 0
    apart = np.flatnonzero(~has_contact)
    winding = winding_number(starts[order.begins[apart]], mesh.vertices, mesh.edge_ends)
    outside |= np.isin(order.loop, apart[(winding != 1) & (winding != ON_BOUNDARY)])
    for ring in np.unique(order.loop[outside]):  # edges without contact are where the last edge before them ends
        own = np.arange(order.sizes[ring]) + order.begins[ring]
        last = np.maximum.accumulate(np.where(touched[own], own, -1))
        outside[own] |= ~touched[own] & outside[np.where(last < 0, last[-1], last)]
    _, first = np.unique(edge_keys(starts[outside], ends[outside]), return_index=True)
    return starts[outside][first], ends[outside][first]


def _is_inwards(mesh: Mesh, vertex: IntArray, towards: FloatArray) -> BoolArray:
    """(K,) whether a ray from a vertex towards a point (K, 2) begins inside or along an edge."""
    here, after, before = (mesh.vertices[k] for k in (vertex, mesh.successor[vertex], mesh.predecessor[vertex]))
    left_of_next, left_of_last = orientation(here, after, towards), orientation(before, here, towards)
    turn = orientation(before, here, after)
    inside = np.where(turn > 0, np.minimum(left_of_next, left_of_last), left_of_next) > 0
    inside |= (turn < 0) & (left_of_last > 0)
    for other, side in ((after, left_of_next), (before, left_of_last)):
        inside |= (side == 0) & (np.sign(other - here) == np.sign(towards - here)).all(axis=1)
    return inside


def _in_box(points: FloatArray, a: FloatArray, b: FloatArray) -> BoolArray:
    """(K,) whether points lie in the boxes of segments, which for points on their lines means on the segments."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    return np.asarray(((low <= points) & (points <= high)).all(axis=1))


def edge_keys(starts: FloatArray, ends: FloatArray) -> AnyArray:
    """(E,) a value for each edge that is the same for equal edges, whatever their direction."""
    turned = (starts[:, 0] > ends[:, 0]) | ((starts[:, 0] == ends[:, 0]) & (starts[:, 1] > ends[:, 1]))
    both = np.where(turned[:, None], np.hstack((ends, starts)), np.hstack((starts, ends))) + 0.0
    return both.view(np.dtype((np.void, 32))).ravel()
