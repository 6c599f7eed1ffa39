"""Drawings to certified cages in the numbers that Blender stores; nothing here touches the scene."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..core import core
from ..errors import UserError
from ..scene.convert import Drawing
from .job import Progress
from .methods import Methods

# Automatic clearances as parts of the drawing's diagonal: the core's default, and one for drawings whose gaps leave no
# room for it. Less than that cannot be told from nothing in float32.
AUTOMATIC_CLEARANCES = (1e-5, 1e-6)
# Rounding to float32 moves a coordinate by at most this part of it; of a point by sqrt(2) times that.
FLOAT32_ROUNDING = float(np.finfo(np.float32).eps) / 2.0
# What is added to the wanted clearance, in roundings of the largest coordinate: twice what one rounded mesh can lose,
# as the cage reaches further out than the drawing that the coordinate is taken from.
MARGIN = 2.0 * np.sqrt(2.0)
# How many of these margins to try: rounding can also close a gap that the cage has with itself.
MARGINS = (1.0, 64.0)

Percent = float
# What the stages of the core are called for users.
STAGES = {
    "decimation": "making a coarse mesh",
    "flow": "shrinking",
    "reinflation": "growing back",
    "tightening": "tightening",
    "verification": "checking",
}
# Stands for an own coarse drawing in a list of levels.
OWN = "*"
Level = int | Percent | str
Steps = NDArray[np.float32]


@dataclass(frozen=True)
class Options:
    """`levels`: vertex counts (int), percentages of the drawing's vertices (float), or `OWN`, finest first.
    `clearance`: a length of the scene, 0 = automatic.
    """

    levels: tuple[Level, ...] = ()
    clearance: float = 0.0
    methods: Methods = field(default_factory=Methods)


@dataclass(frozen=True)
class Request:
    """A drawing, and the user's own coarse drawings for it, finest first: one for each `OWN` in `Options.levels`, or
    all levels if there are none in it.
    """

    fine: Drawing
    coarse: tuple[Drawing, ...] = ()


@dataclass(frozen=True)
class CageLevel:
    """One level as Blender stores it: `fine_steps` (S, n, 2) and `cage_steps` (S, m, 2), float32, go through flow (up
    to index `flow_end`), reinflation and tightening (from index `tightening`); the last ones are the result.
    """

    fine_edges: NDArray[np.int64]
    cage_edges: NDArray[np.int64]
    fine_steps: Steps
    cage_steps: Steps
    flow_end: int
    tightening: int
    certificate: core.Certificate
    report: core.NestingReport

    @property
    def cage(self) -> NDArray[np.float32]:
        """The cage's vertices (m, 2)."""
        vertices: NDArray[np.float32] = self.cage_steps[-1]
        return vertices

    @property
    def last(self) -> int:
        """Index of the last step."""
        return len(self.cage_steps) - 1


@dataclass(frozen=True)
class Result:
    """All levels around one drawing."""

    drawing: Drawing
    levels: tuple[CageLevel, ...]


def parse_levels(text: str) -> tuple[Level, ...]:
    """Counts, percentages and own drawings from a text such as "64, 24", "10% 3%" or "64, *". Raises: UserError."""
    levels: list[Level] = []
    words = re.findall(r"[^\s,;]+", re.sub(r"\s+%", "%", text)) or [text]
    for word in words:
        if re.fullmatch(r"\d+", word):
            levels.append(int(word))
        elif re.fullmatch(r"\d+(\.\d*)?%|\.\d+%", word):
            levels.append(float(word[:-1]))
        elif word == OWN:
            levels.append(OWN)
        else:
            raise UserError(
                "Levels are vertex counts such as 64, 24 or percentages such as 10%, separated by commas, or * for an "
                f"object of your own; '{word}' is none of these"
            )
    return tuple(levels)


def counts(levels: Sequence[int | Percent], fine: core.Mesh, name: str) -> tuple[int, ...]:
    """Vertex counts for a drawing's ``Mesh``, at least three per loop. Raises: UserError unless they decrease."""
    total, least = len(fine.vertices), 3 * len(fine.loops)
    found: list[int] = []
    for level in levels:
        count = level if isinstance(level, int) else max(least, round(total * level / 100.0))
        before = found[-1] if found else total
        if count > before:
            problem = (
                f"the {before} of the level before it; list levels from finest to coarsest"
                if found
                else f"the {before} of the drawing; list fewer, or give the drawing a higher resolution"
            )
            raise UserError(f"'{name}': a level of {count} vertices is more than {problem}")
        if count < least:
            problem = (
                "an outline needs three vertices"
                if len(fine.loops) == 1
                else f"its {len(fine.loops)} loops need three vertices each"
            )
            raise UserError(f"'{name}': a level of {count} is too small: {problem}")
        found.append(count)
    return tuple(found)


def _wanted(
    levels: Sequence[Level], fine: core.Mesh, own: Sequence[core.Mesh], name: str
) -> tuple[int | core.Mesh, ...]:
    """The vertex count or own ``Mesh`` of each level. Raises: UserError."""
    if not levels:
        return tuple(own)
    if levels.count(OWN) != len(own):
        raise UserError(
            f"'{name}': own objects (*) in the levels: {levels.count(OWN)}, objects named: {len(own)}; "
            "name one for each"
        )
    numbers = iter(counts([level for level in levels if not isinstance(level, str)], fine, name))
    meshes = iter(own)
    return tuple(next(meshes) if level == OWN else next(numbers) for level in levels)


class Generation:
    """Cages for several drawings as an iterator of `Progress`; ``results`` is complete when it ends. Dropping it
    cancels.

    Everything that can be refused without computing is refused by the constructor. Raises: UserError.
    """

    def __init__(self, requests: Sequence[Request], options: Options) -> None:
        self.options = options
        options.methods.check()
        self.results: list[Result] = []
        self._plans: list[tuple[Request, core.Mesh, tuple[int | core.Mesh, ...]]] = []
        for request in requests:
            fine = request.fine.mesh()
            own = tuple(drawing.mesh() for drawing in request.coarse)
            if not own and not options.levels:
                raise UserError("Give a vertex count for at least one level, such as 64")
            self._plans.append((request, fine, _wanted(options.levels, fine, own, request.fine.name)))

    def __iter__(self) -> Iterator[Progress]:
        total = sum(len(levels) for _, _, levels in self._plans)
        done, reached = 0, 0.0
        for request, fine, levels in self._plans:
            clearances = self._clearances(request, fine)
            inner, finished = fine, []
            for number, wanted in enumerate(levels, 1):
                name = f"{request.fine.name}, level {number}"
                yield Progress(reached, name)  # before anything is computed, so that it can be shown
                for step in self._level(name, inner, wanted, clearances):
                    if isinstance(step, CageLevel):
                        finished.append(step)
                        inner = core.Mesh(step.cage.astype(np.float64), step.cage_edges)
                    else:
                        # A level that starts anew, from another coarse mesh, goes back; what is shown does not.
                        reached = max(reached, (done + step.fraction) / total)
                        yield Progress(reached, f"{name}: {STAGES[step.stage]}")
                done += 1
                reached = done / total
                yield Progress(reached, name)
            self.results.append(Result(request.fine, tuple(finished)))

    def _clearances(self, request: Request, fine: core.Mesh) -> tuple[float, ...]:
        """The wanted clearance in the drawing's units, or the automatic ones, to be tried in turn."""
        if self.options.clearance > 0.0:
            return (self.options.clearance / request.fine.frame.scale,)
        return tuple(part * fine.diagonal for part in AUTOMATIC_CLEARANCES)

    def _level(
        self, name: str, fine: core.Mesh, wanted: int | core.Mesh, clearances: Sequence[float]
    ) -> Iterator[core.Progress | CageLevel]:
        """The core's progress of one level, and at the end its `CageLevel`. Raises: UserError."""
        problem = ""
        margin = MARGIN * FLOAT32_ROUNDING * float(np.abs(fine.vertices).max())
        settings = self.options.methods.settings()
        for clearance in clearances:
            for margins in MARGINS:
                asked = replace(settings, clearance=clearance + margins * margin)
                run = core.NestedCagesRun(fine, [wanted], asked)
                try:
                    yield from run
                    level = self._stored(fine, run.hierarchy.levels[0], clearance)
                except core.NestedCagesError as error:
                    problem = problem or str(error)
                    break
                finally:
                    run.close()
                if level.certificate.holds:
                    yield level
                    return
                problem = (
                    "the cage does not hold in Blender's single precision "
                    f"({'; '.join(level.certificate.problems)}); move the drawing closer to its object's origin, or "
                    "ask for more clearance"
                )
        raise UserError(f"'{name}': {problem}")

    def _stored(self, fine: core.Mesh, level: core.Level, clearance: float) -> CageLevel:
        """The core's level in float32, certified as such: the flow, during which the coarse mesh stands still, and the
        reinflation in one sequence.
        """
        flow, reinflation = level.flow.steps, level.reinflation
        standing = np.broadcast_to(level.coarse.vertices, (len(flow) - 1, *level.coarse.vertices.shape))
        fine_steps = np.concatenate([flow[:-1], reinflation.fine_steps]).astype(np.float32)
        cage_steps = np.concatenate([standing, reinflation.cage_steps]).astype(np.float32)
        same_loops = level.coarse.has_loops_like(fine)
        cage = level.cage.moved(cage_steps[-1].astype(np.float64))
        inside = self._inside_from(cage, fine, cage_steps, fine_steps, len(flow) - 1)
        return CageLevel(
            fine_edges=fine.edges,
            cage_edges=level.cage.edges,
            fine_steps=fine_steps,
            cage_steps=cage_steps,
            flow_end=inside,
            tightening=max(inside, len(flow) - 1 + reinflation.tightening_start),
            certificate=core.verify(cage, fine, clearance, same_loops=same_loops),
            report=level.report,
        )

    def _inside_from(self, cage: core.Mesh, fine: core.Mesh, cage_steps: Steps, fine_steps: Steps, first: int) -> int:
        """The step from which on the motion is certified to be free of collisions in float32 too.

        This is the last step of the flow, unless rounding closed a gap later: then what comes before counts as flow.
        """
        while True:
            cages, fines = (steps[first:].astype(np.float64) for steps in (cage_steps, fine_steps))
            motion = core.verify_motion(cage, fine, cages, fines)
            if motion.free or motion.step is None:
                return first
            first += motion.step + 1
