"""Cages around all shapes of a file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from ..batch import Outcome, nested_cages_many
from ..errors import Fault, NestedCagesError
from ..exchange import Limits, cut_at_borders
from ..exchange.pictures import picture_cages
from ..geometry.mesh import Mesh
from ..hierarchy import Hierarchy, NestingReport, Settings, inner_cages, nested_cages, wanted_levels
from .progress import ProgressLine
from .sources import Shape, Source

MAX_PROCESSES_ON_WINDOWS = 61
"""Worker processes that Python can wait for there."""

MAX_RAISES = 8
"""Times that the counts of a shape are raised to the least that was found."""

SETTINGS = ("clearance", "grid", "convex", "symmetry", "min_edge", "min_angle")
"""Options that are settings of the same name."""


@dataclass(frozen=True, eq=False)
class Cage:
    """One cage of a shape, with its certificate."""

    mesh: Mesh
    report: NestingReport


@dataclass(frozen=True, eq=False)
class Made:
    """The cages of one shape, from the finest to the coarsest."""

    shape: Shape
    fine: Mesh
    cages: Sequence[Cage]
    notes: Sequence[str] = ()
    """What became of counts that are too small."""


@dataclass(frozen=True, eq=False)
class Result:
    """The cages and failures of a file."""

    source: Source
    made: Sequence[Made] = ()
    failures: Sequence[str] = field(default_factory=list)
    """One sentence per shape that has no cages, or not all of them."""
    borders: Sequence[dict[str, Any]] = ()
    """For each level: points read, points of the cages and what they cover of their neighbours, uncut and cut."""


class _Wanted:
    """The levels of one shape: those that were asked for, with counts raised where they proved too small."""

    def __init__(self, given: argparse.Namespace) -> None:
        self.given = given
        self.least: dict[int, int] = {}
        self.asked: list[Any] = []

    def __call__(self, mesh: Mesh) -> list[Any]:
        self.asked = wanted_levels(self.given.levels, mesh)
        return [self.least.get(k, level) for k, level in enumerate(self.asked)]

    def is_raised(self, error: Exception | None) -> bool:
        """Whether an error is about counts, and these were raised to the least that it names."""
        if self.given.strict or not isinstance(error, NestedCagesError) or error.code != "count.too_small":
            return False
        least = error.data.get("least")
        done = len(error.partial.levels) if isinstance(error.partial, Hierarchy) else 0
        low = {
            k: least
            for k, level in enumerate(self.asked)
            if least and k >= done and isinstance(level, int | np.integer) and self.least.get(k, level) < least
        }
        self.least.update(low)
        return bool(low)

    def note(self, level: int) -> Fault | None:
        """What became of the count of a level."""
        if level not in self.least:
            return None
        asked, least = int(self.asked[level]), self.least[level]
        sentence = f"Level {level + 1}: {asked} vertices are too few for this shape; {least} is the least found."
        return Fault(sentence, "note.count", asked=asked, given=least)


def make(source: Source, given: argparse.Namespace, line: ProgressLine) -> Result:
    """The cages of a file. If a shape fails, its finished levels and all other shapes are kept.

    Counts that are too small for a shape are raised to the least that does, and a note says so, unless `strict`.
    """
    settings = Settings(**{name: getattr(given, name) for name in SETTINGS})
    wanted = [_Wanted(given) for _ in source.shapes]
    outcomes: dict[int, Outcome] = {}
    open_ = list(range(len(source.shapes)))
    for _ in range(1 + MAX_RAISES):
        outcomes.update(zip(open_, _outcomes(source, open_, wanted, given, settings, line), strict=True))
        open_ = [k for k in open_ if wanted[k].is_raised(outcomes[k].error)]
        if not open_:
            break
    several = len(source.shapes) > 1
    failures = list(source.failures)
    made: list[Made] = []
    for k, shape in enumerate(source.shapes):
        error = outcomes[k].error
        if error is not None and not isinstance(error, NestedCagesError):
            raise error
        hierarchy = outcomes[k].result if error is None else error.partial
        if error is not None:
            failures.append(f"{shape.name}: {error}" if several else str(error))
        if isinstance(hierarchy, Hierarchy) and hierarchy.levels:
            made.append(_made(shape, hierarchy, wanted[k]))
    if given.borders is None:
        return Result(source, made, failures)
    made, borders = _at_borders(made, given.clearance, given.borders or None)
    return Result(source, made, failures, borders)


def _made(shape: Shape, hierarchy: Hierarchy, wanted: _Wanted) -> Made:
    cages, notes = [], []
    for k, level in enumerate(hierarchy.levels):
        note = wanted.note(k)
        report = level.report if note is None else replace(level.report, notes=(*level.report.notes, note))
        cages.append(Cage(level.cage, report))
        notes += [note] if note else []
    return Made(shape, hierarchy.fine, cages, notes)


def _outcomes(
    source: Source,
    chosen: Sequence[int],
    wanted: Sequence[_Wanted],
    given: argparse.Namespace,
    settings: Settings,
    line: ProgressLine,
) -> list[Outcome]:
    """The cages of some shapes of a file, or the error of each."""
    shapes = [source.shapes[k].content for k in chosen]
    if all(isinstance(shape, Mesh) for shape in shapes) and not given.inside and len(source.shapes) > 1:
        levels = {k: wanted[chosen[k]](shape) for k, shape in enumerate(shapes) if isinstance(shape, Mesh)}
        executor = partial(_processes, given.jobs) if given.jobs > 1 else None
        return nested_cages_many(shapes, levels, settings, executor=executor, progress=line.of_batch)
    outcomes = []
    for k, shape in zip(chosen, shapes, strict=True):
        work: Callable[[], Hierarchy]
        if not isinstance(shape, Mesh):
            work = partial(
                picture_cages,
                shape,
                wanted[k],
                padding=given.padding or given.clearance or 0.0,
                threshold=given.threshold or 0.0,
                holes=given.holes,
                settings=settings,
                limits=replace(Limits(), **given.limits),
            )
        else:
            work = partial(inner_cages if given.inside else nested_cages, shape, wanted[k](shape), settings)
        try:
            outcomes.append(Outcome(k, work(progress=line.of_run)))
        except NestedCagesError as error:
            outcomes.append(Outcome(k, None, error))
    return outcomes


def _processes(count: int) -> Executor:
    from concurrent.futures import ProcessPoolExecutor  # imports multiprocessing, which few need

    return ProcessPoolExecutor(min(count, MAX_PROCESSES_ON_WINDOWS) if sys.platform == "win32" else count)


def _at_borders(
    made: Sequence[Made], clearance: float | None, width: float | None
) -> tuple[list[Made], list[dict[str, Any]]]:
    """The result with all cages cut at the borders between regions, level by level, and what that changed."""
    regions = inner = [each.fine for each in made]
    cut_back: list[list[Cage]] = [[] for _ in made]
    borders = []
    for number in range(max((len(each.cages) for each in made), default=0)):
        given = [each.cages[number] if number < len(each.cages) else None for each in made]
        meshes = [mesh if cage is None else cage.mesh for cage, mesh in zip(given, inner, strict=True)]
        cuts = cut_at_borders(meshes, regions, clearance=clearance, inner=inner, width=width)
        for k, (cage, cut) in enumerate(zip(given, cuts, strict=True)):
            if cage is not None:
                excess = cut.cage.area / inner[k].area - 1.0
                notes = (*cage.report.notes, cut.note)
                report = replace(cage.report, clearance=cut.clearance, excess=excess, notes=notes)
                cut_back[k].append(Cage(cut.cage, report))
        land = sum(region.area for region in regions)
        borders.append(
            {
                "points_read": sum(len(region.vertices) for region in regions),
                "points_uncut": sum(cut.points_before for cut in cuts),
                "points": sum(len(cut.cage.vertices) for cut in cuts),
                "overlap_uncut": sum(cut.overlap_before for cut in cuts) / land,
                "overlap": sum(cut.overlap for cut in cuts) / land,
            }
        )
        inner = [cut.cage for cut in cuts]
    return [replace(each, cages=cages) for each, cages in zip(made, cut_back, strict=True)], borders
