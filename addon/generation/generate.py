"""From drawings to certified cages as Blender stores them. Does not touch the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..core import core, memory
from ..errors import UserError
from ..scene.convert import Drawing
from . import needs
from .advice import check_room, excess_note
from .job import Progress
from .levels import Level, Wanted, are_counts, wanted_levels
from .memory import known, remembered
from .methods import Methods
from .rules import Places, Rules
from .storage import CageLevel, stored

# Automatic clearances as fractions of the drawing's diagonal: the core's default, and one for drawings whose gaps are
# too narrow for it. Smaller ones are lost in float32.
AUTOMATIC_CLEARANCES = (1e-5, 1e-6)
# Largest relative error of a coordinate rounded to float32; of a point, sqrt(2) times that.
FLOAT32_ROUNDING = float(np.finfo(np.float32).eps) / 2.0
# Added to the wanted clearance, in roundings of the drawing's largest coordinate: twice the largest loss of one rounded
# mesh, as the cage is larger than the drawing.
MARGIN = 2.0 * np.sqrt(2.0)
# Multiples of this margin to try: rounding can also close gaps between parts of the cage.
MARGINS = (1.0, 64.0)
# How much stricter, in these margins, a distance or an excess is asked for with each of them.
SLACKS = (0.0, 64.0)

# Factors on the automatic clearance from one level to the one inside it, which may leave the next one no room between
# its loops.
ROOMS = (1.0, 10.0)

# Size in bytes of the advice on a level, for the memory.
ADVICE_BYTES = 1000

# Names of the core's stages for users.
STAGES = {
    "decimation": "making a coarse mesh",
    "flow": "shrinking",
    "reinflation": "growing back",
    "tightening": "tightening",
    "verification": "checking",
}


@dataclass(frozen=True)
class Options:
    """`levels`: vertex counts, shares of the drawing's vertices, distances and excesses, or `OWN`, finest first.
    `clearance`: a length of the scene, as distances are; if it is 0, a share of the drawing's diagonal; if both are,
    automatic. `inside`: whether cages lie inside the drawing. `shrink`: whether the drawing shrinks further in the
    animation than it has to. `rules`: what else cages must be.
    """

    levels: tuple[Level, ...] = ()
    clearance: float = 0.0
    clearance_share: float = 0.0
    inside: bool = False
    shrink: bool = False
    rules: Rules = field(default_factory=Rules)
    methods: Methods = field(default_factory=Methods)


@dataclass(frozen=True)
class Request:
    """A drawing, and the user's own coarse drawings for it, finest first: one for each `OWN` in `Options.levels`, or
    all levels if there is no `OWN`.
    """

    fine: Drawing
    coarse: tuple[Drawing, ...] = ()
    places: Places = field(default_factory=Places)


@dataclass(frozen=True)
class Result:
    """All levels around one drawing, or inside of it, what they are by the rules for them, and the settings that were
    used, by name; None if they are unknown.
    """

    drawing: Drawing
    levels: tuple[CageLevel, ...]
    kinds: tuple[str, ...] = ()
    used: dict[str, Any] | None = None

    @property
    def inside(self) -> bool:
        """Whether the cages lie inside the drawing."""
        return self.levels[0].inside


@dataclass(frozen=True)
class Plan:
    """What is to be made for a drawing; clearances, to be tried in turn, in its units."""

    request: Request
    fine: core.Mesh
    levels: tuple[Wanted, ...]
    settings: core.Settings
    clearances: tuple[float, ...]


class Generation:
    """Cages for several drawings as an iterator of `Progress`; ``results`` is complete when it ends. Dropping it
    cancels.

    Of several drawings, those that cannot be caged are skipped: ``problems`` says why. The constructor checks
    everything that needs no computation. Raises: UserError if no drawing is left.
    """

    def __init__(self, requests: Sequence[Request], options: Options) -> None:
        self.options = options
        options.methods.check()
        if options.inside and not are_counts(options.levels):
            raise UserError("Inner cages have vertex counts: leave distances and excesses out of the levels")
        if options.inside and options.rules.convex:
            raise UserError("Convex cages lie around a drawing: leave 'Inside' or 'Convex' off")
        self.results: list[Result] = []
        self.problems: list[UserError] = []
        self._plans: list[Plan] = []
        for request in requests:
            try:
                self._plans.append(self._plan(request))
            except UserError as error:
                self.problems.append(error)
        self._check_some(self._plans)

    def _plan(self, request: Request) -> Plan:
        """The plan for a drawing. Raises: UserError."""
        fine, options = request.fine.mesh(), self.options
        own = tuple(drawing.mesh() for drawing in request.coarse)
        if not own and not options.levels:
            raise UserError("Give a vertex count for at least one level, such as 64")
        scale, convex = request.fine.frame.scale, options.rules.convex
        merges = options.rules.merge > 0.0
        wanted = wanted_levels(options.levels, fine, own, request.fine.name, scale, convex=convex, merges=merges)
        settings = options.rules.settings(options.methods.settings(), fine, scale, request.places)
        plan = Plan(request, fine, wanted, settings, self._clearances(fine, scale))
        if (
            len(plan.clearances) == 1
            and not own
            and not options.inside
            and not (convex or merges)
            and options.methods.keeps_loops()
        ):
            check_room(fine, plan.clearances[0], len(wanted), request.fine)
        return plan

    def _check_some(self, found: Sequence[object]) -> None:
        """Raises: UserError, the first problem, if nothing is found."""
        if self.problems and not found:
            raise self.problems[0]

    def __iter__(self) -> Iterator[Progress]:
        total = sum(len(plan.levels) for plan in self._plans)
        done, reached = 0, 0.0
        for plan in self._plans:
            finished: list[CageLevel] = []
            try:
                for progress in self._levels(plan, finished):
                    # A level that starts over goes back; the displayed progress does not.
                    reached = max(reached, (done + progress.fraction) / total)
                    yield Progress(reached, progress.message)
            except UserError as error:
                self.problems.append(error)
                done += len(plan.levels)
                continue
            done += len(plan.levels)
            reached = done / total
            kinds = tuple(self.options.rules.kinds(plan.request.places))
            self.results.append(Result(plan.request.fine, tuple(finished), kinds))
        self._check_some(self.results)

    def _levels(self, plan: Plan, finished: list[CageLevel]) -> Iterator[Progress]:
        """Fills `finished`; the fraction of the progress is in levels. Raises: UserError."""
        for room in ROOMS:
            finished.clear()
            try:
                yield from self._levels_with(plan, finished, room)
                return
            except _NoRoomError:
                if not finished or len(plan.clearances) == 1 or room == ROOMS[-1]:
                    raise

    def _levels_with(self, plan: Plan, finished: list[CageLevel], room: float) -> Iterator[Progress]:
        """The same, with a factor on the clearance from one level to the one inside it."""
        inner, given = plan.fine, plan.clearances
        for number, wanted in enumerate(plan.levels, 1):
            name = f"{plan.request.fine.name}, level {number}"
            yield Progress(number - 1.0, name)  # shown before anything is computed
            plan = replace(plan, clearances=tuple(room ** (len(plan.levels) - number) * each for each in given))
            for step in self._known_or_made(plan, name, inner, wanted.level):
                if isinstance(step, CageLevel):
                    cage = step.mesh
                    advice = () if step.inside or plan.settings.convex else _advice(plan, cage, wanted.level)
                    told = [core.Fault(text, "note.text") for text in (*plan.request.places.notes, *wanted.notes)]
                    notes = (*told, *step.report.notes, *(core.Fault(text, "note.text") for text in advice))
                    finished.append(replace(step, report=replace(step.report, notes=tuple(dict.fromkeys(notes)))))
                    inner = cage
                else:
                    yield Progress(number - 1.0 + step.fraction, f"{name}: {STAGES[step.stage]}")
            yield Progress(float(number), name)

    def _clearances(self, fine: core.Mesh, scale: float) -> tuple[float, ...]:
        """The wanted clearance in the drawing's units, or the automatic ones to try in turn."""
        if self.options.clearance > 0.0:
            return (self.options.clearance / scale,)
        share = self.options.clearance_share
        return tuple(part * fine.diagonal for part in ((share,) if share > 0.0 else AUTOMATIC_CLEARANCES))

    def _shrinks(self, plan: Plan, fine: core.Mesh) -> bool:
        """Whether a mesh shrinks further than it has to; not a cage, which would cross the drawing in it."""
        return self.options.shrink and fine is plan.fine

    def _known_or_made(
        self, plan: Plan, name: str, fine: core.Mesh, wanted: int | core.Mesh | core.Within
    ) -> Iterator[core.Progress | CageLevel]:
        """As `_level`, but a level that is remembered is not made again."""
        options, places = self.options, plan.request.places
        about = plan.fine if isinstance(wanted, core.Within) or options.rules.kinds(places) else None
        key = memory.key_of(
            "level", fine, wanted, plan.clearances, options.methods, options.rules, options.inside,
            replace(places, notes=()), plan.request.fine.frame.scale, about, self._shrinks(plan, fine),
        )  # fmt: skip
        found = known().get(key)
        if found is not None:
            yield found
            return
        for step in self._level(plan, name, fine, wanted):
            if isinstance(step, CageLevel):
                known().put(key, step, step.fine_steps.nbytes + step.cage_steps.nbytes)
            yield step

    def _level(
        self, plan: Plan, name: str, fine: core.Mesh, wanted: int | core.Mesh | core.Within
    ) -> Iterator[core.Progress | CageLevel]:
        """Yields the core's progress of one level, and returns its `CageLevel`. Raises: UserError."""
        problem, kind = "", UserError
        margin = MARGIN * FLOAT32_ROUNDING * float(np.abs(fine.vertices).max())
        cages_run = core.InnerCagesRun if self.options.inside else core.NestedCagesRun
        for clearance in plan.clearances:
            for margins, slack in zip(MARGINS, SLACKS, strict=True):
                asked = replace(plan.settings, clearance=clearance + margins * margin)
                level = core.hierarchy.Rising(wanted) if isinstance(wanted, int) else wanted
                run = cages_run(fine, [needs.stricter(level, plan.fine, slack * margin)], asked)
                try:
                    yield from run
                    made = run.hierarchy.levels[0]
                    found = stored(fine, made, clearance, shrink=self._shrinks(plan, fine))
                except core.NestedCagesError as error:
                    problem = problem or str(error)
                    kind = _NoRoomError if error.code == "clearance.no_room" else UserError
                    break
                finally:
                    run.close()
                missed = needs.missed(wanted, plan.fine, found)
                if found.certificate.holds and not missed:
                    yield needs.told(found, wanted, plan.fine, clearance, plan.request.fine.frame.scale)
                    return
                problem = missed or (
                    "the cage does not hold in Blender's single precision "
                    f"({'; '.join(found.certificate.problems)}); move the drawing closer to its object's origin, or "
                    "ask for more clearance"
                )
        raise kind(f"'{name}': {problem}")


class _NoRoomError(UserError):
    """A clearance that the gaps in what is to be enclosed have no room for."""


def _advice(plan: Plan, cage: core.Mesh, wanted: int | core.Mesh | core.Within) -> tuple[str, ...]:
    """Why a cage is loose; empty if it is not."""
    clearance = plan.clearances[0]
    return remembered(
        lambda: excess_note(plan.fine, cage, wanted, clearance),
        ADVICE_BYTES,
        "advice",
        plan.fine,
        cage,
        wanted,
        clearance,
    )
