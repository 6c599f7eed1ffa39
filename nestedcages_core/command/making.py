"""Cages around all shapes of a file."""

from __future__ import annotations

import signal
import sys
from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..batch import nested_cages_many
from ..errors import NestedCagesError, invalid_file
from ..formats.lonlat import POLE, TURN
from ..formats.pictures import HALF, picture_cages
from ..geometry.mesh import Mesh
from ..levels import Hierarchy, Level, Settings, Share, Within, inner_cages, nested_cages
from .sources import Made, Shape, Source, limits_of

MAX_PROCESSES_ON_WINDOWS = 61
"""Worker processes that Python can wait for there."""

SETTINGS = ("clearance", "grid", "loops", "convex", "symmetry", "min_edge", "min_angle", "seconds")
"""Options that are settings of the same name."""

Show = Callable[[float, str], None]
"""Shows the fraction of a file that is done, and what is being done."""


def settings_of(given: Namespace) -> Settings:
    """The settings that the options say. Raises NestedCagesError for what does not go together."""
    constraints = [each for each in (given.directions, given.box) if each is not None]
    return Settings(**{name: getattr(given, name) for name in SETTINGS}, constraints=constraints, steps=False)


def make(source: Source, given: Namespace, settings: Settings, show: Show) -> Source:
    """A file with its cages. If a shape fails, its finished levels and all other shapes are kept."""
    made, failures = list[Made](), list(source.failures)
    outcomes = _outcomes(source.shapes, given, settings, show)
    for shape, (hierarchy, error) in zip(source.shapes, outcomes, strict=True):
        try:
            if isinstance(hierarchy, Hierarchy) and hierarchy.levels:
                made.append(Made(shape, shape.drawn or hierarchy.fine, _measured(shape.drawn, given, hierarchy)))
            if error is not None:
                raise error
        except NestedCagesError as problem:
            failures.append(f"{shape.name}: {problem}" if len(source.shapes) > 1 else str(problem))
    return source._replace(made=made, failures=failures)


def _outcomes(
    shapes: Sequence[Shape], given: Namespace, settings: Settings, show: Show
) -> Iterator[tuple[Any, Exception | None]]:
    """For each shape its cages, or those made before an error, and the error."""
    if any(shape.drawn for shape in shapes):
        settings = replace(settings, clearance=None)  # shapes are grown by it
    levels = [_counts(shape, given) for shape in shapes]
    if (given.jobs or 1) > 1 and all(isinstance(shape.content, Mesh) for shape in shapes):
        many = nested_cages_many(
            [shape.content for shape in shapes],
            dict(enumerate(levels)),
            settings,
            executor=partial(_processes, given.jobs),
            progress=lambda batch: show(batch.fraction, batch.message),
        )
        yield from ((each.result or getattr(each.error, "partial", None), each.error) for each in many)
        return
    for number, shape in enumerate(shapes):
        work: Callable[..., Hierarchy] = inner_cages if given.inside else nested_cages
        if not isinstance(shape.content, Mesh):
            work = partial(
                picture_cages,
                padding=given.clearance or 0.0,
                threshold=HALF if given.threshold is None else given.threshold,
                holes=given.loops == "keep",
                limits=limits_of(given),
            )

        def listen(progress: Any, number: int = number, name: str = shape.name) -> None:
            text = f"level {progress.level + 1}, {progress.stage}"
            show((number + progress.fraction) / len(shapes), f"{name}, {text}" if len(shapes) > 1 else text)

        try:
            yield work(shape.content, levels[number], settings=settings, progress=listen), None
        except NestedCagesError as error:
            yield error.partial, error


def _processes(count: int) -> Executor:
    from concurrent.futures import ProcessPoolExecutor  # imports multiprocessing, which few need

    count = min(count, MAX_PROCESSES_ON_WINDOWS) if sys.platform == "win32" else count
    return ProcessPoolExecutor(count, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))


def _counts(shape: Shape, given: Namespace) -> list[Any]:
    """Levels of a shape; if it is grown by a clearance in metres, such as have what is drawn for their measure.

    Raises NestedCagesError for tolerances that the clearance alone exceeds, and for those in degrees.
    """
    if shape.drawn is None:
        return list(given.levels)
    found, sizes, side = list[Any](), [len(loop) for loop in shape.drawn.loops], -1.0 if given.inside else 1.0
    ratio = shape.drawn.area / Mesh.of(shape.content).area
    for level in given.levels:
        if isinstance(level, Share):
            level = level.of(sizes, keeps=given.loops == "keep")
        elif isinstance(level, Within):
            if level.distance is not None:
                raise invalid_file("With a clearance in m, km or mi, a level is a count, a share or an excess of area.")
            excess, taken = side * ((1.0 + side * level.limit) * ratio - 1.0), abs(1.0 / ratio - 1.0)
            if not excess > 0.0:
                problem = f"The clearance alone takes {100.0 * taken:.3g} % of the area; allow more than that."
                raise NestedCagesError(problem, code="tolerance.unreachable", limit=level.limit, taken=taken)
            level = Within(excess=excess)
        found.append(level)
    return found


def _measured(drawn: Mesh | None, given: Namespace, hierarchy: Hierarchy) -> Sequence[Level]:
    """Levels with the excess over what is drawn, and the clearance in metres that it was grown by, if it was.

    Raises NestedCagesError for cages that go over a pole, or around the earth and into the clearance.
    """
    if drawn is None:
        return hierarchy.levels
    found, (west, _, east, _), metres = [], hierarchy.fine.bounds, float(given.clearance)
    for level in hierarchy.levels:
        x, y = level.vertices.T
        if np.abs(y).max() > POLE or x.max() - TURN > west or x.min() + TURN < east:
            raise invalid_file("A cage with so few vertices goes over a pole or around the earth; give it more.")
        excess = level.cage.area / drawn.area - 1.0
        report = replace(level.report, clearance=metres, wanted_clearance=metres, excess=excess)
        found.append(replace(level, report=report))
    return found
