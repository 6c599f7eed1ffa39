"""Which coarse loop encloses which fine loop.

Parts are assigned to parts, and the holes of a coarse part to holes of the fine parts in it, by their bounding boxes.
The coarse mesh may have fewer parts (one wraps several fine ones) and fewer holes (a fine hole is covered). A coarse
hole may also lie between fine parts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..errors import FlowError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number
from .base import FlowResult, Obstacle, stuck

DIFFERENCE_WEIGHT = 0.01
"""Weight of the difference of two boxes relative to how far one sticks out of the other: it decides among boxes that
hold one."""


class Matching(NamedTuple):
    """Partners of the loops of two meshes."""

    component: IntArray
    """(fine components,) coarse component around each fine component."""
    partner: IntArray
    """(fine loops,) coarse loop around each fine loop: outer loop for outer loop, hole for hole; -1 for none."""


def match_loops(fine: Mesh, coarse: Mesh) -> Matching:
    """Partners of all fine loops. Raises FlowError where parts of the two meshes do not correspond."""
    fine_outers, coarse_outers = (np.flatnonzero(mesh.loop_signs > 0) for mesh in (fine, coarse))
    fine_boxes, coarse_boxes = _boxes(fine), _boxes(coarse)
    cost = _misfit(fine_boxes[fine_outers], coarse_boxes[coarse_outers])
    if len(fine_outers) < len(coarse_outers):
        extra = coarse_outers[cost.min(axis=0).argmax()]
        cause = f"The coarse mesh has {len(coarse_outers)} parts for {len(fine_outers)} of the fine mesh, of which one"
        raise _mismatch(fine, f"{cause} (loop {extra})", coarse.rings[extra], "remove it")
    component = cost.argmin(axis=1)
    rows, columns = _assignment(cost)
    component[rows] = columns
    inner, around = fine_boxes[fine_outers], coarse_boxes[coarse_outers[component]]
    overlap = (inner[:, :2] < around[:, 2:]) & (around[:, :2] < inner[:, 2:])
    lost = np.flatnonzero(~overlap.all(axis=1))
    if len(lost):
        loop = fine_outers[lost[0]]
        cause = f"No part of the coarse mesh overlaps outer loop {loop} of the fine mesh"
        raise _mismatch(fine, cause, fine.rings[loop], "add a part there or move one over it")

    partner = np.full(len(fine.loops), -1, np.int64)
    partner[fine_outers] = coarse_outers[component]
    for part in np.unique(coarse.component_of_loop[coarse.loop_signs < 0]):
        holes = np.flatnonzero((coarse.loop_signs < 0) & (coarse.component_of_loop == part))
        candidates = np.flatnonzero((fine.loop_signs < 0) & (component[fine.component_of_loop] == part))
        if len(holes) > len(candidates) or np.count_nonzero(component == part) > 1:
            holes = holes[[not _lies_between_parts(fine, coarse.rings[hole]) for hole in holes]]
        if len(holes) > len(candidates):
            cause = f"Loop {holes[-1]} of the coarse mesh is a hole, but the fine mesh has no hole for it"
            raise _mismatch(fine, cause, coarse.rings[holes[-1]], "remove it")
        rows, columns = _assignment(_misfit(fine_boxes[candidates], coarse_boxes[holes]))
        partner[candidates[rows]] = holes[columns]
    return Matching(component, partner)


def _boxes(mesh: Mesh) -> FloatArray:
    """(loops, 4) bounding boxes: least x, least y, greatest x, greatest y."""
    order = mesh.loop_order
    sides = [extreme.reduceat(x, order.begins) for extreme in (np.minimum, np.maximum) for x in order.vertices.T]
    return np.stack(sides, axis=1)


def _misfit(boxes: FloatArray, others: FloatArray) -> FloatArray:
    """(A, B) how far boxes (A, 4) stick out of others (B, 4), and a little of how they differ."""
    cost = np.zeros((len(boxes), len(others)))
    for side, outwards in enumerate((-1.0, -1.0, 1.0, 1.0)):
        out = outwards * (boxes[:, side, None] - others[:, side])
        cost += np.maximum(out, 0.0) + DIFFERENCE_WEIGHT * np.abs(out)
    return cost


def _assignment(cost: FloatArray) -> tuple[IntArray, IntArray]:
    """Rows and columns (C,), (C,) of the matching of least cost (R, C) that gives each column a row of its own."""
    if cost.shape[1] == 0:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    rows, columns = np.unique(cost.argmin(axis=0), return_index=True)
    if len(rows) == cost.shape[1]:  # the usual case, without importing the solver
        return rows, columns
    import scipy

    return scipy.optimize.linear_sum_assignment(cost)  # type: ignore[no-any-return]


def _lies_between_parts(fine: Mesh, hole: FloatArray) -> bool:
    """Whether most vertices and middles of edges of a coarse hole lie outside all outer loops of the fine mesh."""
    points = np.concatenate([hole, 0.5 * (hole + np.roll(hole, -1, axis=0))])
    outer = fine.loop_signs[fine.loop_of_vertex] > 0
    inside = winding_number(points, fine.vertices[outer], fine.edge_ends[outer]) > 0
    return bool(2 * np.count_nonzero(inside) < len(points))


def _mismatch(fine: Mesh, cause: str, ring: FloatArray, remedy: str) -> FlowError:
    obstacle = Obstacle.at(ring.mean(axis=0), cause, remedy, "flow.loops_differ")
    return stuck(FlowResult(fine.vertices[None], 0, "matching", obstacle))
