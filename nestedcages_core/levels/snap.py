"""A cage moved onto the numbers of its plan: a grid, or those that a type of coordinates holds."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation
from ..energies import Energy
from ..energies.base import EdgeCost
from ..errors import Fault, NestingError, note
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.edge_removal import without_edges
from ..geometry.group import Orbits, orbits_of
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_STEPS
from ..progress import Tick, no_tick
from ..tightening.reach_clearance import shift_edges
from .certify import Path, Verdict, certify, judge
from .plan import Plan
from .progress import OutOfTimeError, Watch
from .report import Level, NestingReport
from .units import SolverUnits

if TYPE_CHECKING:
    from ..constraints.numbers import Numbers

logger = logging.getLogger(__name__)

ROOMS = (0.8, 64.0)
"""Spacings added to the clearance where a cage does not fit on the numbers, tried in turn. The nearest point is at most
0.71 spacings away, so even plain rounding then keeps the clearance; it may still close gaps between parts of the cage.
"""

PUSHES = (0.5, 1.0, 2.0, 4.0)
"""Spacings by which the cage is pushed outwards, tried in turn, where its straight motion to the numbers meets the fine
mesh."""

FEWER = 0.1
"""Part of the vertices, at most, that a cage loses at once where edges have no place."""


class UnsettledError(NestingError):
    """A cage has no place on the numbers."""

    path: Path
    """How it comes about."""
    report: NestingReport

    @classmethod
    def of(cls, path: Path, report: NestingReport, fault: str) -> UnsettledError:
        """The error for a cage at the end of a path."""
        error = cls(fault)
        error.path, error.report = path, report
        return error


def rooms(numbers: Numbers) -> tuple[float, ...]:
    """Distances to keep in addition to the clearance until a cage moves onto the numbers, to try in turn.

    A grid has points farther away only where those of the type that stores it are farther apart.
    """
    coarse = replace(numbers, lattice=None).spacing if numbers.stored else 0.0
    if numbers.grid is None or coarse > numbers.grid:
        return tuple(room * (coarse or numbers.spacing) for room in ROOMS)
    return (ROOMS[0] * numbers.spacing,)


def snapped(plan: Plan, energy: Energy, path: Path, report: NestingReport, watch: Watch) -> Level:
    """The level at the end of a path, moved onto the numbers of the plan; report: with the clearance to keep.

    Raises UnsettledError where there is no place for it.
    """
    assert plan.numbers is not None
    watch.begin("verification")
    try:
        level, missed = _moved(plan, energy, path, report, watch)
    except OutOfTimeError:  # places are not improved then
        level, missed = _moved(plan.on(plan.numbers.hasty()), energy, path, report, watch)
    if level is None:
        raise UnsettledError.of(path, report, _fault(plan, path, report, missed))
    report = replace(level.report, notes=(*level.report.notes, *plan.notes(level.cage)))
    if plan.numbers.stored is not None:
        from .steps import with_stored_steps

        level = with_stored_steps(level, plan.numbers.stored)
        report = replace(report, stored=level.report.stored)
    return replace(level, report=report)


def with_finer_grid(error: UnsettledError, plan: Plan, energy: Energy, watch: Watch) -> NestingError:
    """The error with a grid that works, if there is one among some finer ones."""
    assert plan.numbers is not None
    with suppress(NestingError):  # of the work that a search may take
        for finer in plan.numbers.hasty().finer():
            if _moved(plan.on(finer), energy, error.path, error.report, watch)[0] is not None:
                return NestingError(_fault(plan, error.path, error.report, None, finer.spacing))
    return error


def _fault(plan: Plan, path: Path, report: NestingReport, missed: Fault | None, finer: float | None = None) -> Fault:
    """That there is no place; missed: what the last one does not keep. finer: a grid that works."""
    assert plan.numbers is not None
    grid, clearance, count = plan.numbers.grid, report.wanted_clearance, len(path.coarse.vertices)
    remedy = "ask for a finer one" if finer is None else f"a grid of {finer:.6g} works"
    what = f"the grid of {grid:.6g}" if grid is not None else f"{plan.numbers.stored} numbers"
    if missed is not None:
        return missed.said(f"On {what}: {missed} {remedy[0].upper()}{remedy[1:]}.")
    return Fault(
        f"No cage with {count} vertices on {what} was found that keeps the clearance of {clearance:.6g}; {remedy}.",
        "numbers.no_room",
        spacing=plan.numbers.spacing,
        finer=finer,
        count=count,
        clearance=clearance,
    )


def _moved(
    plan: Plan, energy: Energy, path: Path, report: NestingReport, watch: Watch
) -> tuple[Level | None, Fault | None]:
    """The certified level near the end of a path; None if there is none, and what the last place does not keep but its
    nesting."""
    assert plan.numbers is not None
    resting: Verdict | None = None
    missed: Fault | None = None
    spacing = plan.numbers.spacing
    for _ in range(MOST_STEPS):
        places, stuck = placements(plan, energy, path.cage, report.wanted_clearance, tick=watch.tick("grid"))
        if places or not stuck.any() or len(plan.constraints) > 1:
            break
        at, most = stuck | stuck[path.cage.successor], max(1, int(FEWER * len(stuck)))
        fewer = without_edges(path.cage, at, most, plan.side)
        if fewer is None:
            break
        path = Path.at_rest(plan.fine, fewer)
    for points in places:
        moved = path.coarse.moved(points)
        mended = plan.mended(moved)
        if mended is not None:
            hull, said = Path.at_rest(plan.fine, mended[0]), mended[1]
            return _moved(plan, energy, hull, report.with_count(said), watch)
        verdict = judge(plan, moved, report.wanted_clearance)
        if not verdict:
            missed = verdict.fault if verdict.certificate else None
            logger.debug("numbers %g apart: %s", spacing, verdict.fault)
            continue
        for steps in _ways(path, points, Bodies.of(path.cage, plan.fine, side=plan.side), spacing):
            try:
                return certify(verdict, path._replace(reinflation=steps), report, tick=watch.tick("verification")), None
            except NestingError as error:
                logger.debug("numbers %g apart: %s", spacing, error)
        resting = resting or verdict
    if resting is None:
        return None, missed
    report = replace(report, notes=(*report.notes, note("note.start", on="rest", source=report.start)))
    return certify(resting, Path.at_rest(plan.fine, resting.cage), report), None


def placements(
    plan: Plan, energy: Energy, cage: Mesh, wanted: float, *, tick: Tick = no_tick
) -> tuple[list[FloatArray], BoolArray]:
    """Vertices (m, 2) on the numbers of a plan for a cage, of least energy, at a clearance that they may miss; and (m,)
    those at which edges have no place.

    With a symmetry, those of each sector with their images: one to verify after the other.
    """
    numbers, group = plan.numbers, plan.group
    assert numbers is not None
    units = SolverUnits.of(plan.fine)
    clearance = units.clearance(wanted) * units.scale
    unit_cage = units.from_input(cage)
    bounds = () if numbers.grid is None else plan.bounds(unit_cage, units)

    def allowed(vertex: IntArray, start: FloatArray, end: FloatArray) -> BoolArray:
        ends = units.points(start), units.points(end)
        return np.asarray(np.all([bound.allowed(vertex, *ends) for bound in bounds], axis=0))

    cost = _edge_cost(plan, energy, unit_cage, units)
    vertices, stuck = numbers.settled(
        cage, plan.outline.mesh, clearance, plan.side, allowed if bounds else None, cost, tick
    )
    if vertices is None or group is None:
        return ([] if vertices is None else [vertices]), stuck
    orbits = orbits_of(cage, group)
    if orbits is None:
        return [], stuck
    points = numbers.exact(vertices)
    return [numbers.nearest(_from_sector(points, orbits, k)) for k in range(group.order)], stuck


def _edge_cost(plan: Plan, energy: Energy, unit_cage: Mesh, units: SolverUnits) -> EdgeCost | None:
    """What edges add to the energy of a plan; None if that is the area."""
    bound, is_measure = plan.energy(energy.at(unit_cage), unit_cage, units)
    if not is_measure:
        return None
    at_cage, area = bound.after(unit_cage.vertices), units.scale * units.scale

    def cost(vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        return area * at_cage.on_edge(vertex, units.points(start), units.points(end))

    return cost


def _from_sector(points: FloatArray, orbits: Orbits, k: int) -> FloatArray:
    """(m, 2) all vertices as images of those that element k makes; numbers that the group keeps hold them exactly."""
    first, mine = points[orbits.first].copy(), orbits.element == k
    first[orbits.orbit[mine]] = orbits.symmetry.image(points[mine], -k % orbits.symmetry.order)
    given = points.copy()
    given[orbits.first] = first
    return orbits.symmetrised(given)


def _ways(way: Path, vertices: FloatArray, walked: Bodies, spacing: float) -> Iterator[Reinflation]:
    """The steps of a way continued to vertices (m, 2): straight, with edges pushed away from the fine mesh midway, and
    from an earlier step."""
    path = way.reinflation
    last = path.cage_steps[-1]
    if np.array_equal(last, vertices):
        yield path  # a further step would be shown as frames without motion
        return
    yield path.with_tightening([vertices])
    middle, shift = 0.5 * (last + vertices), np.ones(walked.m) * spacing
    for push in PUSHES:
        yield path.with_tightening([middle + shift_edges(walked, middle, push * shift), vertices])
    for number in range(len(path.cage_steps) - 2, path.tightening_start - 1, -1):
        kept = np.concatenate([path.cage_steps[: number + 1], vertices[None]])
        yield Reinflation(path.moving_steps, kept, path.iterations)
