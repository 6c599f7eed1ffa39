"""Nested cages, level by level."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from ..decimation.base import LEAST_PER_LOOP
from ..errors import NestedCagesError, NestingError
from ..geometry.mesh import Mesh
from .level import LevelBuilder
from .reporting import Reporter
from .results import Hierarchy, Level, Progress
from .settings import Settings
from .stepping import Stepwise
from .units import Clearance

logger = logging.getLogger(__name__)


def nested_cages(
    fine: Mesh,
    levels: Sequence[int | Mesh],
    settings: Settings | None = None,
    *,
    progress: Callable[[Progress], None] | None = None,
) -> Hierarchy:
    """Cages around ``fine``, each enclosing the one before, from the finest to the coarsest.

    levels: for each cage its number of vertices, or the user's own coarse mesh. ``progress`` is called between
    iterations and may raise to cancel. Every returned cage is certified by exact predicates.

    Raises a NestedCagesError when a level cannot be made; its ``partial`` is the Hierarchy of the finished ones.
    """
    settings = settings if settings is not None else Settings()
    fine, wanted = _checked(fine, levels)
    finished: list[Level] = []
    for index, level in enumerate(wanted):
        inner = finished[-1].cage if finished else fine
        report = Reporter(index, len(wanted), progress)
        clearance = Clearance.of(settings.clearance, fine)
        try:
            finished.append(LevelBuilder(inner, clearance, settings, report).build(level))
        except NestedCagesError as error:
            error.partial = Hierarchy(fine, tuple(finished))
            raise
        logger.debug("level %d: %s", index, finished[-1].report)
    return Hierarchy(fine, tuple(finished))


class NestedCagesRun:
    """The work of :func:`nested_cages` as an iterator over its progress; dropping it cancels the work.

    >>> run = NestedCagesRun(fine, [64, 16])            # doctest: +SKIP
    >>> for progress in run:                            # doctest: +SKIP
    ...     print(progress.message)
    >>> run.hierarchy.cages                             # doctest: +SKIP
    """

    def __init__(self, fine: Mesh, levels: Sequence[int | Mesh], settings: Settings | None = None) -> None:
        self._work: Stepwise[Progress, Hierarchy] = Stepwise(
            lambda report: nested_cages(fine, levels, settings, progress=report)
        )

    def __iter__(self) -> Iterator[Progress]:
        return self

    def __next__(self) -> Progress:
        return next(self._work)

    @property
    def hierarchy(self) -> Hierarchy:
        """The result; RuntimeError before the run is over."""
        return self._work.result

    def close(self) -> None:
        """Cancel the work; nothing happens when it is over."""
        self._work.close()


def _checked(fine: Mesh, levels: Sequence[int | Mesh]) -> tuple[Mesh, list[int | Mesh]]:
    """The fine mesh and the levels, each an int or a Mesh, all meshes validated.

    NestingError for levels that no cage can have, InvalidMeshError for moved meshes that are not valid any more.
    """
    if not isinstance(fine, Mesh):
        raise NestingError(
            f"The fine mesh must be a Mesh, not {type(fine).__name__}; use Mesh.from_loops or Mesh.from_geometry."
        )
    if isinstance(levels, Mesh | str) or not isinstance(levels, Iterable):
        raise NestingError("The levels must be a list, for instance [64, 16]; a single level is a list of one.")
    fine = fine.validated()
    checked: list[int | Mesh] = []
    loops = len(fine.loops)
    for number, level in enumerate(levels, start=1):
        if isinstance(level, Mesh):
            loops = len(level.loops)
            checked.append(level.validated())
        elif isinstance(level, (int, np.integer)) and not isinstance(level, bool):
            count = int(level)
            if count < LEAST_PER_LOOP * loops:
                raise NestingError(
                    f"Level {number} asks for {count} vertices, but {loops} loop{'s need' if loops > 1 else ' needs'} "
                    f"at least {LEAST_PER_LOOP * loops}{f', {LEAST_PER_LOOP} each' if loops > 1 else ''}."
                )
            checked.append(count)
        else:
            raise NestingError(f"Level {number} must be a number of vertices or a Mesh, not {level!r}.")
    if not checked:
        raise NestingError("There are no levels: give at least one vertex count or coarse mesh.")
    return fine, checked
