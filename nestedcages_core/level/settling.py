"""A level with its cage on the numbers of its plan, made from one on any numbers."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation
from ..energies import Area, Energy
from ..energies.area import LostArea
from ..errors import Fault, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.group import Orbits
from ..geometry.mesh import Mesh
from ..tasks import Stage
from ..tightening.reach_clearance import shift_edges
from ..verification.motion import certify_motion
from .plan import EdgeCost, Numbers, Plan
from .report import Level, LevelProgress, Progress
from .settings import LevelSettings
from .symmetrised_start import orbits_of
from .units import SolverUnits

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

    @property
    def rooms(self) -> list[float]:
        """Clearances that settling may take, to try in turn; a grid has points farther away only where it is too
        coarse."""
        return [room * self.numbers.spacing for room in (ROOMS[:1] if self.numbers.grid is not None else ROOMS)]

    def settled(self, level: Level) -> Stage[Progress, Level | None]:
        """The level with its cage on the numbers, certified; None if there is none."""
        yield from self.progress.begin("verification")
        found = yield from self._moved(level, self.numbers)
        if found is None and self.plan.group is None:
            found = yield from self._moved(self._widened(level), self.numbers)
        if found is None:
            return None
        self.progress.stop_clock()
        notes = self._noted(level, found)
        if found.report.stored is not None:
            from .steps import with_stored_steps

            found = with_stored_steps(found)
        return replace(found, report=replace(found.report, notes=notes, seconds=dict(self.progress.seconds)))

    def failure(self, level: Level) -> Stage[Progress, NestingError]:
        """The error for a level that has no cage on the numbers."""
        remedy, works = "ask for a finer one", None
        for finer in self.numbers.finer():
            if (yield from self._moved(level, finer)) is not None:
                remedy, works = f"a grid of {finer.spacing:.6g} works", finer.spacing
                break
        count, clearance = len(level.cage.vertices), level.report.wanted_clearance
        grid = self.numbers.grid
        what = f"the grid of {grid:.6g}" if grid is not None else f"{self.numbers.stored} numbers"
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
        clearance = level.report.wanted_clearance
        before, after = (self.plan.notes(each.cage, clearance) for each in (level, found))
        return (*(note for note in found.report.notes if note not in before), *after)

    def _moved(self, level: Level, numbers: Numbers) -> Stage[Progress, Level | None]:
        """The level with its cage on some numbers, certified; None if there is none."""
        plan, wanted = replace(self.plan, numbers=numbers), level.report.wanted_clearance
        search = placements(plan, self.choices.energy, level.cage, wanted)
        found = yield from self.progress.follow(search, lambda done: (done, "grid"))
        same_loops = level.coarse.has_loops_like(level.fine)
        for points in found:
            cage = level.coarse.moved(points)
            mended = plan.mended(cage)
            if mended is not None:
                return (yield from self._moved(level.standing(*mended), numbers))
            certificate = plan.verify(cage, wanted, same_loops=same_loops)
            path = _path(level, points, numbers.spacing) if certificate and plan.fault(cage) is None else None
            if path is None:
                logger.debug("numbers %g apart: %s", numbers.spacing, certificate.problems or "no free path")
                continue
            report = replace(
                level.report,
                clearance=certificate.clearance,
                excess=cage.area / level.fine.area - 1.0,
                grid=numbers.grid,
                stored=numbers.stored,
            )
            return replace(level, cage=cage, reinflation=path, report=report)
        return None

    def _widened(self, level: Level) -> Level:
        """The level tightened with more clearance."""
        units = SolverUnits.of(level.fine)
        cage, fine = units.from_input(level.cage), units.from_input(level.fine)
        bodies = Bodies.of(cage, fine, side=self.plan.side)
        energy = Area() if level.side > 0 else LostArea(fine.area)
        clearance = units.clearance(level.report.wanted_clearance + self.rooms[0])
        run = self.choices.tightening.run(bodies, cage.vertices, fine.vertices, clearance=clearance, energy=energy)
        wider = [units.to_input(step) for step in run]
        if not wider:
            return level
        return replace(level, cage=level.coarse.moved(wider[-1]), reinflation=level.reinflation.with_tightening(wider))


def placements(plan: Plan, energy: Energy, cage: Mesh, wanted: float) -> Stage[float, list[FloatArray]]:
    """Vertices (m, 2) on the numbers of a plan for a cage, of least energy, at a clearance that they may miss.

    With a symmetry, those of each sector with their images: one to verify after the other.
    """
    numbers, group = plan.numbers, plan.group
    assert numbers is not None
    units = SolverUnits.of(plan.fine)
    clearance = units.clearance(wanted) * units.scale
    vertices = yield from numbers.settled(
        cage, plan.outline, clearance, plan.side, _edge_cost(plan, energy, cage, units, wanted)
    )
    if vertices is None or group is None:
        return [] if vertices is None else [vertices]
    orbits = orbits_of(cage, group)
    if orbits is None:
        return []
    return [numbers.nearest(_from_sector(numbers.exact(vertices), orbits, k)) for k in range(group.order)]


def _edge_cost(plan: Plan, energy: Energy, cage: Mesh, units: SolverUnits, wanted: float) -> EdgeCost | None:
    """What edges add to the energy of a plan; None if that is the area."""
    unit_cage = units.from_input(cage)
    bound, is_measure = plan.energy(energy.at(unit_cage), unit_cage, units, units.clearance(wanted))
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


def _path(level: Level, vertices: FloatArray, spacing: float) -> Reinflation | None:
    """The steps of the level, continued to vertices (m, 2); None if that motion is not collision-free.

    Tried in turn: straight, with edges pushed away from the fine mesh midway, and from an earlier step.
    """
    path, bodies = level.reinflation, Bodies.of(level.cage, level.fine)
    last = path.cage_steps[-1]
    if np.array_equal(last, vertices):
        return path  # a further step would be shown as frames without motion
    walked = Bodies.of(level.cage, level.fine, side=level.side)
    middle = 0.5 * (last + vertices)
    shift = np.ones(bodies.m) * spacing
    ways = [[last, vertices]]
    ways += [[last, middle + shift_edges(walked, middle, push * shift), vertices] for push in PUSHES]
    for steps in ways:
        if certify_motion(bodies, steps, [level.fine.vertices] * len(steps)):
            return path.with_tightening(steps[1:])
    for number in range(len(path.cage_steps) - 2, path.tightening_start - 1, -1):
        if certify_motion(bodies, [path.cage_steps[number], vertices], [level.fine.vertices] * 2):
            kept = np.concatenate([path.cage_steps[: number + 1], vertices[None]])
            return Reinflation(path.moving_steps, kept, path.iterations)
    return None
