"""From drawings to certified cages as Blender stores them, and advice on clearances. Does not touch the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ..blender.jobs import Progress, Work
from ..core import core, steps
from ..drawing.planar import Drawing
from ..errors import UserError
from ..memory import key_of, known, remember, remembered
from ..messages import BROKEN
from .levels import Wanted, are_counts, wanted_levels
from .options import KEEP, Options, Places

# Size in bytes of a bound, for the memory.
BOUND_BYTES = 1000


def check_room(fine: core.Mesh, clearance: float, levels: int, drawing: Drawing) -> None:
    """Raises: UserError if holes or gaps are too narrow for the cages at a clearance, in the drawing's units.

    Each level keeps its own clearance, so the last one is as many clearances away from the drawing.
    """
    (bound,) = remembered(lambda: (core.levels.tightest_place(fine),), BOUND_BYTES, "tightest place", fine)
    if bound is None or bound.clearance > levels * clearance:
        return
    scale, most, where = drawing.frame.scale, bound.clearance / levels, bound.message(clearance)
    place = "in a hole" if len(set(where.data.get("loops", ()))) < 2 else "between two outlines"
    several = f" on {levels} levels" if levels > 1 else ""
    raise UserError(
        f"'{drawing.name}': No cage keeps a clearance of {clearance * scale:.6g}{several} {place}: ask for less than "
        f"{most * scale:.6g}, or {bound.remedy}.",
        drawing.fault(where),
    )


def clearance_to_curve(asked: float | None, fine: core.Mesh, deviation: float) -> float | None:
    """The clearance to a drawing by which the clearance that was asked for, or the default, holds to its true curve."""
    if deviation > 0.0:
        return (core.levels.DEFAULT_CLEARANCE * fine.diagonal if asked is None else asked) + deviation
    return asked


# What Blender stores coordinates in; cages and their motion are certified on these numbers.
STORED = "float32"

# Names of the core's stages for users.
STAGES = {
    "decimation": "making a coarse mesh",
    "flow": "shrinking",
    "reinflation": "growing back",
    "tightening": "tightening",
    "verification": "checking",
}


@dataclass(frozen=True)
class Request:
    """A drawing, and the user's own coarse ones, finest first: one for each `OWN` in the levels, or for all levels."""

    fine: Drawing
    coarse: tuple[Drawing, ...] = ()
    places: Places = field(default_factory=Places)


@dataclass(frozen=True)
class Result:
    """All levels of one drawing, what they are by its rules, and the settings used, by name; None if unknown."""

    drawing: Drawing
    levels: tuple[core.Level, ...]
    kinds: tuple[str, ...] = ()
    used: dict[str, Any] | None = None

    @property
    def inside(self) -> bool:
        """Whether the cages lie inside the drawing."""
        return self.levels[0].inside


@dataclass(frozen=True)
class Plan:
    """What is to be made for a drawing, in its units."""

    request: Request
    fine: core.Mesh
    levels: Sequence[Wanted]
    settings: core.Settings


class Generation:
    """Cages for several drawings as an iterator of `Progress`; ``results`` is complete when it ends. Dropping it
    cancels.

    Of several drawings, those that cannot be caged are skipped: ``problems`` says why. The constructor checks
    everything that needs no computation. Raises: UserError if no drawing is left.
    """

    def __init__(self, requests: Sequence[Request], options: Options) -> None:
        self.options = options
        if options.inside and not are_counts(options.levels):
            raise UserError("Inner cages have vertex counts: leave distances and areas such as +25% out of 'Cages'")
        self.results: list[Result] = []
        self.problems: list[UserError] = []
        self._plans: list[Plan] = []
        for request in requests:
            try:
                self._plans.append(self._plan(request))
            except UserError as error:
                self.problems.append(error)
        if self.problems and not self._plans:
            raise self.problems[0]

    def _plan(self, request: Request) -> Plan:
        """The plan for a drawing. Raises: UserError."""
        fine, options = request.fine.mesh(), self.options
        own = tuple(drawing.mesh() for drawing in request.coarse)
        if not own and not options.levels:
            raise UserError("Enter a number of vertices in 'Cages', such as 64")
        scale, convex = request.fine.frame.scale, options.convex
        keeps = options.inside or options.loops == KEEP
        wanted = wanted_levels(options.levels, fine, own, request.fine.name, scale, convex=convex, keeps=keeps)
        try:
            settings = options.settings(fine, scale, request.places)
        except core.NestedCagesError as error:
            raise UserError(self._said(error, request)) from error
        asked = options.clearance / scale or options.clearance_share * fine.diagonal or None
        clearance = clearance_to_curve(asked, fine, request.fine.deviation)
        plan = Plan(request, fine, wanted, replace(settings, clearance=clearance, stored=STORED))
        if clearance is not None and keeps and not (convex or own or options.inside):
            check_room(fine, clearance, len(wanted), request.fine)
        return plan

    def _said(self, error: core.NestedCagesError, request: Request) -> str:
        """An error of the core in words of the panel."""
        options, kinds = self.options, self.options.kinds(request.places)
        others = {"inside": options.inside, "as published": options.as_published}
        others["evenly resampled"] = options.decimation == "ARC_LENGTH"
        kinds += [name for name, holds in others.items() if holds]
        if error.code in ("setting.conflict", "convex.impossible") and len(kinds) > 1:
            return f"Cages cannot be {', '.join(kinds[:-1])} and {kinds[-1]} at once: leave one of these out"
        return BROKEN.get(error.code, str(error))

    def __iter__(self) -> Work[None]:
        total = sum(len(plan.levels) for plan in self._plans)
        done, reached = 0, 0.0
        for plan in self._plans:
            finished: list[core.Level] = []
            try:
                for progress in self._levels(plan, finished):
                    # A level that starts over goes back; the displayed progress does not.
                    reached = max(reached, (done + len(plan.levels) * progress.fraction) / total)
                    yield Progress(reached, progress.message)
            except UserError as error:
                self.problems.append(error)
            else:
                kinds = tuple(self.options.kinds(plan.request.places))
                self.results.append(Result(plan.request.fine, tuple(finished), kinds))
            done += len(plan.levels)
        if self.problems and not self.results:
            raise self.problems[0]

    def _levels(self, plan: Plan, finished: list[core.Level]) -> Iterator[Progress]:
        """Fills `finished`. Raises: UserError."""
        options, name = self.options, plan.request.fine.name
        yield Progress(0.0, f"{name}, cage 1")  # shown before anything is computed
        key = key_of("levels", plan.fine, *plan.levels, plan.settings, options.inside, options.show_flow)
        levels = known(key)
        if levels is None:
            run = (core.InnerCagesRun if options.inside else core.NestedCagesRun)(plan.fine, plan.levels, plan.settings)
            try:
                for step in run:
                    yield Progress(step.fraction, f"{name}, cage {step.level + 1}: {STAGES[step.stage]}")
            except core.NestedCagesError as error:
                number = 1 + (len(error.partial) if error.partial is not None else 0)
                said = self._said(error, plan.request)
                raise UserError(f"'{name}', cage {number}: {said}", plan.request.fine.fault(error.fault)) from error
            finally:
                run.close()
            levels = list(run.hierarchy)
            if options.show_flow:  # not a cage, which would cross the drawing in it
                levels[0] = steps.shrunk(levels[0])
            moved = [
                (level.flow.steps, level.reinflation.moving_steps, level.reinflation.cage_steps) for level in levels
            ]
            remember(key, levels, sum(each.nbytes for motion in moved for each in motion))
        for level in levels:
            notes = (*plan.request.places.notes, *level.report.notes)
            finished.append(replace(level, report=replace(level.report, notes=tuple(dict.fromkeys(notes)))))
        yield Progress(1.0, f"{name}, cage {len(levels)}")
