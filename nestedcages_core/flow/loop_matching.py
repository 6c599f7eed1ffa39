"""Which coarse loop encloses which fine loop.

Fine components are assigned to coarse components, then coarse holes to fine holes inside them. The coarse mesh may have
fewer components (one wraps several fine ones) and fewer holes (a fine hole is covered). A coarse hole may also lie
outside the fine solid.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..errors import FlowError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.mesh import Mesh
from ..geometry.predicates import loop_windings
from ..geometry.signed_distance import SignedDistance
from .base import FlowResult, Obstacle, stuck

PROBES = 64
"""Number of vertices per fine component that decide its coarse component, if one wraps several."""

ALL_BOXES_LIMIT = 64
"""Number of loops up to which all pairs of bounding boxes are compared."""


class Matching(NamedTuple):
    """Partners of the loops of two meshes."""

    fine: Mesh
    coarse: Mesh
    component: IntArray
    """(fine components,) coarse component around each fine component."""
    partner: IntArray
    """(fine loops,) coarse loop around each fine loop: outer loop for outer loop, hole for hole; -1 for none."""


def match_loops(fine: Mesh, coarse: Mesh) -> Matching:
    """Partners of all fine loops.

    Raises: FlowError if a coarse component has no fine component, or a coarse hole no fine hole.
    """
    component = _match_components(fine, coarse)
    partner = np.full(len(fine.loops), -1, np.int64)
    fine_outers, coarse_outers = outer_loops(fine), outer_loops(coarse)
    partner[fine_outers] = coarse_outers[component]
    for k in range(len(coarse_outers)):
        _match_holes(fine, coarse, component, k, partner)
    return Matching(fine, coarse, component, partner)


def outer_loops(mesh: Mesh) -> IntArray:
    """(components,) the outer loop of each component."""
    return np.nonzero(mesh.loop_signs > 0)[0]


def boxes(mesh: Mesh) -> FloatArray:
    """(loops, 4) bounding boxes: min x, min y, max x, max y."""
    order = mesh.loop_order
    x, y = order.vertices.T
    sides = [np.minimum.reduceat(x, order.begins), np.minimum.reduceat(y, order.begins)]
    sides += [np.maximum.reduceat(x, order.begins), np.maximum.reduceat(y, order.begins)]
    return np.stack(sides, axis=1)


def loop_tree(mesh: Mesh, vertices: FloatArray) -> tuple[BoxTree, IntArray]:
    """Tree over the edges, loop by loop, of the mesh with vertices (n, 2), and the (n,) start vertex of each."""
    order = mesh.loop_order.numbers
    return BoxTree(vertices.take(order, axis=0), vertices.take(mesh.successor.take(order), axis=0)), order


def windings(points: FloatArray, mesh: Mesh, vertices: FloatArray) -> IntArray:
    """(P, loops) exact winding of each loop of the mesh with vertices (n, 2) around points that lie on none of them."""
    result = np.zeros((len(points), len(mesh.loops)), np.int64)
    point, loop, winding = loop_windings(points, vertices, vertices.take(mesh.successor, axis=0), mesh.loop_of_vertex)
    result[point, loop] = winding
    return result


def _match_components(fine: Mesh, coarse: Mesh) -> IntArray:
    fine_outers, coarse_outers = outer_loops(fine), outer_loops(coarse)
    if len(fine_outers) < len(coarse_outers):
        difference = _box_difference(boxes(fine)[fine_outers], boxes(coarse)[coarse_outers]).min(axis=0)
        extra = coarse_outers[difference.argmax()]
        x, y = coarse.vertices[coarse.loops[extra]].mean(axis=0).tolist()
        cause = (
            f"The coarse mesh has {len(coarse_outers)} separate parts for {len(fine_outers)} of the fine mesh,"
            f" one of them (loop {extra})"
        )
        raise _mismatch(fine, cause, (x, y), "remove it, or move it inside if it is meant as a hole")
    fine_boxes, coarse_boxes = boxes(fine)[fine_outers], boxes(coarse)[coarse_outers]
    if len(fine_outers) == len(coarse_outers) == 1:
        component = np.zeros(1, np.int64)
        overlaps = _boxes_overlap(fine_boxes, coarse_boxes)
    elif len(fine_outers) == len(coarse_outers):
        _, component = _closest(fine_boxes, coarse_boxes, _hole_counts(fine), _hole_counts(coarse))
        overlaps = _boxes_overlap(fine_boxes, coarse_boxes[component])
    else:
        outside, overlapping = _fit(fine, coarse)
        component = np.where(overlapping, outside, np.inf).argmin(axis=1)
        overlaps = np.asarray(overlapping.any(axis=1))
    lost = np.nonzero(~overlaps)[0]
    if len(lost):
        x, y = fine.vertices[fine.loops[fine_outers[lost[0]]]].mean(axis=0).tolist()
        cause = f"No part of the coarse mesh overlaps outer loop {fine_outers[lost[0]]} of the fine mesh"
        raise _mismatch(fine, cause, (x, y), "add a part there or move one over it")
    empty = np.setdiff1d(np.arange(len(coarse_outers)), component)
    if len(empty):
        x, y = coarse.vertices[coarse.loops[coarse_outers[empty[0]]]].mean(axis=0).tolist()
        cause = f"Outer loop {coarse_outers[empty[0]]} of the coarse mesh holds no part of the fine mesh"
        raise _mismatch(fine, cause, (x, y), "remove it or move it over the part it belongs to")
    return np.asarray(component, np.int64)


def _match_holes(fine: Mesh, coarse: Mesh, component: IntArray, k: int, partner: IntArray) -> None:
    """Assign each hole of coarse component k to a fine hole, unless it lies outside the fine solid."""
    holes = np.nonzero((coarse.loop_signs < 0) & (coarse.component_of_loop == k))[0]
    if len(holes) == 0:
        return
    candidates = np.nonzero((fine.loop_signs < 0) & (component[fine.component_of_loop] == k))[0]
    if len(holes) > len(candidates) or np.count_nonzero(component == k) > 1:
        holes = holes[[not _is_free(fine, coarse, hole) for hole in holes.tolist()]]
    if len(holes) > len(candidates):
        x, y = coarse.vertices[coarse.loops[holes[-1]]].mean(axis=0).tolist()
        cause = f"Loop {holes[-1]} of the coarse mesh is a hole, but the fine mesh has no hole for it"
        raise _mismatch(fine, cause, (x, y), "remove it")
    if len(holes) == 0:
        return
    if len(holes) == len(candidates) == 1:
        partner[candidates] = holes
        return
    rows, columns = _closest(boxes(fine)[candidates], boxes(coarse)[holes])
    partner[candidates[rows]] = holes[columns]


def _closest(
    a: FloatArray, b: FloatArray, holes: IntArray | None = None, wanted: IntArray | None = None
) -> tuple[IntArray, IntArray]:
    """Rows and columns (B,), (B,) that give each bounding box (B, 4) one of the (A, 4), all together the closest.

    As few as possible get one with fewer holes, (A,), than wanted, (B,).
    """
    if len(b) > ALL_BOXES_LIMIT and (wanted is None or not wanted.any()):
        import scipy

        distance, row = scipy.spatial.cKDTree(a).query(b, k=2, p=1.0)
        rows, columns = np.unique(row[:, 0], return_index=True)
        if len(rows) == len(b) and (distance[:, 0] < distance[:, 1]).all():
            return rows, columns
    cost = _box_difference(a, b)
    return _assignment(cost if holes is None or wanted is None else cost + cost.sum() * (holes[:, None] < wanted))


def _assignment(cost: FloatArray) -> tuple[IntArray, IntArray]:
    """Rows and columns (C,), (C,) of the matching of least cost (R, C) that gives each column a row of its own."""
    rows, columns = np.unique(cost.argmin(axis=0), return_index=True)
    tied = np.count_nonzero(cost == cost.min(axis=0)) > cost.shape[1]
    if len(rows) == cost.shape[1] and not tied:  # the usual case, without importing the solver
        return rows, columns
    import scipy

    return scipy.optimize.linear_sum_assignment(cost)  # type: ignore[no-any-return]


def _is_free(fine: Mesh, coarse: Mesh, hole: int) -> bool:
    """Whether most of the boundary of a coarse hole lies outside all fine loops."""
    loop = coarse.loops[hole]
    points = np.concatenate(
        [coarse.vertices[loop], 0.5 * (coarse.vertices[loop] + coarse.vertices[coarse.successor[loop]])]
    )
    distance = np.abs(SignedDistance.of(fine).at(points).distance)
    within = windings(points, fine, fine.vertices).any(axis=1)
    return bool(distance[~within].sum() > distance[within].sum())


def _mismatch(fine: Mesh, cause: str, place: tuple[float, float] | None, remedy: str) -> FlowError:
    return stuck(FlowResult(fine.vertices[None], 0, "matching", Obstacle(cause, place, remedy, "flow.loops_differ")))


def _hole_counts(mesh: Mesh) -> IntArray:
    """(components,) number of holes."""
    return np.bincount(mesh.component_of_loop[mesh.loop_signs < 0], minlength=len(outer_loops(mesh)))


def _boxes_overlap(a: FloatArray, b: FloatArray) -> BoolArray:
    """(K,) whether pairs of bounding boxes overlap."""
    return np.asarray(((a[:, :2] < b[:, 2:]) & (b[:, :2] < a[:, 2:])).all(axis=1), np.bool_)


def _box_difference(a: FloatArray, b: FloatArray) -> FloatArray:
    """(A, B) sum of the differences of the four sides of bounding boxes."""
    return np.asarray(np.abs(a[:, None] - b[None, :]).sum(axis=2), np.float64)


def _fit(fine: Mesh, coarse: Mesh) -> tuple[FloatArray, BoolArray]:
    """(fine, coarse components) mean distance of one outside the other, and whether they overlap."""
    fine_outers, coarse_outers = outer_loops(fine), outer_loops(coarse)
    probes = [fine.vertices[fine.loops[k][:: max(1, len(fine.loops[k]) // PROBES)]] for k in fine_outers]
    first = np.cumsum([0, *(len(points) for points in probes[:-1])])
    points = np.concatenate(probes)
    outside = np.empty((len(fine_outers), len(coarse_outers)))
    overlaps = np.empty(outside.shape, bool)
    for k, outer in enumerate(coarse_outers):
        starts = np.concatenate([coarse.loops[loop] for loop in np.nonzero(coarse.component_of_loop == k)[0]])
        distance = (
            SignedDistance(coarse.vertices[starts], coarse.vertices[coarse.successor[starts]]).at(points).distance
        )
        outside[:, k] = np.add.reduceat(np.maximum(distance, 0.0), first) / [len(points) for points in probes]
        around = windings(coarse.vertices[coarse.loops[outer]], fine, fine.vertices)[:, fine_outers].any(axis=0)
        overlaps[:, k] = (np.minimum.reduceat(distance, first) < 0.0) | around
    return outside, overlaps
