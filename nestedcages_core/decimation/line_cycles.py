"""Line cycles: the lines around the loops that enclose them with the least area.

A cage is a cycle of directed lines with the solid on their left. The area between it and the outline is a sum over
pairs of consecutive lines: of the region between the path from the contact of one line, by their vertex, to the contact
of the next, and the outline between these contacts. So dynamic programming finds the best cycles of 3, 4, … lines among
candidates, and the best number of lines for each loop. Where edges that are not neighbours cross, one of them gives
way, and the search is repeated.

See docs/numbers.md: line cycles; the curve.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ..errors import InvalidMeshError, NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import near_pairs
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh
from ..geometry.precision import ROUND_OFF
from ..geometry.thinning import thinned, tolerance_for
from ..parameters import check_flag, check_side
from ..progress import Tick, no_tick
from .base import NOTHING_KEPT, Count, Kept, Start
from .closest_points import closest_on_curve
from .cycle_search import OFFSET, CycleSearch, NoCyclesError, Tables
from .loop_sequence import empty_holes, filled
from .problem import Problem, canonical_order, checked_count
from .symmetric import symmetrised

SOURCE = "line cycles"
"""Name of its meshes in reports."""

OFFSETS = (OFFSET, 1e-6, 3e-8, 1e-9)
"""Distances of lines from the outline, in diameters, tried in turn: gaps may be too narrow for the first."""

CROSSING_RULES = (1.0, 1e9, 0.3)
"""Rules for which of two crossing edges is shortened; the best result is kept (docs/numbers.md: line cycles: ways to
clear crossings)."""

ALL_POINTS, MIN_POINTS, POINTS_PER_VERTEX = 1500, 400, 16
"""Vertices up to which a mesh stays as it is; vertices of a thinned one: at least, and per vertex of the cage."""

MAX_TOLERANCE, FINER = 0.02, (1.0, 0.2, 0.04)
"""Largest tolerance of thinning, in mean edges of the cage; parts of it to try in turn, where gaps are narrow."""

MAX_EXCESS_OF_SYMMETRY = 0.008
"""Fraction of the area beyond the outline that a preferred symmetry may cost."""

MAX_EXCESS_ON_CURVE = 1.0
"""Excess above which a mesh on the curve would cut most of the shape off, so that no flow gets it inside."""


@dataclass(frozen=True)
class LineCycles:
    """The lines of least area around each loop, with the vertices distributed over the loops in the best way."""

    on_curve: bool = True
    """Whether the start comes with a mesh on the fine one, from which the flow leads to a cage."""
    side: int = 1
    """1 for meshes around the fine one, -1 for meshes inside it."""

    def __post_init__(self) -> None:
        check_flag(self, "on_curve")
        check_side(self)

    @property
    def outside(self) -> LineCycles:
        """The same without meshes on the curve."""
        return replace(self, on_curve=False)

    @property
    def inside(self) -> LineCycles:
        """The same for meshes inside the fine one."""
        return replace(self, on_curve=False, side=-1)

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A mesh that is to enclose the fine one, which the certificate decides; see `starts`."""
        return next(self.starts(fine, count, clearance=clearance)).coarse

    def starts(
        self,
        fine: Mesh,
        count: Count,
        *,
        clearance: float = 0.0,
        kept: Kept = NOTHING_KEPT,
        tick: Tick = no_tick,
        tables: Tables | None = None,
    ) -> Iterator[Start]:
        """One mesh that is to enclose the fine one, or to lie inside it, which the certificate decides.

        count: total number of vertices, or one per loop of the fine mesh. clearance: distance to keep from the fine
        mesh where there is space, in input units. Loop k of the mesh belongs to loop k of the fine mesh. tables:
        searches around loops of other outlines, with the same kept.

        Raises NestingError where no cycles are found.
        """
        known = tables is not None and tables.knows(canonical_order(fine)[0])
        mesh = None if known else _around_thinned(fine, count, self.side, kept, clearance, tick)
        if mesh is None:
            problem = Problem.of(fine, count, self.side, kept)
            try:
                mesh = _least_mesh(problem, clearance, tick, tables=tables)
            except NoCyclesError:
                if not kept.rules:
                    raise
                free = replace(problem, kept=replace(kept, rules=()))  # the tightening moves it to where rules hold
                mesh = _least_mesh(free, clearance, tick)
        yield self._start(mesh, fine, kept)

    def _start(self, mesh: Mesh, fine: Mesh, kept: Kept) -> Start:
        near = self.on_curve and mesh.area <= (1.0 + MAX_EXCESS_ON_CURVE) * fine.area
        return Start(mesh, SOURCE, closest_on_curve(mesh, fine, kept.symmetry or kept.preferred) if near else None)


def least_areas(
    fine: Mesh, most: int, kept: Kept = NOTHING_KEPT, clearance: float = 0.0, tables: Tables | None = None
) -> tuple[FloatArray, list[int]]:
    """(n,) about the least area of a mesh of 0, 1, … vertices around the fine one; infinite where none was found; and
    the holes that the mesh of least area leaves out.

    One search knows all numbers of lines up to the last.
    """
    holes = empty_holes(fine)
    problem = Problem.of(fine, most, kept=replace(kept, preferred=None), optional=holes)
    loops = symmetrised(problem.outline, kept.symmetry)
    try:
        search = CycleSearch(problem, loops, _shifts(problem, loops, clearance)[0], tables)
        search.search(roughly=True)
    except NoCyclesError as error:
        narrow = np.intersect1d(holes, problem.loop_order[list(error.loops)])
        if not len(narrow):
            raise
        least, left_out = least_areas(filled(fine, narrow), most, kept, clearance, tables)
        others = np.setdiff1d(np.arange(len(fine.loops)), narrow)
        return least, np.union1d(narrow, others[left_out]).tolist()
    least, left_out = search.least()
    return least, problem.loop_order[left_out].tolist()


def _around_thinned(fine: Mesh, count: Count, side: int, kept: Kept, clearance: float, tick: Tick) -> Mesh | None:
    """The mesh of the best cycles around a large mesh with fewer vertices, as far away from it as these miss of the
    whole one; None where that is no use. Raises NestingError for a count that no mesh has."""
    total, _ = checked_count(fine, count)
    points = max(MIN_POINTS, POINTS_PER_VERTEX * total)
    if side < 0 or not kept.is_free or len(fine.vertices) <= max(ALL_POINTS, 2 * points):
        return None
    told, most = fine.loop_order.significance, MAX_TOLERANCE * float(fine.edge_lengths.sum()) / total
    for finer in FINER:
        tolerance = finer * min(tolerance_for(told, points, fine.diagonal), most)
        with suppress(NestingError, InvalidMeshError):
            thin = Problem.of(thinned(fine, told > tolerance), count, side, kept)
            return _least_mesh(thin, clearance + tolerance, tick, tolerance)
    return None


def _least_mesh(
    problem: Problem, clearance: float, tick: Tick, least: float = 0.0, tables: Tables | None = None
) -> Mesh:
    """The mesh of the best cycles, at the largest of several distances from the outline, above the least one. Raises
    NestingError."""
    kept = problem.kept
    loops = symmetrised(problem.outline, kept.symmetry)
    if kept.importance is not None:
        with suppress(NestingError):  # pins next to an axis hold the closest vertices that are there
            loops = symmetrised(kept.importance.with_vertices(loops), kept.symmetry)
    failure = NoCyclesError("Gaps are too narrow for such lines.")
    for shift in _shifts(problem, loops, clearance):
        if float(shift.min()) * loops.diameter < least:
            break
        if (least > 0.0 or shift.max() <= OFFSET) and is_narrow(
            loops, problem.regions, 2.0 * float(shift.max()) * loops.diameter
        ):
            continue
        try:
            search = CycleSearch(problem, loops, shift, tables, keeps_shift=least > 0.0)
            return _of_least_area(search, loops, tick)
        except NoCyclesError as error:
            failure = error  # the tightening may find the room that is left out here
    raise failure


def _shifts(problem: Problem, loops: Loops, clearance: float) -> list[FloatArray]:
    """(L,) distances of lines from each loop, to try in turn."""
    wanted = np.full(len(loops.sizes), max(OFFSET, (1.0 + ROUND_OFF) * clearance / loops.diameter))
    for rule in problem.kept.rules:
        of_loops = rule.distances(problem.fine)
        if of_loops is not None:
            wanted = np.maximum(wanted, of_loops[problem.loop_order] / loops.diameter)
    first = [wanted] if (wanted > OFFSET).any() else []
    return [*first, *(np.full(len(wanted), offset) for offset in OFFSETS)]


def _of_least_area(search: CycleSearch, loops: Loops, tick: Tick) -> Mesh:
    """The mesh of least area of several ways to clear crossings. Raises NoCyclesError."""
    search.search(tick)
    found: list[tuple[float, Mesh]] = []
    error = NoCyclesError()
    for rule in CROSSING_RULES:
        try:
            area, mesh, rounds = search.best(rule, tick)
        except NoCyclesError as failure:
            error = failure
            continue
        found.append((area, mesh))
        if rounds == 0:
            break
    if not found:
        raise error
    area, mesh = min(found, key=lambda each: each[0])
    if search.kept.preferred is None or search.problem.per_loop is not None:
        return mesh
    return _symmetric(search, loops, loops.area + (1.0 + MAX_EXCESS_OF_SYMMETRY) * (area - loops.area)) or mesh


def _symmetric(plain: CycleSearch, loops: Loops, most: float) -> Mesh | None:
    """The mesh of the best cycles with the preferred symmetry; None if they cross, or have more than an area."""
    symmetry = plain.kept.preferred
    try:
        alike = symmetrised(loops, symmetry)
        problem = replace(plain.problem, kept=replace(plain.kept, symmetry=symmetry))
        search = CycleSearch(problem, alike, plain.shift, keeps_shift=plain.keeps_shift)
        search.search()
        area, mesh, rounds = search.best(1.0)
    except NestingError:
        return None
    return mesh if rounds == 0 and area <= most else None


def is_narrow(loops: Loops, regions: IntArray, width: float) -> bool:
    """Whether two loops that bound the same empty region, of the (L,) given ones, are closer than a width."""
    if len(loops.sizes) == 1:
        return False
    vertex, edge = near_pairs(loops.vertices, loops.vertices, loops.ends, width)
    one, other = loops.loop[vertex], loops.loop[edge]
    return bool(((one != other) & (regions[one] == regions[other])).any())
