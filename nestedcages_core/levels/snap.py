"""A cage moved onto the numbers of its plan: a grid, or those that a type of coordinates holds."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import replace

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
from .certify import Path, UnsettledError, Verdict, certify, judge
from .plan import Plan
from .report import Level, NestingReport
from .units import SolverUnits
from .work import Work

logger = logging.getLogger(__name__)

PUSHES = (0.5, 1.0, 2.0, 4.0)
"""Spacings by which the cage is pushed outwards, tried in turn, where its straight motion to the numbers meets the fine
mesh."""

FEWER = 0.1
"""Part of the vertices, at most, that a cage loses at once where edges have no place."""


def snapped(work: Work, path: Path, report: NestingReport) -> Level:
    """The level at the end of a path, moved onto the numbers of the plan; report: with the clearance to keep.

    Raises UnsettledError where there is no place for it.
    """
    plan = work.plan
    assert plan.numbers is not None
    work.watch.begin("verification")
    level = _moved(work, path, report)
    report = replace(level.report, notes=(*level.report.notes, *plan.missed(level.cage, must=False)))
    if plan.numbers.stored is not None:
        from .steps import with_stored_steps

        level = with_stored_steps(level, plan.numbers.stored)
        report = replace(report, stored=level.report.stored)
    return replace(level, report=report)


def _moved(work: Work, path: Path, report: NestingReport) -> Level:
    """The certified level near the end of a path. Raises UnsettledError."""
    plan, wanted, count = work.plan, report.wanted_clearance, len(path.coarse.vertices)
    assert plan.numbers is not None
    resting: Verdict | None = None
    missed: Fault | None = None
    for _ in range(MOST_STEPS):
        places, stuck = placements(plan, work.settings.energy, path.cage, wanted, tick=work.watch.tick("grid"))
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
            return _moved(work, Path.at_rest(plan.fine, mended[0]), report.with_count(mended[1]))
        verdict = judge(plan, moved, wanted)
        if not verdict:
            missed = verdict.fault if verdict.certificate else None
            logger.debug("numbers %g apart: %s", plan.numbers.spacing, verdict.fault)
            continue
        bodies = Bodies.of(path.cage, plan.fine, side=plan.side)
        for steps in _ways(path.reinflation, points, bodies, plan.numbers.spacing):
            try:
                return certify(verdict, path._replace(reinflation=steps), report, tick=work.watch.tick("verification"))
            except NestingError as error:
                logger.debug("numbers %g apart: %s", plan.numbers.spacing, error)
        resting = resting or verdict
    if resting is None:
        unsettled = UnsettledError(_no_place(plan, count, wanted, missed))
        unsettled.excess = plan.side * (path.cage.area / plan.fine.area - 1.0)
        raise unsettled
    report = replace(report, notes=(*report.notes, note("note.start", on="rest", source=report.start)))
    return certify(resting, Path.at_rest(plan.fine, resting.cage), report)


def _no_place(plan: Plan, count: int, clearance: float, missed: Fault | None) -> Fault:
    """That there is no place for a cage; missed: what the last one does not keep."""
    assert plan.numbers is not None
    what = f"{plan.numbers.stored} numbers" if plan.grid is None else f"the grid of {plan.grid:.6g}"
    if missed is not None:
        return missed.said(f"On {what}: {missed} Ask for a finer one.")
    return Fault(
        f"No cage with {count} vertices on {what} was found that keeps the clearance of {clearance:.6g}; ask for a "
        "finer one, or for less clearance.",
        "numbers.no_room",
        spacing=plan.numbers.spacing,
        count=count,
        clearance=clearance,
    )


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
    if plan.importance is None:
        return None
    at_cage = plan.energy(energy.at(unit_cage), unit_cage, units).after(unit_cage.vertices)

    def cost(vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        return units.scale**2 * at_cage.on_edge(vertex, units.points(start), units.points(end))

    return cost


def _from_sector(points: FloatArray, orbits: Orbits, k: int) -> FloatArray:
    """(m, 2) all vertices as images of those that element k makes; numbers that the group keeps hold them exactly."""
    first, mine = points[orbits.first].copy(), orbits.element == k
    first[orbits.orbit[mine]] = orbits.symmetry.image(points[mine], -k % orbits.symmetry.order)
    given = points.copy()
    given[orbits.first] = first
    return orbits.symmetrised(given)


def _ways(path: Reinflation, vertices: FloatArray, walked: Bodies, spacing: float) -> Iterator[Reinflation]:
    """The steps continued to vertices (m, 2): straight, or with edges pushed away from the fine mesh midway."""
    last = path.cage_steps[-1]
    if np.array_equal(last, vertices):
        yield path  # a further step would be shown as frames without motion
        return
    yield path.with_tightening([vertices])
    middle, shift = 0.5 * (last + vertices), np.ones(walked.m) * spacing
    for push in PUSHES:
        yield path.with_tightening([middle + shift_edges(walked, middle, push * shift), vertices])
