"""One level: decimation, flow, reinflation, tightening, verification."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation, reinflate
from ..decimation import Count, Start, Starts
from ..decimation.base import in_words
from ..decimation.given_mesh import GivenStart
from ..decimation.offset import is_wide
from ..decimation.problem import shared_anew
from ..decimation.starts import AlongSequence, lacks_shapely
from ..energies import signed_area
from ..errors import Fault, FlowError, InvalidMeshError, NestedCagesError, NestingError, ReinflationError, note
from ..flow import FlowResult
from ..geometry.arrays import TINY, FloatArray
from ..geometry.mesh import Mesh, Nesting
from ..geometry.thinning import Thinning
from .assembly import Assembly, CageInProgress, deviations
from .attempts import PAPER_PREFERENCE, Attempt, attempts, in_turn, methods_for
from .gate import judged
from .plan import Plan
from .report import Level, LevelProgress
from .settings import LevelSettings
from .units import SolverUnits

if TYPE_CHECKING:
    from .settling import Settling

logger = logging.getLogger(__name__)

FAILURES = (FlowError, ReinflationError, NestingError)
"""Errors after which the next attempt is made; any other error ends the run."""

MIN_POINTS, POINTS_PER_VERTEX, MANY = 1000, 30, 3
"""Vertices of the mesh that tightening begins with: at least, and per vertex of the cage; how many times as many a mesh
has for which there is one."""

MISSED = 1e6
"""Added to the rank of cages that miss a constraint, more than any excess: others are tried, and are better."""


FEWER = (3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 36, 40, 48, 56, 64, 80, 96, 128, 192, 256, 384, 512)
"""Numbers of vertices that are tried below the wanted one on a grid, where a vertex too many is moved outwards."""

CLEARLY_FEWER, STRIDE, TRIES_WITH_FEWER, NEAR = 0.8, 3, 3, 1.2
"""Up to which part of the number of vertices, and every which of these, is tried; how many of them may be no better;
excess of the best of them, relative to the least one, up to which those next to it are tried too."""

FURTHER_ON_GRID = 2
"""Further starts along the sequence that are tried where they may be tighter on a grid."""

LOOSE_ON_GRID = 0.1
"""Part of the excess that a grid may add before fewer vertices are tried."""


class LevelBuilder:
    """Makes one level of a plan.

    The unbounded region around a cage inside serves as its solid. Walked backwards, its loops are the oriented boundary
    of that region, so start and solvers push it away from the fine mesh as they do with a cage outside.
    """

    def __init__(
        self, plan: Plan, clearances: tuple[float, ...], settings: LevelSettings, progress: LevelProgress
    ) -> None:
        self.plan, self.clearances, self.progress = plan, clearances, progress
        self.settings = settings = methods_for(settings, plan)
        self.fine, self.outline = plan.fine, plan.outline.mesh
        self.units = SolverUnits.of(self.fine, 0.0 if plan.numbers is None else plan.numbers.room)
        self.unit_fine = self.units.from_input(self.fine)
        self.assembly = Assembly(plan, progress, self.units)
        self.settling: Settling | None = None
        if plan.numbers is not None:
            from .settling import Settling

            self.settling = Settling(plan, settings, progress)
        self.start: Start | None = None
        """The start of the last attempt, if it had one."""
        self.rivals: tuple[Start, ...] = ()
        """Starts about as good as that."""
        self.others: Iterator[Start] = iter(())
        """Further starts along the sequence of outlines."""
        self.attempt: Attempt | None = None
        self.cages: list[CageInProgress] = []
        """The tight cages of it."""
        self.at_work: tuple[CageInProgress, list[FloatArray]] | None = None
        """The cage that is tightened, and the steps so far."""
        self.best: Level | None = None

    def build(self, wanted: int | Mesh) -> Level:
        """The level for a vertex count or the user's own coarse mesh. Raises NestedCagesError."""
        level = self._on_numbers(wanted)
        inner = self.plan.outline.inner
        return level if inner is None else self.assembly.around(inner, level)

    def _on_numbers(self, wanted: int | Mesh) -> Level:
        """The level on the numbers of the plan, around what is solved for: of the first shape of the loop sequence
        around which there is one."""
        errors: list[NestedCagesError] = []
        unsettled: list[Level] = []
        try:
            found = self._settled(wanted, unsettled)
            if found is not None:
                return self._least(found, self._rivals(found))
        except FAILURES as error:
            errors.append(error)
        for start in self.others:
            found = self._settled_from(start, unsettled)
            if found is not None:
                return found
        if unsettled and self.settling is not None:
            raise self.settling.failure(unsettled[0])
        raise errors[0]

    @property
    def _seeks_area(self) -> bool:
        """Whether the cage of least area is sought."""
        return bool(getattr(self.settings.energy, "is_area", False)) and self.plan.importance is None

    def _rivals(self, level: Level) -> Iterator[Start]:
        """Rivals of the first start and, on a grid, further ones along the sequence that may be tighter there."""
        yield from self.rivals
        is_on_grid = self.settling is not None and self.settling.numbers.grid is not None
        for start in islice(self.others, FURTHER_ON_GRID if is_on_grid and self._seeks_area else 0):
            if (1.0 + LOOSE_ON_GRID) * (start.coarse.area / self.outline.area - 1.0) >= level.excess:
                break
            if all(start.coarse is not rival.coarse for rival in self.rivals):
                yield start

    def _least(self, level: Level, rivals: Iterable[Start]) -> Level:
        """The level of least excess: one, or one from a rival of its start."""
        for rival in rivals:
            other = self._settled_from(rival, [])
            level = level if other is None else min(level, other, key=lambda each: each.excess)
        return level

    def _settled_from(self, start: Start, unsettled: list[Level]) -> Level | None:
        """The level from a further start; None if there is none."""
        chosen, self.settings = self.settings, replace(self.settings, decimation=GivenStart(start), fallback=None)
        try:
            return self._settled(len(start.coarse.vertices), unsettled)
        except FAILURES as error:
            logger.debug("no level from %s: %s", start.source, error)
            return None
        finally:
            self.settings = chosen

    def _settled(self, wanted: int | Mesh, unsettled: list[Level]) -> Level | None:
        """The level on the numbers of the plan; None where it has no place on them, which is then remembered."""
        level = self._solved(wanted, self.clearances)
        if self.settling is None:
            return level
        further = self.rivals, self.others
        best = self._with_room(wanted, level)
        if best is None:
            unsettled.append(level)
        if isinstance(wanted, int) and self.settling.numbers.grid is not None and not self._goes_on:
            best = self._with_fewer(min(wanted, len(level.cage.vertices)), best, level.excess)
        self.rivals, self.others = further
        return best

    def _with_fewer(self, number: int, best: Level | None, off_grid: float) -> Level | None:
        """A level on the grid, or a tighter one of fewer vertices.

        off_grid: excess of a cage on any numbers. With ever fewer vertices, the excess on a grid falls, then rises.
        """
        fewer = [each for each in FEWER if each < number]
        near, tries = dict[int, float](), TRIES_WITH_FEWER
        first = sum(each <= CLEARLY_FEWER * number for each in fewer) - 1
        for k in range(first, -1, -STRIDE):
            if tries == 0 or (best is not None and best.excess <= (1.0 + LOOSE_ON_GRID) * off_grid):
                return best
            found, least = self._on_grid(fewer[k], best)
            if found is not None:
                near[k] = found.excess
                tries -= best is not None and found.excess >= best.excess
                best = min(found, best or found, key=lambda each: each.excess)
            elif best is not None and least >= best.excess:
                break
        if best is None or not near or min(near.values()) > NEAR * best.excess:
            return best
        k = min(near, key=lambda k: near[k])
        below = fewer[max(0, k - STRIDE + 1) : k] if near[k] <= best.excess else []
        for number in (*below, *fewer[k + 1 : k + STRIDE]):
            found, _ = self._on_grid(number, best)
            best = min(found or best, best, key=lambda each: each.excess)
        return best

    def _on_grid(self, number: int, best: Level | None) -> tuple[Level | None, float]:
        """A level of a number of vertices on the grid, if it may be tighter than the best one; and the excess of one on
        any numbers."""
        assert self.settling is not None
        try:
            level = self._solved(number, self.clearances)
        except FAILURES:
            return None, np.inf
        if best is None:
            return self._with_room(number, level), level.excess
        return None if level.excess >= best.excess else self.settling.settled(level), level.excess

    def _with_room(self, wanted: int | Mesh, level: Level) -> Level | None:
        """A level on the numbers, or one that was made with room for them; None if there is none."""
        assert self.settling is not None
        found = self.settling.settled(level)
        if found is not None:
            return found
        clearance = level.report.wanted_clearance
        for room in self.settling.rooms:
            try:
                roomy = self._solved(wanted, (clearance + room,))
            except NestingError as error:
                logger.debug("no level with room to settle: %s", error)
                break
            roomy = replace(roomy, report=replace(roomy.report, wanted_clearance=clearance))
            found = self.settling.settled(roomy)
            if found is not None:
                return found
        return None

    def _solved(self, wanted: int | Mesh, clearances: tuple[float, ...]) -> Level:
        """The level on any numbers, of the first attempt that succeeds. Raises the error of line cycles that led
        nowhere, since others need as many vertices, or of the last attempt."""
        started: list[NestedCagesError] = []
        failures: list[NestedCagesError] = []
        clamping = self.plan.outline.notes
        source: Count | Mesh = wanted
        if not isinstance(wanted, Mesh):
            source, replaced = self.plan.possible(wanted, unlimited=self._may_have_more(wanted, clearances[0]))
            clamping += replaced
            along = isinstance(self.settings.decimation, AlongSequence)
            if along and lacks_shapely(self.outline, wanted, clearances[0]):
                clamping += (note("note.library", library="shapely"),)
        notes = clamping
        for attempt in attempts(self.settings, self.outline, source, clearances, self.plan.side):
            try:
                self.start = None
                start = self.start = self.plan.started(self._coarse_mesh(attempt))
                notes = clamping
                if attempt.fallback:
                    reason = note("note.start", on="fallback", source=start.source, text=str(failures[0]))
                    notes = (*notes, reason, *shared_anew(attempt.count, start.coarse))
                level = self._tightest(attempt, start, notes)
                again = attempt.again(level.report.excess)
                return level if again is None else self._tighter(level, again, start, notes)
            except FAILURES as error:
                logger.debug("attempt from %s failed: %s", attempt.source, error)
                failures.append(error)
                started += [error] if self.start is not None and hasattr(attempt.source, "outside") else []
        may_stand = self.start is not None and (attempt.may_fall_back or self.start.on_curve is None)
        if self.start is not None and may_stand and not isinstance(attempt.source, Mesh):
            standing = self.assembly.untightened(self.start, clearances, notes)
            if standing is not None:
                return standing
        if started or isinstance(attempt.source, Mesh) or not self.plan.is_free:
            raise (started or failures)[-1]
        from .counts import with_least  # for the message

        raise with_least(failures[-1], attempt.source, self.outline, clearances, self.plan.side)

    @property
    def _goes_on(self) -> bool:
        """Whether this goes on from a further start, whatever the number of vertices."""
        return isinstance(self.settings.decimation, GivenStart)

    def _may_have_more(self, wanted: int, clearance: float) -> bool:
        """Whether a cage may have more vertices than the outline: around the rounded offset."""
        along = isinstance(self.settings.decimation, AlongSequence)
        return self._goes_on or (along and is_wide(self.outline, wanted, clearance))

    def _tighter(self, level: Level, again: Attempt, start: Start, notes: tuple[Fault, ...]) -> Level:
        """A level, or that of another attempt where it has less excess."""
        try:
            other = self._tightest(again, start, notes)
        except FAILURES as error:
            logger.debug("no other cage to compare: %s", error)
            return level
        return min(level, other, key=lambda each: each.report.excess)

    def _tightest(self, attempt: Attempt, first: Start, notes: tuple[Fault, ...]) -> Level:
        """The tightest cage from a start, or from its mesh on the curve, that can be certified."""
        errors: list[NestedCagesError] = []
        cages = self.cages = list[CageInProgress]()
        self.attempt, self.at_work = attempt, None
        turn = in_turn(first, self.outline, attempt)
        start: Start | None = next(turn)
        tried: list[str] = []
        while start is not None:
            tried.append(start.source)
            self.progress.next_start()
            rank = np.inf
            try:
                cage = self._reinflated(attempt, start)
                cage = self._tightened(cage, attempt.clearances[0])
                cages.append(cage)
                rank = cage.rank
            except FAILURES as error:
                logger.debug("start from %s failed: %s", start.source, error)
                errors.append(error)
            logger.debug("start %s, %s: ranked %.9g", self.progress.starts, start.source, rank)
            try:
                start = turn.send(rank)
            except StopIteration:
                start = None
        refused: list[NestedCagesError] = []
        for cage in sorted(cages, key=lambda cage: cage.rank):
            source = cage.start.source
            if errors and source != tried[0]:
                on = "flow" if isinstance(errors[0], FlowError) else "reinflation"
                notes = (*notes, note("note.start", on=on, source=source, first=tried[0]))
            try:
                return self.certified(attempt, cage, notes)
            except NestingError as error:
                refused.append(error)
        raise (refused or errors)[0]

    def _coarse_mesh(self, attempt: Attempt) -> Start:
        """The coarse mesh of an attempt. Raises NestingError."""
        source = attempt.source
        if isinstance(source, Mesh):
            if self.plan.side < 0 and not self.plan.verify(source, 0.0):
                raise NestingError(
                    "The coarse mesh does not lie strictly inside the fine one, loop by loop; move it inside, or give "
                    "a vertex count.",
                    code="coarse.not_nested",
                )
            return Start(source, "coarse mesh")
        self.progress.begin("decimation")
        clearance = attempt.clearances[0]
        if isinstance(source, Starts):
            tick = self.progress.tick("decimation")
            starts = source.starts(self.outline, attempt.count, clearance=clearance, kept=self.plan.kept(), tick=tick)
            first = next(starts, None)
            if first is None:
                raise NestingError("The decimation has no coarse mesh.", code="count.too_small")
            if attempt.may_fall_back:
                self.others = starts
                if self._seeks_area:
                    self.rivals = first.rivals
            return first
        return Start(source.decimate(self.outline, attempt.count, clearance=clearance), in_words(source))

    def _reinflated(self, attempt: Attempt, start: Start) -> CageInProgress:
        """Flow and reinflation from a coarse mesh."""
        unit_coarse = self.units.from_input(start.coarse)
        if self.plan.side < 0 or self.plan.outline.inner is not None:  # both rest: nothing flows
            flow = FlowResult(self.unit_fine.vertices[None], 0, "inside")
            resting = Reinflation(self.unit_fine.vertices[None], unit_coarse.vertices[None], 0)
            return self._bound(CageInProgress(start, unit_coarse, flow, resting))
        self.progress.begin("flow")
        try:
            if self.outline is not self.fine and Nesting(start.coarse, self.fine).encloses():
                # the images may have loops of their own, which the flow does not know
                flow = FlowResult(self.unit_fine.vertices[None], 0, "inside")
            else:
                method = self.units.method(attempt.flow)
                flow = method.run(self.unit_fine, unit_coarse, tick=self.progress.tick("flow"))
        except FlowError as error:
            partial = error.partial
            if isinstance(partial, FlowResult) and partial.obstacle is not None:
                x, y = self.units.centre
                raise FlowError(partial.obstacle.fault(self.units.scale, (float(x), float(y)))) from error
            raise
        self.progress.begin("reinflation")
        reinflation = reinflate(
            self.unit_fine,
            unit_coarse,
            flow.steps,
            contacts=[self.units.method(contact) for contact in attempt.contacts],
            clearance=self.units.clearance(attempt.clearances[0]),
            bounds=self.plan.bounds(unit_coarse, self.units),
            tick=self.progress.tick("reinflation"),
        )
        return self._bound(CageInProgress(start, unit_coarse, flow, reinflation))

    def _bound(self, cage: CageInProgress) -> CageInProgress:
        """The cage with its energy."""
        energy = self.settings.energy.at(cage.unit_coarse)
        energy, is_measure = self.plan.energy(energy, cage.unit_coarse, self.units)
        return replace(cage, energy=energy, is_measure=is_measure)

    def _tightened(self, cage: CageInProgress, clearance: float) -> CageInProgress:
        """The cage tightened at a clearance in the input's units."""
        self.progress.begin("tightening")
        start = cage.untightened.cage_steps[-1]
        assert cage.energy is not None
        steps: list[FloatArray] = []
        bounds, wide = self.plan.bounds(cage.unit_coarse, self.units), self.plan.clearances(self.units)
        self.at_work = cage, steps
        counts = {"tightening": 0, "quadratic programs": 0}

        def on_step(vertices: FloatArray) -> None:
            steps.append(vertices)
            self.progress.show(1.0 - 1.0 / (1.0 + 0.1 * len(steps)), f"tightening, step {len(steps)}")

        for fine, away in self._coarse_to_fine(cage.unit_coarse):
            outcome = self.settings.tightening.run(
                Bodies.of(cage.unit_coarse, fine, side=self.plan.side, bounds=bounds, clearances=wide),
                steps[-1] if steps else start,
                fine.vertices,
                clearance=self.units.clearance(clearance) + away,
                energy=cage.energy,
                on_step=on_step,
            )
            counts["tightening"] += outcome.iterations
            counts["quadratic programs"] += outcome.quadratic_programs
        last = steps[-1] if steps else start
        return replace(
            cage,
            tightened=cage.untightened.with_tightening(steps),
            rank=self._rank(cage, last) + MISSED * any(bound.short(last).any() for bound in bounds),
            counts=counts,
        )

    def _coarse_to_fine(self, cage: Mesh) -> Iterator[tuple[Mesh, float]]:
        """Meshes to tighten around in turn, and how far from each: of a large one first one with fewer vertices."""
        fine, points = self.unit_fine, MIN_POINTS + POINTS_PER_VERTEX * len(cage.vertices)
        if self.plan.is_free and self.plan.side > 0 and len(fine.vertices) > MANY * points:
            thinning = Thinning(fine)
            tolerance = thinning.tolerance(points)
            with suppress(InvalidMeshError):
                yield thinning.mesh(tolerance), tolerance
        yield fine, 0.0

    def _rank(self, cage: CageInProgress, vertices: FloatArray) -> float:
        """The excess of a cage, lost area if inside, or the energy with further terms: smaller is better."""
        successor, area = cage.unit_coarse.successor, max(self.unit_fine.area, TINY)  # of slivers it may round to 0
        if cage.is_measure and cage.energy is not None:
            return cage.energy.after(vertices).value(vertices, successor) / area
        excess = self.plan.side * (signed_area(vertices, successor) / area - 1.0)
        return excess if self.plan.side < 0 or len(cage.flow.steps) > 1 else (1.0 + PAPER_PREFERENCE) * excess

    def certified(self, attempt: Attempt, cage: CageInProgress, notes: tuple[Fault, ...]) -> Level:
        """The level of a cage, at the largest clearance of the attempt that can be certified."""
        wanted = attempt.clearances[0]
        for clearance in attempt.clearances:
            if clearance < wanted:
                cage = self._tightened(cage, clearance)
            self.progress.begin("verification")
            way = self.assembly.in_input_units(cage)
            result = judged(self.plan, way.cage, clearance, promised=self.assembly.is_final)
            if not result.is_only_too_close:
                break
        if not result:
            from .failures import failed

            raise NestingError(failed(result, self.plan, wanted))
        notes = (*notes, *deviations(self.plan, result, clearance, wanted))
        if len(way.reinflation.cage_steps) == 1 and not getattr(self.settings.energy, "is_area", False):
            notes = (*notes, note("note.energy", energy=type(self.settings.energy).__name__))
        start = "flow" if len(way.flow.steps) > 1 else cage.start.source
        counts = {"flow": way.flow.iterations, "reinflation": way.reinflation.iterations, **cage.counts}
        return self.assembly.level(result, way, start, counts, notes)
