"""Level set: the contour of the signed distance at the least offset that still encloses the mesh once it is coarse."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from ...decimation.base import Count, Decimation, checked_budget
from ...decimation.douglas_peucker import DouglasPeucker
from ...decimation.edge_collapse import EdgeCollapse
from ...errors import NestingError
from ...geometry.mesh import Mesh, Nesting
from ...geometry.mesh.validation import place
from ...geometry.smallest_gap import smallest_gap
from .contour import Field
from .level_set_loops import first_lost, loops_around, without_pockets

CELLS_PER_VERTEX = 0.5
"""The grid has at least so many cells along the diagonal per vertex wanted, so that contours have enough of them."""

POINTS_PER_VERTEX = 8
"""Points of a contour, per vertex wanted, that the simplification starts from."""

GROWTH = 1.6
"""Factor from one offset to the next while none encloses."""

LARGEST_OFFSET = 2.0
"""Offset in diagonals at which the search ends: even a triangle around everything is closer."""

PAD = 0.1
"""First distance in diagonals by which the grid goes beyond the mesh; it grows with the offset."""

BISECTIONS = 6
"""Halvings of the interval between an offset that is too small and one that encloses, or that changes the loops."""

RESOLVED = 1.5
"""Offset in cells from which on the grid sees the loops of a level set as they are: closed holes stay closed."""


@dataclass(frozen=True)
class LevelSet:
    """Simple nested cages (Sellán et al. 2022): a level set, decimated, with the least offset that encloses."""

    cells: int = 250
    """Cells of the grid along the diagonal of the mesh."""
    simplification: Decimation = field(default_factory=EdgeCollapse)
    """How the contour gets its number of vertices."""
    change_loops: bool = False
    """Whether holes may close and components merge, as they do at large offsets; otherwise that is an error."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh that strictly encloses the fine one, at least the clearance away; loop k around loop k.

        With `change_loops` it may have other loops, in any order. Raises NestingError where no offset encloses, with
        the loop that was in the way, and for a clearance beyond the largest offset.
        """
        budget = checked_budget(fine, count)
        if clearance >= LARGEST_OFFSET * fine.diagonal:
            raise NestingError(
                f"A level set cannot keep the clearance of {clearance:.6g}, {LARGEST_OFFSET:g} times the size of the "
                "mesh or more; ask for less, or use the outer hull."
            )
        search = _Search(self, fine, count, max(self.cells, int(CELLS_PER_VERTEX * budget.total)), clearance)
        return search.run()


class _Search:
    """Offsets that were tried, and what is known about them."""

    def __init__(self, settings: LevelSet, fine: Mesh, count: Count, cells: int, clearance: float) -> None:
        self.settings, self.fine, self.count, self.clearance = settings, fine, count, clearance
        self.cell = fine.diagonal / cells
        self.pad = PAD * fine.diagonal
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
                "Ask for more vertices, or use the outer hull."
            )
        return found

    def _offsets(self) -> Iterator[float]:
        """Growing offsets, up to where all is enclosed for certain."""
        offset = max(0.5 * self.cell, self.clearance)
        while offset < LARGEST_OFFSET * self.fine.diagonal:
            yield offset
            offset *= GROWTH

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
        if self.changed or not self.problem:  # of all that was in the way, a change of loops tells most
            self.problem = f"at the offset {offset:.3g} {problem}"
        return None

    def _coarse(self, offset: float) -> tuple[Mesh, bool]:
        """The decimated level set, and whether its loops are those of the fine mesh, one to one and in their order."""
        while offset > self.pad - self.cell:
            self.pad *= 2.0
            self.field = Field.signed_distance(self.fine, self.cell, self.pad)
        contour = self.field.contour(offset)
        if contour is None:
            raise NestingError("the grid is too coarse")
        contour = without_pockets(contour, self.fine)
        partner = loops_around(contour, self.fine)
        if partner is not None:
            contour = Mesh.from_loops([contour.vertices[contour.loops[k]] for k in partner])
        elif not self.settings.change_loops:
            self.changed = offset > RESOLVED * self.cell
            raise NestingError(_changed(contour, self.fine))
        return self.settings.simplification.decimate(self._thinned(contour), self.count), partner is not None

    def _thinned(self, contour: Mesh) -> Mesh:
        """A contour with only so many of its vertices that the simplification is not slow."""
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
