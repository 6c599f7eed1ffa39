"""A level with its cage on a grid: made from a level off the grid, and certified on the grid's numbers."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Protocol

import numpy as np

from ...contact.pairs import Bodies
from ...contact.reinflation import Reinflation
from ...energies import Area, inwards
from ...errors import Fault, NestingError
from ...flow import FlowResult
from ...geometry.arrays import FloatArray
from ...geometry.lattice import Grid
from ...geometry.mesh import Mesh
from ...level.choices import Choices
from ...level.plan import Plan
from ...level.progress import LevelProgress
from ...level.report import Level, Progress
from ...level.units import SolverUnits
from ...tasks import Stage
from ...tightening.restore_feasibility import shift_edges
from ...verification import verify
from ...verification.motion import certify_motion
from ..convex.need import is_convex, without_dents
from .search import put_on_grid

logger = logging.getLogger(__name__)

GRID_ROOM = 0.8
"""Grid steps added to the clearance where a cage does not fit on the grid. The nearest grid point is at most 0.71 steps
away, so even plain rounding then keeps the clearance."""

FINER = ("0.5", "0.2", "0.1", "0.05", "0.02", "0.01")
"""Finer grids that are tried for the error message, relative to one without a cage."""

PUSHES = (0.5, 1.0, 2.0, 4.0)
"""Grid steps by which the cage is pushed outwards, tried in turn, where its straight motion to the grid meets the fine
mesh."""


class Builder(Protocol):
    """Makes one level; its methods that take time are generators of `Progress`."""

    plan: Plan
    fine: Mesh
    clearances: tuple[float, ...]
    settings: Choices
    progress: LevelProgress

    def build(self, wanted: int | Mesh) -> Stage[Progress, Level]:
        """The level. Raises NestedCagesError."""
        ...


class GridLevelBuilder:
    """Makes levels with another builder and puts their cages on the grid."""

    def __init__(
        self,
        builder: Builder,
        with_clearances: Callable[[tuple[float, ...]], Builder],
        grid: Grid,
        *,
        convex: bool,
    ) -> None:
        """with_clearances: the same builder for other clearances; convex: whether cages stay convex."""
        self.builder, self.with_clearances = builder, with_clearances
        self.grid, self.convex, self.plan = grid, convex, builder.plan
        self.fine, self.clearances = builder.fine, builder.clearances
        self.settings, self.progress = builder.settings, builder.progress

    def build(self, wanted: int | Mesh) -> Stage[Progress, Level]:
        """The level. Raises NestedCagesError; a NestingError where no cage on the grid is found.

        Where a cage does not fit on the grid, first the cage, then the whole level is made with more clearance.
        """
        if not self.grid.resolves(self.fine.vertices):
            raise NestingError(
                f"The grid of {self.grid.spacing:.6g} is finer than floating-point numbers are at these coordinates; "
                "ask for a coarser one, or move the shape closer to the origin.",
                code="numbers.unresolved",
                spacing=self.grid.spacing,
            )
        level = yield from self.builder.build(wanted)
        found = yield from self.on_grid(level)
        if found is not None:
            return found
        clearance, more = level.report.wanted_clearance, GRID_ROOM * self.grid.spacing
        try:
            roomy = yield from self.with_clearances((clearance + more,)).build(wanted)
        except NestingError as error:
            logger.debug("no level with room for the grid: %s", error)
        else:
            roomy = replace(roomy, report=replace(roomy.report, wanted_clearance=clearance))
            found = yield from self.on_grid(roomy)
            if found is not None:
                return found
        remedy, works = "ask for a finer one", None
        for part in FINER:
            finer = Grid(float(self.grid.ratio * Fraction(part)))
            if (yield from self._moved(level, finer)) is not None:
                remedy, works = f"a grid of {finer.spacing:.6g} works", finer.spacing
                break
        raise NestingError(
            f"No cage with {len(level.cage.vertices)} vertices on the grid of {self.grid.spacing:.6g} was found that "
            f"keeps the clearance of {clearance:.6g}; {remedy}.",
            code="numbers.no_room",
            spacing=self.grid.spacing,
            finer=works,
            count=len(level.cage.vertices),
            clearance=clearance,
        )

    def on_grid(self, level: Level) -> Stage[Progress, Level | None]:
        """The level with its cage on the grid, certified; None if there is none."""
        yield from self.progress.begin("verification")
        found = yield from self._moved(level, self.grid)
        if found is None:
            found = yield from self._moved(_widened(level, GRID_ROOM * self.grid.spacing, self.settings), self.grid)
        if found is None:
            return None
        self.progress.stop_clock()
        notes = self._noted(level, found)
        return replace(found, report=replace(found.report, notes=notes, seconds=dict(self.progress.seconds)))

    def _noted(self, level: Level, found: Level) -> tuple[Fault, ...]:
        """The notes of the level on the grid, with what its cage misses instead of what the one before missed."""
        clearance = level.report.wanted_clearance
        before, after = (self.plan.notes(each.cage, clearance) for each in (level, found))
        return (*(note for note in found.report.notes if note not in before), *after)

    def _moved(self, level: Level, grid: Grid) -> Stage[Progress, Level | None]:
        """The level with its cage on a grid, certified; None if there is none."""
        rounding = SolverUnits.of(level.fine)
        search = put_on_grid(
            level.cage,
            level.fine,
            grid,
            clearance=rounding.clearance(level.report.wanted_clearance) * rounding.scale,
            inside=level.inside,
        )
        vertices = yield from self.progress.follow(search, lambda done: (done, "grid"))
        if vertices is None:
            return None
        cage = level.coarse.moved(vertices)
        if self.convex and not is_convex(cage):
            return (yield from self._moved(_without_dents(level, cage), grid))  # of fewer vertices
        outer, inner = (level.fine, cage) if level.inside else (cage, level.fine)
        same_loops = level.coarse.has_loops_like(level.fine)
        certificate = verify(outer, inner, level.report.wanted_clearance, same_loops=same_loops)
        path = _path(level, vertices, grid) if certificate else None
        if path is None:
            logger.debug("grid %g: %s", grid.spacing, certificate.problems or "no free way")
            return None
        report = replace(
            level.report,
            clearance=certificate.clearance,
            excess=cage.area / level.fine.area - 1.0,
            grid=grid.spacing,
        )
        return replace(level, cage=cage, reinflation=path, report=report)


def _without_dents(level: Level, cage: Mesh) -> Level:
    """The level with the convex hull of a cage, from where it does not move."""
    hull = without_dents(cage)
    count, most = len(cage.vertices), len(hull.vertices)
    said = f"On the grid, {count} vertices make no convex cage: it has {most} at most."
    flow = FlowResult(level.fine.vertices[None], 0, "inside")
    resting = Reinflation(level.fine.vertices[None], hull.vertices[None], 0)
    kept = [note for note in level.report.notes if note.data.get("on") != "grid"]
    report = replace(level.report, notes=(*kept, Fault(said, "note.count", asked=count, given=most, on="grid")))
    return replace(level, coarse=hull, cage=hull, flow=flow, reinflation=resting, report=report)


def _path(level: Level, vertices: FloatArray, grid: Grid) -> Reinflation | None:
    """The steps of the level, continued to vertices (m, 2) on a grid; None if that motion is not collision-free.

    Tried in turn: straight, with edges pushed away from the fine mesh half-way, and from an earlier step.
    """
    way, bodies = level.reinflation, Bodies.of(level.cage, level.fine)
    last = way.cage_steps[-1]
    walked = replace(bodies, cage_successor=level.cage.predecessor) if level.inside else bodies
    middle = 0.5 * (last + vertices)
    shift = np.ones(bodies.m) * grid.spacing
    ways = [[last, vertices]]
    ways += [[last, middle + shift_edges(walked, middle, push * shift), vertices] for push in PUSHES]
    for steps in ways:
        if certify_motion(bodies, steps, [level.fine.vertices] * len(steps)):
            return way.with_tightening(steps[1:])
    for number in range(len(way.cage_steps) - 2, way.tightening_start - 1, -1):
        if certify_motion(bodies, [way.cage_steps[number], vertices], [level.fine.vertices] * 2):
            steps = np.concatenate([way.cage_steps[: number + 1], vertices[None]])
            return Reinflation(way.moving_steps, steps, way.iterations)
    return None


def _widened(level: Level, more: float, settings: Choices) -> Level:
    """The level tightened at a larger clearance."""
    units = SolverUnits.of(level.fine)
    cage, fine = units.from_input(level.cage), units.from_input(level.fine)
    bodies, energy = Bodies.of(cage, fine), Area().at(cage)
    if level.inside:
        bodies = replace(bodies, cage_successor=cage.predecessor, fine_successor=fine.predecessor)
        energy = inwards(energy, fine.area)
    clearance = units.clearance(level.report.wanted_clearance + more)
    steps = list(settings.tightening.run(bodies, cage.vertices, fine.vertices, clearance=clearance, energy=energy))
    if not steps:
        return level
    wider = [units.to_input(step) for step in steps]
    return replace(level, cage=level.coarse.moved(wider[-1]), reinflation=level.reinflation.with_tightening(wider))
