"""Cages around all shapes of a file."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from ..batch import Outcome, nested_cages_many
from ..errors import NestedCagesError
from ..formats import Limits
from ..formats.pictures import HALF, picture_cages
from ..geometry.mesh import Mesh
from ..levels import Hierarchy, Level, Settings, inner_cages, nested_cages
from .ground import counts, measured
from .progress import ProgressLine
from .sources import NamedShape, Source

MAX_PROCESSES_ON_WINDOWS = 61
"""Worker processes that Python can wait for there."""

REPORTED = ("note.count", "note.loops")
"""Codes of notes that are reported of several files too."""

SETTINGS = ("clearance", "grid", "loops", "convex", "symmetry", "min_edge", "min_angle", "seconds")
"""Options that are settings of the same name."""

CONSTRAINTS = ("directions", "box")
"""Options that are constraints."""


class Made(NamedTuple):
    """The cages of one shape, from the finest to the coarsest."""

    shape: NamedShape
    fine: Mesh
    levels: Sequence[Level]


@dataclass(frozen=True, eq=False)
class Result:
    """The cages and failures of a file."""

    source: Source
    made: Sequence[Made] = ()
    failures: Sequence[str] = ()
    """One sentence per shape that has no cages, or not all of them."""

    @property
    def notes(self) -> Iterator[str]:
        """What became of counts that are too small, and of loops."""
        for each in self.made:
            name = f"{each.shape.name}: " if len(self.made) > 1 else ""
            for number, level in enumerate(each.levels, 1):
                notes = (note for note in level.report.notes if note.code in REPORTED)
                yield from (f"{name}Level {number}: {note}" for note in notes)

    def __str__(self) -> str:
        """The certificate of every cage."""
        lines = []
        for each in self.made:
            count = len(each.fine.loops)
            name = each.shape.name if len(self.source.shapes) + len(self.source.failures) > 1 else "Drawing"
            lines.append(f"{name}: {len(each.fine.vertices)} vertices, {count} loop{'s' * (count != 1)}")
            cages = ((k, len(level.cage.vertices), level.report) for k, level in enumerate(each.levels, 1))
            lines += [f"  Level {k}: {number} vertices, {report}" for k, number, report in cages]
        return "\n".join(lines)


def make(source: Source, given: argparse.Namespace, line: ProgressLine) -> Result:
    """The cages of a file. If a shape fails, its finished levels and all other shapes are kept."""
    failures = list(source.failures)
    made: list[Made] = []

    def failed(shape: NamedShape, error: NestedCagesError) -> None:
        failures.append(f"{shape.name}: {error}" if len(source.shapes) > 1 else str(error))

    for shape, outcome in zip(source.shapes, _outcomes(source, given, line), strict=True):
        hierarchy, error = outcome.result, outcome.error
        if error is not None:
            if not isinstance(error, NestedCagesError):
                raise error
            failed(shape, error)
            hierarchy = error.partial
        if isinstance(hierarchy, Hierarchy) and hierarchy.levels:
            try:
                made.append(Made(shape, shape.drawn or hierarchy.fine, measured(shape, hierarchy.levels)))
            except NestedCagesError as beyond:
                failed(shape, beyond)
    return Result(source, made, failures)


def _outcomes(source: Source, given: argparse.Namespace, line: ProgressLine) -> list[Outcome]:
    """The cages of the shapes of a file, or the error of each."""
    chosen = {name: getattr(given, name) for name in SETTINGS}
    if any(shape.metres for shape in source.shapes):
        chosen["clearance"] = None  # shapes are grown by it
    constraints = [each for name in CONSTRAINTS if (each := getattr(given, name)) is not None]
    settings = Settings(**chosen, constraints=constraints, steps=False)
    shapes = [shape.content for shape in source.shapes]
    levels = [counts(shape, given.levels, keeps=given.loops == "keep") for shape in source.shapes]
    if source.kind == "map" and not given.inside and len(shapes) > 1:
        executor = partial(_processes, given.jobs) if given.jobs > 1 else None
        by_shape = dict(enumerate(levels))
        return nested_cages_many(shapes, by_shape, settings, executor=executor, progress=line.show)
    of_picture = {
        "padding": given.clearance or 0.0,
        "threshold": HALF if given.threshold is None else given.threshold,
        "holes": given.loops == "keep",
        "limits": replace(Limits(), **given.limits),
    }
    outcomes = []
    for k, shape in enumerate(shapes):
        work: Callable[..., Hierarchy]
        if isinstance(shape, Mesh):
            work = partial(inner_cages if given.inside else nested_cages, shape, levels[k], settings)
        else:
            work = partial(picture_cages, shape, given.levels, settings=settings, **of_picture)
        try:
            outcomes.append(Outcome(k, work(progress=line.show)))
        except NestedCagesError as error:
            outcomes.append(Outcome(k, None, error))
    return outcomes


def _processes(count: int) -> Executor:
    from concurrent.futures import ProcessPoolExecutor  # imports multiprocessing, which few need

    count = min(count, MAX_PROCESSES_ON_WINDOWS) if sys.platform == "win32" else count
    return ProcessPoolExecutor(count, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
