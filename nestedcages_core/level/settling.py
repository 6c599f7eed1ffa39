"""A level with its cage on the numbers of its plan, made from one on any numbers."""

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
from ..geometry.group import Orbits, orbits_of
from ..geometry.mesh import Mesh
from ..progress import Tick, no_tick
from ..tightening.reach_clearance import shift_edges
from .gate import Way, admitted, judged
from .plan import Plan
from .report import JudgedCage, Level, LevelProgress, NestingReport
from .settings import LevelSettings
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


class Settling:
    """Moves cages of one plan onto its numbers."""

    def __init__(self, plan: Plan, choices: LevelSettings, progress: LevelProgress) -> None:
        assert plan.numbers is not None
        self.plan, self.numbers, self.choices, self.progress = plan, plan.numbers, choices, progress
        self.missed: Fault | None = None
        """What the last cage on the numbers misses but its nesting."""

    @property
    def rooms(self) -> list[float]:
        """Clearances that settling may take, to try in turn; a grid has points farther away only where it is too
        coarse."""
        numbers = self.numbers
        spacing = (
            numbers.spacing
            if numbers.grid is None
            else replace(numbers, lattice=None).spacing
            if numbers.stored
            else 0.0
        )
        if spacing > (numbers.grid or 0.0):  # numbers of the type are farther apart than those of the grid
            return [room * spacing for room in ROOMS]
        return [ROOMS[0] * numbers.spacing]

    def hasty(self) -> Settling:
        """The same, content with the first places."""
        return Settling(self.plan.on(self.numbers.hasty()), self.choices, self.progress)

    def settled(self, level: Level) -> Level | None:
        """The level with its cage on the numbers, certified; None if there is none."""
        self.progress.begin("verification")
        found = self._moved(level, Way.of(level), level.report, self.numbers)
        if found is None:
            return None
        self.progress.stop_clock()
        notes = self._noted(level, found)
        if self.numbers.stored is not None:
            from .steps import with_stored_steps

            found = with_stored_steps(found, self.numbers.stored)
        return replace(found, report=replace(found.report, notes=notes, seconds=dict(self.progress.seconds)))

    def failure(self, level: Level) -> NestingError:
        """The error for a level that has no cage on the numbers."""
        remedy, works, missed = "ask for a finer one", None, self.missed
        with suppress(NestingError):  # of the work that a search may take
            for finer in self.numbers.hasty().finer():
                if self._moved(level, Way.of(level), level.report, finer) is not None:
                    remedy, works = f"a grid of {finer.spacing:.6g} works", finer.spacing
                    break
        count, clearance = len(level.cage.vertices), level.report.wanted_clearance
        grid = self.numbers.grid
        what = f"the grid of {grid:.6g}" if grid is not None else f"{self.numbers.stored} numbers"
        if missed is not None:
            return NestingError(missed.said(f"On {what}: {missed} {remedy[0].upper()}{remedy[1:]}."))
        return NestingError(
            f"No cage with {count} vertices on {what} was found that keeps the clearance of {clearance:.6g}; {remedy}.",
            code="numbers.no_room",
            spacing=self.numbers.spacing,
            finer=works,
            count=count,
            clearance=clearance,
        )

    def _noted(self, level: Level, found: Level) -> tuple[Fault, ...]:
        """The notes of the settled level, with what its cage misses instead of what the one before missed."""
        before, after = (self.plan.notes(each.cage) for each in (level, found))
        return (*(each for each in found.report.notes if each not in before), *after)

    def _moved(self, level: Level, way: Way, report: NestingReport, numbers: Numbers) -> Level | None:
        """The level with a cage near that of a way on some numbers, certified; None if there is none."""
        plan, wanted = self.plan.on(numbers), report.wanted_clearance
        found = placements(plan, self.choices.energy, way.cage, wanted, tick=self.progress.tick("grid"))
        resting: JudgedCage | None = None
        for points in found:
            moved = way.coarse.moved(points)
            mended = plan.mended(moved)
            if mended is not None:
                hull, said = Way.at_rest(plan.fine, mended[0]), mended[1]
                return self._moved(level, hull, report.with_count(said), numbers)
            cage = judged(plan, moved, wanted)
            if not cage:
                self.missed = cage.fault if cage.certificate else None
                logger.debug("numbers %g apart: %s", numbers.spacing, cage.fault)
                continue
            for path in _paths(way, points, Bodies.of(way.cage, plan.fine, side=plan.side), numbers.spacing):
                try:
                    return admitted(cage, way._replace(reinflation=path), report, level)
                except NestingError as error:
                    logger.debug("numbers %g apart: %s", numbers.spacing, error)
            resting = resting or cage
        if resting is None:
            return None
        report = replace(report, notes=(*report.notes, note("note.start", on="rest", source=report.start)))
        return admitted(resting, Way.at_rest(plan.fine, resting.cage), report)


def placements(plan: Plan, energy: Energy, cage: Mesh, wanted: float, *, tick: Tick = no_tick) -> list[FloatArray]:
    """Vertices (m, 2) on the numbers of a plan for a cage, of least energy, at a clearance that they may miss.

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
    vertices = numbers.settled(cage, plan.outline.mesh, clearance, plan.side, allowed if bounds else None, cost, tick)
    if vertices is None or group is None:
        return [] if vertices is None else [vertices]
    orbits = orbits_of(cage, group)
    if orbits is None:
        return []
    return [numbers.nearest(_from_sector(numbers.exact(vertices), orbits, k)) for k in range(group.order)]


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


def _paths(way: Way, vertices: FloatArray, walked: Bodies, spacing: float) -> Iterator[Reinflation]:
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
