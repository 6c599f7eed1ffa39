"""Which coarse loop encloses which fine loop.

Fine components are given to coarse components, and coarse holes to fine holes inside those. The coarse mesh may have
fewer components (one wraps several fine ones) and fewer holes (a fine hole is covered); a coarse hole may also lie
free, where no fine solid is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from .._types import FloatArray, IntArray
from ..errors import FlowError
from ..mesh import Mesh
from ..predicates import BoxTree, orientation, ray_crossings
from ..signed_distance import SignedDistance
from .base import Obstacle, stuck

COVERED = -1
"""Partner of a fine hole that no coarse hole keeps open."""

PROBES = 64
"""Vertices per component that decide where it belongs when there are more fine components than coarse ones."""

ALL_PAIRS_LIMIT = 100_000
"""Number of pairs of points and edges up to which winding numbers look at all of them."""

IMPOSSIBLE = 1e3
"""Cost of a component with fewer holes than its coarse component, in bounding-box diagonals: above any distance."""


@dataclass(frozen=True, eq=False)
class Matching:
    """Partners of the loops of two meshes."""

    fine: Mesh
    coarse: Mesh
    component: IntArray
    """(fine components,) coarse component around each fine component."""
    partner: IntArray
    """(fine loops,) coarse loop around each fine loop: outer loop for outer loop, hole for hole, or COVERED."""

    def fine_loops_in(self, coarse_component: int) -> IntArray:
        """Fine loops that belong inside a coarse component."""
        return np.nonzero(self.component[self.fine.component_of_loop] == coarse_component)[0]

    def coarse_loops_of(self, coarse_component: int) -> IntArray:
        """Loops that bound a coarse component."""
        return np.nonzero(self.coarse.component_of_loop == coarse_component)[0]


def match_loops(fine: Mesh, coarse: Mesh) -> Matching:
    """Partners of all fine loops.

    Raises: FlowError if a coarse component has no fine component to hold, or a coarse hole no fine hole to keep open.
    """
    component = _match_components(fine, coarse)
    partner = np.full(len(fine.loops), COVERED, np.int64)
    fine_outers, coarse_outers = outer_loops(fine), outer_loops(coarse)
    partner[fine_outers] = coarse_outers[component]
    for k in range(len(coarse_outers)):
        _match_holes(fine, coarse, component, k, partner)
    return Matching(fine, coarse, component, partner)


def outer_loops(mesh: Mesh) -> IntArray:
    """(components,) the outer loop of each component."""
    return np.nonzero(mesh.loop_signs > 0)[0]


def boxes(mesh: Mesh) -> FloatArray:
    """(loops, 4) bounding boxes: least x, least y, greatest x, greatest y."""
    return np.array([[*mesh.vertices[loop].min(axis=0), *mesh.vertices[loop].max(axis=0)] for loop in mesh.loops])


def loop_tree(mesh: Mesh, vertices: FloatArray) -> tuple[BoxTree, IntArray]:
    """Tree over the edges, loop by loop, of the mesh with vertices (n, 2), and the (n,) start vertex of each."""
    order = np.concatenate(mesh.loops)
    return BoxTree(vertices[order], vertices[mesh.successor[order]]), order


def windings(points: FloatArray, mesh: Mesh, vertices: FloatArray) -> IntArray:
    """(P, loops) exact winding of each loop of the mesh with vertices (n, 2) around points that lie on none of them."""
    result = np.zeros((len(points), len(mesh.loops)), np.int64)
    if len(points) * len(vertices) <= ALL_PAIRS_LIMIT:
        height = vertices[:, 1]
        above = height > points[:, 1:]
        point, start = np.nonzero(above != above[:, mesh.successor])
        side = orientation(vertices[start], vertices[mesh.successor[start]], points[point])
        rises = np.where(above[point, start], -1, 1)
        np.add.at(result, (point, mesh.loop_of_vertex[start]), np.where(side == rises, rises, 0))
        return result
    tree, order = loop_tree(mesh, vertices)
    crossings = ray_crossings(points, tree)
    loop_of_chain = mesh.loop_of_vertex[order[tree.order[tree.chain_starts[:-1]]]]
    np.add.at(result, (crossings.point, loop_of_chain[crossings.chain]), crossings.value)
    return result


def _match_components(fine: Mesh, coarse: Mesh) -> IntArray:
    fine_outers, coarse_outers = outer_loops(fine), outer_loops(coarse)
    if len(coarse_outers) == 1:
        return np.zeros(len(fine_outers), np.int64)
    if len(fine_outers) < len(coarse_outers):
        cause = f"The coarse mesh has {len(coarse_outers)} separate parts and the fine mesh only {len(fine_outers)}"
        raise _mismatch(fine, cause, None, "remove the parts that hold nothing, or move holes back inside")
    if len(fine_outers) == len(coarse_outers):
        fewer = _hole_counts(fine)[:, None] < _hole_counts(coarse)[None, :]
        cost = _box_difference(boxes(fine)[fine_outers], boxes(coarse)[coarse_outers]) / fine.diagonal
        rows, columns = linear_sum_assignment(cost + IMPOSSIBLE * fewer)
        return np.asarray(columns[np.argsort(rows)], np.int64)
    component = _outside(fine, coarse).argmin(axis=1)
    empty = np.setdiff1d(np.arange(len(coarse_outers)), component)
    if len(empty):
        loop = coarse.loops[coarse_outers[empty[0]]]
        x, y = coarse.vertices[loop].mean(axis=0).tolist()
        cause = f"Coarse loop {coarse_outers[empty[0]]} holds no part of the fine mesh"
        raise _mismatch(fine, cause, (x, y), "remove it or move it over the part it belongs to")
    return np.asarray(component, np.int64)


def _match_holes(fine: Mesh, coarse: Mesh, component: IntArray, k: int, partner: IntArray) -> None:
    """Give each hole of coarse component k a fine hole of its own, or leave it where no fine solid is."""
    holes = np.nonzero((coarse.loop_signs < 0) & (coarse.component_of_loop == k))[0]
    if len(holes) == 0:
        return
    candidates = np.nonzero((fine.loop_signs < 0) & (component[fine.component_of_loop] == k))[0]
    if len(holes) > len(candidates) or np.count_nonzero(component == k) > 1:
        free = [not windings(coarse.vertices[coarse.loops[hole]], fine, fine.vertices).any() for hole in holes]
        holes = holes[~np.array(free)]
    if len(holes) > len(candidates):
        x, y = coarse.vertices[coarse.loops[holes[-1]]].mean(axis=0).tolist()
        cause = f"The coarse mesh has {len(holes)} holes for {len(candidates)} of the fine mesh, one (loop {holes[-1]})"
        raise _mismatch(fine, cause, (x, y), "remove the holes that would cut into the fine mesh")
    rows, columns = linear_sum_assignment(_box_difference(boxes(fine)[candidates], boxes(coarse)[holes]))
    partner[candidates[rows]] = holes[columns]


def _mismatch(fine: Mesh, cause: str, place: tuple[float, float] | None, remedy: str) -> FlowError:
    return stuck(Obstacle(cause, place, remedy), [fine.vertices], 0, "matching")


def _hole_counts(mesh: Mesh) -> IntArray:
    """(components,) number of holes."""
    return np.bincount(mesh.component_of_loop[mesh.loop_signs < 0], minlength=len(outer_loops(mesh)))


def _box_difference(a: FloatArray, b: FloatArray) -> FloatArray:
    """(A, B) sum of the differences of the four sides of bounding boxes."""
    return np.asarray(np.abs(a[:, None] - b[None, :]).sum(axis=2), np.float64)


def _outside(fine: Mesh, coarse: Mesh) -> FloatArray:
    """(fine, coarse components) how far the outer loop of one lies outside the solid of the other, on average."""
    fine_outers, coarse_outers = outer_loops(fine), outer_loops(coarse)
    probes = [fine.vertices[loop[:: max(1, len(loop) // PROBES)]] for loop in (fine.loops[k] for k in fine_outers)]
    owner = np.repeat(np.arange(len(fine_outers)), [len(p) for p in probes])
    points = np.concatenate(probes)
    result = np.empty((len(fine_outers), len(coarse_outers)))
    for k in range(len(coarse_outers)):
        bounding = np.nonzero(coarse.component_of_loop == k)[0]
        starts = np.concatenate([coarse.loops[loop] for loop in bounding])
        field = SignedDistance(coarse.vertices[starts], coarse.vertices[coarse.successor[starts]])
        depth = np.maximum(field.at(points).distance, 0.0)
        result[:, k] = np.bincount(owner, depth) / np.bincount(owner)
    return result
