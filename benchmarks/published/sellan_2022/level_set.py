"""Decimated level sets of the signed distance, at the smallest offset that encloses the mesh (Sellán et al. 2022)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from nestedcages_core.decimation.base import Count, Decimation
from nestedcages_core.decimation.budget import checked_budget
from nestedcages_core.errors import NestingError
from nestedcages_core.geometry.arrays import FloatArray, IntArray
from nestedcages_core.geometry.mesh import Mesh, Nesting
from nestedcages_core.geometry.predicates import winding_number
from nestedcages_core.geometry.smallest_gap import smallest_gap
from nestedcages_core.geometry.vectors import place
from nestedcages_core.parameters import check_count, check_flag, check_part

from ..simplification.douglas_peucker import DouglasPeucker
from ..simplification.edge_collapse import EdgeCollapse
from .contour import Field

CELLS_PER_VERTEX = 0.5
"""Minimum number of grid cells along the diagonal per wanted vertex, so that contours have enough vertices."""

POINTS_PER_VERTEX = 8
"""Maximum number of contour points per wanted vertex that are passed to the simplification, to limit its time."""

OFFSET_GROWTH = 1.6
"""Factor to the next offset while none encloses."""

LARGEST_OFFSET = 2.0
"""Offset in diagonals at which the search ends: a triangle around the bounding box is closer."""

FIRST_PADDING = 0.1
"""First padding of the grid around the mesh, in diagonals; it doubles as offsets grow."""

BISECTIONS = 6
"""Number of bisections between an offset that is too small and one that encloses or changes the loops."""

RESOLVED_OFFSET = 1.5
"""Offset in cells above which the grid resolves the loops of a level set: closed holes stay closed."""


@dataclass(frozen=True)
class LevelSet:
    """Simple nested cages: a decimated level set at the smallest offset that encloses the mesh."""

    cells: int = 250
    """Grid cells along the diagonal of the mesh."""
    simplification: Decimation = field(default_factory=EdgeCollapse)
    """Decimation of the contour."""
    change_loops: bool = False
    """Whether holes may close and components merge, as at large offsets; otherwise that is an error."""

    def __post_init__(self) -> None:
        check_count(self, "cells")
        check_flag(self, "change_loops")
        check_part(self, "simplification", "decimate", "EdgeCollapse()")

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh that strictly encloses the fine one, at least the clearance away; loop k around loop k.

        With `change_loops` it may have other loops, in any order. Raises NestingError where no offset encloses, with
        the blocking loop, and for a clearance beyond the largest offset.
        """
        budget = checked_budget(fine, count)
        if clearance >= LARGEST_OFFSET * fine.diagonal:
            raise NestingError(
                f"A level set cannot keep the clearance of {clearance:.6g}, {LARGEST_OFFSET:g} times the size of the "
                "mesh or more; ask for less, or use the outer hull.",
                code="clearance.too_large",
            )
        search = _Search(self, fine, count, max(self.cells, int(CELLS_PER_VERTEX * budget.total)), clearance)
        return search.run()


class _Search:
    """State of the search for the offset."""

    def __init__(self, settings: LevelSet, fine: Mesh, count: Count, cells: int, clearance: float) -> None:
        self.settings, self.fine, self.count, self.clearance = settings, fine, count, clearance
        self.cell = fine.diagonal / cells
        self.pad = FIRST_PADDING * fine.diagonal
        self.field = Field.signed_distance(fine, self.cell, self.pad)
        self.problem = ""
        self.changed = False

    def run(self) -> Mesh:
        """The coarse mesh of the smallest offset found."""
        below, found = 0.0, None
        for offset in self._offsets():
            found = self._enclosing(offset)
            if found is not None or self.changed:
                break
            below = offset
        for _ in range(BISECTIONS):
            middle = 0.5 * (below + offset)
            tighter = self._enclosing(middle)
            if tighter is not None:
                found = tighter
            if tighter is not None or self.changed:
                offset = middle
            else:
                below = middle
        if found is None:
            raise NestingError(
                f"No level set can be brought down to {self.count} vertices around the mesh: {self.problem}. "
                "Ask for more vertices, or use the outer hull.",
                code="count.too_small",
            )
        return found

    def _offsets(self) -> Iterator[float]:
        """Growing offsets, up to one that certainly encloses."""
        offset = max(0.5 * self.cell, self.clearance)
        while offset < LARGEST_OFFSET * self.fine.diagonal:
            yield offset
            offset *= OFFSET_GROWTH

    def _enclosing(self, offset: float) -> Mesh | None:
        """The decimated level set at an offset if it encloses the fine mesh; otherwise None, and `problem` says why."""
        self.changed = False
        try:
            coarse, one_to_one = self._coarse(offset)
            same_loops = not one_to_one or loops_around(coarse, self.fine) is not None
            if same_loops and Nesting(coarse, self.fine).encloses() and _distance(coarse, self.fine) >= self.clearance:
                return coarse
            problem = "it still cuts into the mesh"
        except NestingError as error:
            problem = str(error)
        if self.changed or not self.problem:  # a change of loops is the most useful reason
            self.problem = f"at the offset {offset:.3g} {problem}"
        return None

    def _coarse(self, offset: float) -> tuple[Mesh, bool]:
        """The decimated level set, and whether its loops match those of the fine mesh, one to one and in order."""
        while offset > self.pad - self.cell:
            self.pad *= 2.0
            self.field = Field.signed_distance(self.fine, self.cell, self.pad)
        contour = self.field.contour(offset)
        if contour is None:
            raise NestingError("the grid is too coarse", code="file.invalid")
        contour = without_pockets(contour, self.fine)
        partner = loops_around(contour, self.fine)
        if partner is not None:
            contour = Mesh.from_loops([contour.vertices[contour.loops[k]] for k in partner])
        elif not self.settings.change_loops:
            self.changed = offset > RESOLVED_OFFSET * self.cell
            raise NestingError(_changed(contour, self.fine), code="file.invalid")
        return self.settings.simplification.decimate(self._thinned(contour), self.count), partner is not None

    def _thinned(self, contour: Mesh) -> Mesh:
        """The contour reduced to `POINTS_PER_VERTEX` points per wanted vertex."""
        if not isinstance(self.count, Sequence):
            few = POINTS_PER_VERTEX * self.count
            return DouglasPeucker().decimate(contour, few) if few < len(contour.vertices) else contour
        per_loop = [min(POINTS_PER_VERTEX * k, len(loop)) for k, loop in zip(self.count, contour.loops, strict=True)]
        return DouglasPeucker().decimate(contour, per_loop)


def _distance(one: Mesh, other: Mesh) -> float:
    """Smallest distance between two meshes whose edges do not cross."""
    return smallest_gap(one.edge_tree, other.edge_tree)


def _changed(contour: Mesh, fine: Mesh) -> str:
    """How the loops of a level set differ from those of the fine mesh."""
    parts, holes = (int((fine.loop_signs == sign).sum()) for sign in (1, -1))
    now_parts, now_holes = (int((contour.loop_signs == sign).sum()) for sign in (1, -1))
    at = place(fine.vertices[fine.loops[first_lost(contour, fine)][0]])
    return f"its outlines and holes, {parts} and {holes}, have become {now_parts} and {now_holes}, as near {at}"


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
