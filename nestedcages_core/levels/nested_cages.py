"""Nested cages, level by level."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple, Unpack

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..errors import NestedCagesError, NestingError, note
from ..geometry.mesh import MESH_LIKE, Mesh, MeshLike, is_mesh_like, outer_and_inner
from ..progress import Run, listened
from ..tightening import Tightening
from ..tolerance.within import Within
from ..verification import verify
from .build import build_level
from .constraints import Asked, constraints_of
from .level_text import listed_levels
from .plan import Plan
from .progress import OutOfTimeError, Progress, Watch
from .report import Hierarchy, Level
from .settings import Settings
from .targets import Rising, Share, Wanted, in_order, wanted_levels
from .work import Work, clearances_for

if TYPE_CHECKING:
    from .keywords import SettingsKeywords

logger = logging.getLogger(__name__)

MOST_STEPS, STEPS_OF_A_LOOP = 10_000, 50
"""Steps of work that a level may take, and more for each loop of the shape. Usual ones take 10 to 150, and 5 a loop."""

ROOM_OF_A_LEVEL = 2.5
"""Distance between loops, in clearances, that leaves room for those of a further level: 2 fit exactly."""


def nested_cages(
    fine: MeshLike,
    levels: Wanted | Sequence[Wanted],
    settings: Settings | None = None,
    *,
    progress: Callable[[Progress], None] | bool | None = None,
    **options: Unpack[SettingsKeywords],
) -> Hierarchy:
    """Cages around ``fine``, each enclosing the one before, from the finest to the coarsest.

    fine: a mesh, or anything that `Mesh.of` reads: objects with `__geo_interface__`, an array (k, 2), lists of loops.
    levels: for each cage its number of vertices, ``"8%"`` or a `Share` of those of ``fine``, the user's own coarse
    mesh, or the fewest vertices within a distance, ``"2px"`` or ``"2u"`` in the input's units, or an excess of area,
    ``"+25%"``, which are `Within`. A single level needs no list; counts and the like may come in any order.
    progress: called between iterations; may raise to cancel. True: a bar of tqdm, or lines without it.
    options: fields of `Settings`, such as ``clearance=0.01``, that replace those of ``settings``.

    Exact predicates certify every returned cage. Raises a NestedCagesError when a level cannot be made; its ``partial``
    is the Hierarchy of the finished ones.
    """
    return listened(NestedCagesRun.work(fine, levels, settings, **options), progress)


def inner_cages(
    fine: MeshLike,
    levels: Wanted | Sequence[Wanted],
    settings: Settings | None = None,
    *,
    progress: Callable[[Progress], None] | bool | None = None,
    **options: Unpack[SettingsKeywords],
) -> Hierarchy:
    """Cages inside ``fine``, of locally largest area, each inside the one before; see `nested_cages`.

    Level k is certified to lie strictly inside level k - 1, or inside the fine mesh, at the clearance; so its
    ``report.excess`` is negative. A user's own mesh, from which the cage starts, lies inside; one that does not is left
    out, with a note. The settings `flow` and `contact` are not used, nor is a decimation other than `LineCycles`.
    Errors are those of `nested_cages`.
    """
    return listened(InnerCagesRun.work(fine, levels, settings, **options), progress)


class NestedCagesRun(Run[Progress, Hierarchy]):
    """The work of :func:`nested_cages` as an iterator over its progress; dropping it cancels the work."""

    side = 1
    """1 for cages around the mesh, -1 for cages inside it."""

    def __init__(
        self,
        fine: MeshLike,
        levels: Wanted | Sequence[Wanted],
        settings: Settings | None = None,
        **options: Unpack[SettingsKeywords],
    ) -> None:
        super().__init__(self.work(fine, levels, settings, **options))

    @classmethod
    def work(
        cls,
        fine: MeshLike,
        levels: Wanted | Sequence[Wanted],
        settings: Settings | None = None,
        **options: Unpack[SettingsKeywords],
    ) -> Callable[[Callable[[Progress], None]], Hierarchy]:
        """The work of a run as a function of what it reports to."""
        return partial(_hierarchy, fine, listed_levels(levels), Settings.of(settings, **options), cls.side)

    @property
    def hierarchy(self) -> Hierarchy:
        """The result; RuntimeError before the run is over."""
        return self.result


class InnerCagesRun(NestedCagesRun):
    """The work of :func:`inner_cages` as an iterator over its progress; dropping it cancels the work."""

    side = -1


def _hierarchy(
    fine: MeshLike, levels: Sequence[Wanted], settings: Settings, side: int, report: Callable[[Progress], None]
) -> Hierarchy:
    """All levels; where one finds no room, all are made again, with room between their loops."""
    deadline = perf_counter() + (inf if settings.seconds is None else settings.seconds)
    if side < 0 and settings.loops == "one":
        raise NestingError('Inner cages keep all loops; leave out loops="one".', code="setting.conflict")
    keeps = side < 0 or settings.loops == "keep"
    fine, wanted = _checked(fine, levels, side, convex=settings.convex, keeps=keeps)
    about = _about(settings, fine, side)
    asked, clearances = constraints_of(settings, about, side), clearances_for(settings, fine)
    every = _Levels(about, asked, settings, len(wanted), clearances, keeps, side, deadline, report)
    failure: NestedCagesError | None = None
    for room in (0.0, ROOM_OF_A_LEVEL):
        made: list[Level] = []
        try:
            for index, target in enumerate(wanted):
                inner = made[-1].cage if made else fine
                made.append(every.level(index, target, inner, apart=room * (len(wanted) - 1 - index)))
                logger.debug("level %d: %s", index, made[-1].report)
            return Hierarchy(fine, tuple(made))
        except NestedCagesError as error:
            error.partial = Hierarchy(fine, tuple(made))
            failure = failure or error
            # the levels before may have taken the room between their loops
            if error.code != "clearance.no_room" or not made or not isinstance(settings.tightening, Tightening):
                break
    assert failure is not None
    raise failure


class _Levels(NamedTuple):
    """What the levels of a run have in common."""

    about: Mesh
    asked: Asked
    settings: Settings
    number: int
    """How many there are."""
    clearances: tuple[float, ...]
    """To try in turn, in the input's units."""
    keeps: bool
    """Whether all loops are kept."""
    side: int
    deadline: float
    report: Callable[[Progress], None]

    def level(self, index: int, target: int | Mesh | Within, inner: Mesh, *, apart: float) -> Level:
        """One level, with more vertices where its number may rise; apart: see `Tightening`."""
        settings = self.settings
        if apart > 0.0:
            settings = replace(settings, tightening=replace(settings.tightening, apart=apart))
        watch = Watch(
            index,
            self.number,
            self.report,
            seconds=settings.seconds,
            deadline=self.deadline,
            most=MOST_STEPS + STEPS_OF_A_LOOP * len(inner.loops),
        )
        plan = Plan.of(inner, self.asked.constraints, self.asked.importance, side=self.side)
        along = isinstance(target, int) and not self.keeps and not settings.convex
        work = Work(plan, settings, self.clearances, watch, along)
        while True:
            try:
                if isinstance(target, Within):
                    from .fewest import fewest

                    level = fewest(target, self.about, work)
                else:
                    level = build_level(work, target)
                break
            except OutOfTimeError:
                raise
            except NestedCagesError as error:
                if not isinstance(target, Rising):
                    raise
                target = target.after(error)  # more vertices each time, and at most those of the mesh
        notes = (*self.asked.notes, *level.report.notes, *(target.notes() if isinstance(target, Rising) else ()))
        count = len(level.cage.vertices)
        asked = (
            len(target.vertices) if isinstance(target, Mesh) else count if isinstance(target, Within) else int(target)
        )
        if count < asked and not any(each.code == "note.count" for each in notes):
            notes += (note("note.count", on="fewer", asked=asked, given=count),)
        return replace(level, report=replace(level.report, notes=(*notes, *watch.note)))


def _about(settings: Settings, fine: Mesh, side: int) -> Mesh:
    """The mesh that the settings are about. Raises NestingError if it is no mesh inside the fine one, or around it."""
    if settings.about is None or settings.about is fine:
        return fine
    about = settings.about.validated()
    same = np.array_equal(about.vertices, fine.vertices) and np.array_equal(about.edges, fine.edges)
    if not same and not verify(*outer_and_inner(fine, about, side), same_loops=False):
        raise NestingError(
            f"The mesh that the settings are about does not lie {'in' if side > 0 else 'around'} the fine one.",
            code="coarse.not_nested",
        )
    return about


def _checked(
    fine: MeshLike, levels: Sequence[Wanted], side: int, *, convex: bool, keeps: bool
) -> tuple[Mesh, list[int | Mesh | Within]]:
    """The fine mesh and the levels, all meshes validated.

    NestingError for levels that no cage can have, InvalidMeshError for moved meshes that are not valid any more.
    """
    if not is_mesh_like(fine):
        raise NestingError(f"The fine mesh must be {MESH_LIKE}, not {type(fine).__name__}.", code="mesh.unreadable")
    fine = Mesh.of(fine, inside=side < 0).validated()
    checked: list[int | Mesh | Within] = []
    loops = len(fine.loops) if keeps and not convex else 1  # convex cages have this many vertices around each part
    for number, asked in enumerate(in_order(levels, len(fine.vertices)), start=1):
        (level,) = wanted_levels([asked], fine, keeps=keeps) if isinstance(asked, Share) else [asked]
        if isinstance(level, Within):
            checked.append(level)
        elif is_mesh_like(level):
            if convex:
                raise NestingError(
                    "A convex cage needs a number of vertices, not a coarse mesh.", code="setting.conflict"
                )
            mesh = Mesh.of(level).validated()
            loops = len(mesh.loops) if keeps else 1
            checked.append(mesh)
        elif isinstance(level, (int, np.integer)) and not isinstance(level, bool):
            count = level.raised(MIN_PER_LOOP * loops) if isinstance(level, Rising) else int(level)
            if count < MIN_PER_LOOP * loops:
                raise NestingError(
                    f"Level {number} asks for {count} vertices, but {loops} loop{'s need' if loops > 1 else ' needs'} "
                    f"at least {MIN_PER_LOOP * loops}{f', {MIN_PER_LOOP} each' if loops > 1 else ''}.",
                    code="count.too_small",
                    total=count,
                    least=MIN_PER_LOOP * loops,
                )
            checked.append(count)
        else:
            raise NestingError(
                f"Level {number} must be a number of vertices, a Mesh or Within(…), not {level!r}.",
                code="setting.invalid",
            )
    if not checked:
        raise NestingError("There are no levels: give at least one vertex count or coarse mesh.", code="level.invalid")
    return fine, checked
