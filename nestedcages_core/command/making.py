"""Cages around all shapes of a file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from ..batch import Outcome, nested_cages_many
from ..errors import NestedCagesError
from ..formats import Coverage, Limits, coverage_cages
from ..formats.pictures import HALF, picture_cages
from ..geometry.mesh import Mesh
from ..levels import Hierarchy, Level, Settings, inner_cages, nested_cages
from .progress import ProgressLine
from .sources import NamedShape, Source

MAX_PROCESSES_ON_WINDOWS = 61
"""Worker processes that Python can wait for there."""

TOLD = ("note.count", "note.loops")
"""Codes of notes that are told of several files too."""

SETTINGS = ("clearance", "grid", "loops", "convex", "symmetry", "min_edge", "min_angle", "seconds")
"""Options that are settings of the same name."""

CONSTRAINTS = ("directions", "box")
"""Options that are constraints."""


class Made(NamedTuple):
    """The cages of one shape, from the finest to the coarsest."""

    shape: NamedShape
    fine: Mesh
    levels: Sequence[Level]

    @property
    def notes(self) -> list[str]:
        """What became of counts that are too small, and of loops."""
        said = [(number, note) for number, level in enumerate(self.levels, 1) for note in level.report.notes]
        return [f"Level {number}: {note}" for number, note in said if note.code in TOLD]


@dataclass(frozen=True, eq=False)
class Result:
    """The cages and failures of a file."""

    source: Source
    made: Sequence[Made] = ()
    failures: Sequence[str] = ()
    """One sentence per shape that has no cages, or not all of them."""
    coverages: Sequence[Coverage] = ()
    """For each level: the regions of a map whose borders are simplified."""


def make(source: Source, given: argparse.Namespace, line: ProgressLine) -> Result:
    """The cages of a file. If a shape fails, its finished levels and all other shapes are kept."""
    if given.borders is not None:
        return _coverage(source, given, line)
    failures = list(source.failures)
    made: list[Made] = []
    for shape, outcome in zip(source.shapes, _made_outcomes(source, given, line), strict=True):
        hierarchy, error = outcome.result, outcome.error
        if error is not None:
            if not isinstance(error, NestedCagesError):
                raise error
            failures.append(f"{shape.name}: {error}" if len(source.shapes) > 1 else str(error))
            hierarchy = error.partial
        if isinstance(hierarchy, Hierarchy) and hierarchy.levels:
            made.append(Made(shape, hierarchy.fine, hierarchy.levels))
    return Result(source, made, failures)


def _made_outcomes(source: Source, given: argparse.Namespace, line: ProgressLine) -> list[Outcome]:
    """The cages of the shapes of a file, or the error of each."""
    constraints = [each for name in CONSTRAINTS if (each := getattr(given, name)) is not None]
    settings = Settings(**{name: getattr(given, name) for name in SETTINGS}, constraints=constraints, steps=False)
    shapes = [shape.content for shape in source.shapes]
    if all(isinstance(shape, Mesh) for shape in shapes) and not given.inside and len(shapes) > 1:
        executor = partial(_processes, given.jobs) if given.jobs > 1 else None
        return nested_cages_many(shapes, given.levels, settings, executor=executor, progress=line.of_batch)
    of_picture = {
        "padding": given.padding or given.clearance or 0.0,
        "threshold": HALF if given.threshold is None else given.threshold,
        "holes": given.holes,
        "limits": replace(Limits(), **given.limits),
    }
    outcomes = []
    for k, shape in enumerate(shapes):
        work: Callable[..., Hierarchy]
        if isinstance(shape, Mesh):
            work = partial(inner_cages if given.inside else nested_cages, shape, given.levels, settings)
        else:
            work = partial(picture_cages, shape, given.levels, settings=settings, **of_picture)
        try:
            outcomes.append(Outcome(k, work(progress=line.of_run)))
        except NestedCagesError as error:
            outcomes.append(Outcome(k, None, error))
    return outcomes


def _processes(count: int) -> Executor:
    from concurrent.futures import ProcessPoolExecutor  # imports multiprocessing, which few need

    return ProcessPoolExecutor(min(count, MAX_PROCESSES_ON_WINDOWS) if sys.platform == "win32" else count)


def _coverage(source: Source, given: argparse.Namespace, line: ProgressLine) -> Result:
    """The cage around all regions of a map, divided among them."""
    regions = [shape.content for shape in source.shapes if isinstance(shape.content, Mesh)]
    settings = Settings(**{name: getattr(given, name) for name in SETTINGS}, steps=False)
    found = coverage_cages(regions, given.levels, settings, width=given.borders or None, progress=line.of_run)
    land = found[0].coast.fine
    coast = Made(NamedShape("Coast", land), land, [coverage.coast for coverage in found])
    return Result(source, [coast], source.failures, found)
