"""Matching of the loops of a level set with those of the mesh, and removal of extra loops."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.predicates import winding_number


def without_pockets(contour: Mesh, fine: Mesh) -> Mesh:
    """A level set without the holes that the fine mesh does not have: closed bays, and parts of split holes.

    The largest part of each hole stays, and so does a hole that contains another component.
    """
    holes = np.flatnonzero(contour.loop_signs < 0)
    within = _smallest_around(fine, -1, contour, holes)
    outer = contour.vertices[[contour.loops[k][0] for k in np.flatnonzero(contour.loop_signs > 0)]]
    largest: dict[int, int] = {}
    for i in np.argsort(contour.loop_areas[holes]):  # the areas of holes are negative
        if within[i] >= 0:
            largest.setdefault(int(within[i]), int(holes[i]))
    kept = [
        loop
        for k, loop in enumerate(contour.loops)
        if contour.loop_signs[k] > 0 or k in largest.values() or _winding(outer, contour, k).any()
    ]
    return contour if len(kept) == len(contour.loops) else Mesh.from_loops([contour.vertices[loop] for loop in kept])


def loops_around(contour: Mesh, fine: Mesh) -> IntArray | None:
    """(L,) the loop of a level set for each loop of the fine mesh; None if they do not match one to one.

    The smallest outer loop around each outer loop, and the hole inside each hole.
    """
    if not np.array_equal(np.bincount(contour.loop_signs + 1), np.bincount(fine.loop_signs + 1)):
        return None
    partner = np.full(len(fine.loops), -1, dtype=np.int64)
    outer, holes = (np.flatnonzero(mesh.loop_signs == sign) for mesh, sign in ((fine, 1), (contour, -1)))
    around_outer, around_holes = _smallest_around(contour, 1, fine, outer), _smallest_around(fine, -1, contour, holes)
    for around in (around_outer, around_holes):
        if (around < 0).any() or len(np.unique(around)) < len(around):
            return None
    partner[outer] = around_outer
    partner[around_holes] = holes
    return partner


def _smallest_around(larger: Mesh, sign: int, smaller: Mesh, loops: IntArray) -> IntArray:
    """(K,) the smallest loop of a given sign in one mesh around each of some loops of another; -1 if there is none."""
    points = smaller.vertices[[smaller.loops[k][0] for k in loops]].reshape(-1, 2)
    best, least = np.full(len(points), -1), np.full(len(points), np.inf)
    for k in np.flatnonzero(larger.loop_signs == sign).tolist():
        area = abs(float(larger.loop_areas[k]))
        chosen = (_winding(points, larger, k) == sign) & (area < least)
        best[chosen], least[chosen] = k, area
    return best


def _winding(points: FloatArray, mesh: Mesh, k: int) -> IntArray:
    """(P,) winding number of one loop of a mesh."""
    loop = mesh.loops[k]
    return winding_number(points, mesh.vertices[loop], mesh.vertices[mesh.successor[loop]])


def first_lost(contour: Mesh, fine: Mesh) -> int:
    """A loop of the fine mesh for the error message: a hole without a hole of the contour in it, else the last loop."""
    left = _smallest_around(fine, -1, contour, np.flatnonzero(contour.loop_signs < 0))
    lost = np.setdiff1d(np.flatnonzero(fine.loop_signs < 0), left)
    return int(lost[0]) if len(lost) else len(fine.loops) - 1
