"""Cages around all shapes of a file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import partial

from ..batch import nested_cages_many
from ..errors import Fault, NestedCagesError
from ..exchange import Limits, cut_at_borders
from ..exchange.pictures import picture_cages
from ..geometry.arrays import AnyArray
from ..geometry.mesh import Mesh
from ..hierarchy import Hierarchy, NestingReport, Settings, inner_cages, nested_cages, wanted_levels
from .progress import ProgressLine
from .sources import Shape, Source

MAX_PROCESSES_ON_WINDOWS = 61
"""Worker processes that Python can wait for there."""


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

    @classmethod
    def of(cls, shape: Shape, hierarchy: Hierarchy) -> Made:
        return cls(shape, hierarchy.fine, [Cage(level.cage, level.report) for level in hierarchy.levels])


@dataclass(frozen=True, eq=False)
class Result:
    """The cages and failures of a file."""

    source: Source
    made: Sequence[Made] = ()
    failures: Sequence[str] = field(default_factory=list)
    """One sentence per shape that has no cages, or not all of them."""


def make(source: Source, given: argparse.Namespace, line: ProgressLine) -> Result:
    """The cages of a file. If a shape fails, its finished levels and all other shapes are kept."""
    settings = Settings(
        clearance=given.clearance,
        grid=given.grid,
        convex=given.convex,
        symmetry=given.symmetry,
        min_edge=given.min_edge,
        min_angle=given.min_angle,
    )
    failures = list(source.failures)
    made: list[Made] = []
    meshes: list[Shape] = []
    for shape in source.shapes:
        if isinstance(shape.content, Mesh) and given.inside:
            _add(
                made,
                failures,
                shape,
                partial(_inside, shape.content, given, settings, line),
                several=len(source.shapes) > 1,
            )
        elif isinstance(shape.content, Mesh):
            meshes.append(shape)
        else:
            _add(made, failures, shape, partial(_picture, shape.content, given, settings, line))
    if len(meshes) == 1:
        (shape,) = meshes
        assert isinstance(shape.content, Mesh)
        mesh, levels = shape.content, wanted_levels(given.levels, shape.content)
        _add(made, failures, shape, lambda: nested_cages(mesh, levels, settings, progress=line.of_run))
    elif meshes:
        asked = [wanted_levels(given.levels, shape.content) for shape in meshes if isinstance(shape.content, Mesh)]
        outcomes = nested_cages_many(
            [shape.content for shape in meshes],
            dict(enumerate(asked)),
            settings,
            executor=partial(_processes, given.jobs) if given.jobs > 1 else None,
            progress=line.of_batch,
        )
        for shape, outcome in zip(meshes, outcomes, strict=True):
            _add(made, failures, shape, outcome.unwrap, several=True)
    if given.borders:
        made = _at_borders(made, given.clearance)
    return Result(source, made, failures)


def _processes(count: int) -> Executor:
    from concurrent.futures import ProcessPoolExecutor  # imports multiprocessing, which few need

    return ProcessPoolExecutor(min(count, MAX_PROCESSES_ON_WINDOWS) if sys.platform == "win32" else count)


def _add(
    made: list[Made],
    failures: list[str],
    shape: Shape,
    work: Callable[[], Hierarchy],
    *,
    several: bool = False,
) -> None:
    """Make the cages; after an error keep its message and the levels finished before it."""
    try:
        made.append(Made.of(shape, work()))
    except NestedCagesError as error:
        failures.append(f"{shape.name}: {error}" if several else str(error))
        finished = getattr(error, "partial", None)
        if isinstance(finished, Hierarchy) and finished.levels:
            made.append(Made.of(shape, finished))


def _at_borders(made: Sequence[Made], clearance: float | None) -> list[Made]:
    """The result with all cages cut at the borders between regions, level by level."""
    regions = inner = [each.fine for each in made]
    cut_back: list[list[Cage]] = [[] for _ in made]
    for number in range(max((len(each.cages) for each in made), default=0)):
        given = [each.cages[number] if number < len(each.cages) else None for each in made]
        meshes = [mesh if cage is None else cage.mesh for cage, mesh in zip(given, inner, strict=True)]
        cuts = cut_at_borders(meshes, regions, clearance=clearance, inner=inner)
        for k, (cage, cut) in enumerate(zip(given, cuts, strict=True)):
            if cage is not None:
                excess = cut.cage.area / inner[k].area - 1.0
                notes = (*cage.report.notes, Fault(cut.note, "note.cut"))
                report = replace(cage.report, clearance=cut.clearance, excess=excess, notes=notes)
                cut_back[k].append(Cage(cut.cage, report))
        inner = [cut.cage for cut in cuts]
    return [replace(each, cages=cages) for each, cages in zip(made, cut_back, strict=True)]


def _inside(mesh: Mesh, given: argparse.Namespace, settings: Settings, line: ProgressLine) -> Hierarchy:
    return inner_cages(mesh, wanted_levels(given.levels, mesh), settings, progress=line.of_run)


def _picture(picture: AnyArray, given: argparse.Namespace, settings: Settings, line: ProgressLine) -> Hierarchy:
    return picture_cages(
        picture,
        lambda mesh: wanted_levels(given.levels, mesh),
        padding=given.padding or given.clearance or 0.0,
        threshold=given.threshold or 0.0,
        holes=given.holes,
        settings=settings,
        limits=replace(Limits(), **given.limits),
        progress=line.of_run,
    )
