"""From drawings to certified cages as Blender stores them. Does not touch the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..core import core
from ..errors import UserError
from ..scene.convert import Drawing
from . import needs
from .advice import check_room, excess_note, smallest_found
from .job import Progress
from .levels import Level, Wanted, are_counts, wanted_levels
from .memory import Memory, key_of
from .methods import Methods

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

# Names of the core's stages for users.
STAGES = {
    "decimation": "making a coarse mesh",
    "flow": "shrinking",
    "reinflation": "growing back",
    "tightening": "tightening",
    "verification": "checking",
}
Steps = NDArray[np.float32]


@dataclass(frozen=True)
class Options:
    """`levels`: vertex counts, shares of the drawing's vertices, distances and excesses, or `OWN`, finest first.
    `clearance`: a length of the scene, as distances are; 0 = automatic. `inside`: whether cages lie inside the drawing.
    """

    levels: tuple[Level, ...] = ()
    clearance: float = 0.0
    inside: bool = False
    methods: Methods = field(default_factory=Methods)


@dataclass(frozen=True)
class Request:
    """A drawing, and the user's own coarse drawings for it, finest first: one for each `OWN` in `Options.levels`, or
    all levels if there is no `OWN`.
    """

    fine: Drawing
    coarse: tuple[Drawing, ...] = ()


@dataclass(frozen=True)
class CageLevel:
    """One level as Blender stores it: `fine_steps` (S, n, 2) and `cage_steps` (S, m, 2), float32, of flow (up to index
    `flow_end`), reinflation and tightening (from index `tightening`); the last ones are the result. `need`: a sentence
    on the distance or the excess that was asked for.
    """

    fine_edges: NDArray[np.int64]
    cage_edges: NDArray[np.int64]
    fine_steps: Steps
    cage_steps: Steps
    flow_end: int
    tightening: int
    certificate: core.Certificate
    report: core.NestingReport
    inside: bool = False
    need: str = ""

    @property
    def excess(self) -> float:
        """How much more area the cage has than what it is around or inside of, as a part of that; negative inside."""
        found = float(self.certificate.excess)  # inside, that of the drawing around the cage
        return 1.0 / (1.0 + found) - 1.0 if self.inside else found

    @property
    def cage(self) -> NDArray[np.float32]:
        """The cage's vertices (m, 2)."""
        vertices: NDArray[np.float32] = self.cage_steps[-1]
        return vertices

    @property
    def mesh(self) -> core.Mesh:
        """The cage as the core's ``Mesh``."""
        return core.Mesh(self.cage.astype(np.float64), self.cage_edges)

    @property
    def last(self) -> int:
        """Index of the last step."""
        return len(self.cage_steps) - 1


@dataclass(frozen=True)
class Result:
    """All levels around one drawing, or inside of it."""

    drawing: Drawing
    levels: tuple[CageLevel, ...]

    @property
    def inside(self) -> bool:
        """Whether the cages lie inside the drawing."""
        return self.levels[0].inside


known_levels: Memory[CageLevel] = Memory()
"""Levels computed in this session, for reuse: each around the same mesh with the same choices."""


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
        self.results: list[Result] = []
        self.problems: list[UserError] = []
        self._plans: list[tuple[Request, core.Mesh, tuple[Wanted, ...]]] = []
        for request in requests:
            try:
                self._plans.append(self._plan(request))
            except UserError as error:
                self.problems.append(error)
        self._check_some(self._plans)

    def _plan(self, request: Request) -> tuple[Request, core.Mesh, tuple[Wanted, ...]]:
        """The plan for a drawing. Raises: UserError."""
        fine, options = request.fine.mesh(), self.options
        own = tuple(drawing.mesh() for drawing in request.coarse)
        if not own and not options.levels:
            raise UserError("Give a vertex count for at least one level, such as 64")
        wanted = wanted_levels(options.levels, fine, own, request.fine.name, request.fine.frame.scale)
        if options.clearance > 0.0 and not own and not options.inside and options.methods.keeps_loops():
            check_room(fine, self._clearances(request, fine)[0], len(wanted), request.fine)
        return request, fine, wanted

    def _check_some(self, found: Sequence[object]) -> None:
        """Raises: UserError, the first problem, if nothing is found."""
        if self.problems and not found:
            raise self.problems[0]

    def __iter__(self) -> Iterator[Progress]:
        total = sum(len(levels) for _, _, levels in self._plans)
        done, reached = 0, 0.0
        for request, fine, levels in self._plans:
            finished: list[CageLevel] = []
            try:
                for progress in self._levels(request, fine, levels, finished):
                    # A level that starts over goes back; the displayed progress does not.
                    reached = max(reached, (done + progress.fraction) / total)
                    yield Progress(reached, progress.message)
            except UserError as error:
                self.problems.append(error)
                done += len(levels)
                continue
            done += len(levels)
            reached = done / total
            self.results.append(Result(request.fine, tuple(finished)))
        self._check_some(self.results)

    def _levels(
        self, request: Request, fine: core.Mesh, levels: Sequence[Wanted], finished: list[CageLevel]
    ) -> Iterator[Progress]:
        """Fills `finished`; the fraction of the progress is in levels. Raises: UserError."""
        clearances, inner = self._clearances(request, fine), fine
        for number, wanted in enumerate(levels, 1):
            name = f"{request.fine.name}, level {number}"
            yield Progress(number - 1.0, name)  # shown before anything is computed
            for step in self._known_or_made(name, inner, wanted.level, clearances, request.fine.frame.scale):
                if isinstance(step, CageLevel):
                    cage = step.mesh
                    advice = () if step.inside else excess_note(fine, cage, wanted.level, clearances[0])
                    notes = (*wanted.notes, *step.report.notes, *advice)
                    finished.append(replace(step, report=replace(step.report, notes=tuple(dict.fromkeys(notes)))))
                    inner = cage
                else:
                    yield Progress(number - 1.0 + step.fraction, f"{name}: {STAGES[step.stage]}")
            yield Progress(float(number), name)

    def _clearances(self, request: Request, fine: core.Mesh) -> tuple[float, ...]:
        """The wanted clearance in the drawing's units, or the automatic ones to try in turn."""
        if self.options.clearance > 0.0:
            return (self.options.clearance / request.fine.frame.scale,)
        return tuple(part * fine.diagonal for part in AUTOMATIC_CLEARANCES)

    def _known_or_made(
        self,
        name: str,
        fine: core.Mesh,
        wanted: int | core.Mesh | core.Within,
        clearances: Sequence[float],
        scale: float,
    ) -> Iterator[core.Progress | CageLevel]:
        """As `_level`, but a level that is remembered is not made again."""
        choices = {"inside": self.options.inside, "scale": scale, **vars(self.options.methods)}
        key = key_of(fine, wanted, clearances, choices)
        known = known_levels.get(key)
        if known is not None:
            yield known
            return
        for step in self._level(name, fine, wanted, clearances, scale):
            if isinstance(step, CageLevel):
                known_levels.put(key, step, step.fine_steps.nbytes + step.cage_steps.nbytes)
            yield step

    def _level(
        self,
        name: str,
        fine: core.Mesh,
        wanted: int | core.Mesh | core.Within,
        clearances: Sequence[float],
        scale: float,
    ) -> Iterator[core.Progress | CageLevel]:
        """Yields the core's progress of one level, and returns its `CageLevel`. Raises: UserError."""
        problem = ""
        margin = MARGIN * FLOAT32_ROUNDING * float(np.abs(fine.vertices).max())
        settings = self.options.methods.settings()
        cages_run = core.InnerCagesRun if self.options.inside else core.NestedCagesRun
        for clearance in clearances:
            for margins, slack in zip(MARGINS, SLACKS, strict=True):
                asked = replace(settings, clearance=clearance + margins * margin)
                run = cages_run(fine, [needs.stricter(wanted, slack * margin)], asked)
                try:
                    yield from run
                    level = self._stored(fine, run.hierarchy.levels[0], clearance)
                except core.NestedCagesError as error:
                    least = smallest_found(str(error))
                    if isinstance(wanted, int) and least is not None and wanted < least <= len(fine.vertices):
                        note = f"{wanted} vertices are too few for loops in each other's way: the cage has {least}."
                        for step in self._level(name, fine, least, clearances, scale):
                            yield _noted(step, note) if isinstance(step, CageLevel) else step
                        return
                    problem = problem or str(error)
                    break
                finally:
                    run.close()
                missed = needs.missed(wanted, level.mesh)
                if level.certificate.holds and not missed:
                    yield replace(level, need=needs.sentence(wanted, level.mesh, clearance, scale))
                    return
                problem = missed or (
                    "the cage does not hold in Blender's single precision "
                    f"({'; '.join(level.certificate.problems)}); move the drawing closer to its object's origin, or "
                    "ask for more clearance"
                )
        raise UserError(f"'{name}': {problem}")

    def _stored(self, fine: core.Mesh, level: core.Level, clearance: float) -> CageLevel:
        """The core's level in float32 with its certificate: flow, during which the coarse mesh rests, and reinflation
        in one sequence.
        """
        flow, reinflation = level.flow.steps, level.reinflation
        standing = np.broadcast_to(level.coarse.vertices, (len(flow) - 1, *level.coarse.vertices.shape))
        fine_steps = np.concatenate([flow[:-1], reinflation.fine_steps]).astype(np.float32)
        cage_steps = np.concatenate([standing, reinflation.cage_steps]).astype(np.float32)
        same_loops = level.coarse.has_loops_like(fine)
        cage = level.cage.moved(cage_steps[-1].astype(np.float64))
        outer, inner = (fine, cage) if level.inside else (cage, fine)
        nested = self._nested_from(cage, fine, cage_steps, fine_steps, len(flow) - 1)
        return CageLevel(
            fine_edges=fine.edges,
            cage_edges=level.cage.edges,
            fine_steps=fine_steps,
            cage_steps=cage_steps,
            flow_end=nested,
            tightening=max(nested, len(flow) - 1 + reinflation.tightening_start),
            certificate=core.verify(outer, inner, clearance, same_loops=same_loops),
            report=level.report,
            inside=level.inside,
        )

    def _nested_from(self, cage: core.Mesh, fine: core.Mesh, cage_steps: Steps, fine_steps: Steps, first: int) -> int:
        """The step from which on the motion is certified collision-free in float32 too.

        This is the last step of the flow, unless rounding closed a gap later: then all earlier steps count as flow.
        """
        while True:
            cages, fines = (steps[first:].astype(np.float64) for steps in (cage_steps, fine_steps))
            motion = core.verify_motion(cage, fine, cages, fines)
            if motion.free or motion.step is None:
                return first
            first += motion.step + 1


def _noted(level: CageLevel, note: str) -> CageLevel:
    """The level with an additional note."""
    return replace(level, report=replace(level.report, notes=(note, *level.report.notes)))
