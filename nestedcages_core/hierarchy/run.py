"""Nested cages, level by level."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING, Unpack

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..errors import Fault, NestedCagesError, NestingError, note
from ..geometry.mesh import MESH_LIKE, Mesh, MeshLike, by_side, is_mesh_like
from ..level.attempts import clearances_for
from ..level.builder import LevelBuilder
from ..level.gate import passed
from ..level.plan import Plan
from ..level.report import Hierarchy, Level, LevelProgress, Progress
from ..progress import Run, listened
from ..tightening import Tightening
from ..tolerance.within import Within
from ..verification import verify
from .asked import Wanted, in_order, listed_levels
from .constraints import constraints_of
from .levels import Rising, Share, wanted_levels
from .loops import keeps_loops, with_loops
from .settings import Settings

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
    ``report.excess`` is negative. A user's own mesh, from which the cage starts, must lie inside. The settings `flow`
    and `contact` are not used, nor is a decimation other than `LineCycles`. Errors are those of `nested_cages`.
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
    """All levels."""
    seconds = inf if settings.seconds is None else settings.seconds
    deadline = perf_counter() + seconds
    keeps = keeps_loops(settings, side)
    fine, wanted = _checked(fine, levels, convex=settings.convex, keeps=keeps)
    about = _about(settings, fine, side)
    constraints, importance, remarks = constraints_of(settings, about, side)

    def made(index: int, level: int | Mesh | Within, inner: Mesh, chosen: Settings) -> Level:
        clearances, late = clearances_for(chosen, fine), tuple[Fault, ...]()
        if isinstance(level, int) and not keeps:
            chosen = with_loops(chosen)
        while True:
            plan = Plan.of(inner, constraints, importance, side=side)
            limits = _Limits(seconds, deadline, MOST_STEPS + STEPS_OF_A_LOOP * len(inner.loops), report)
            progress = LevelProgress(index, len(wanted), limits.report)
            builder = LevelBuilder(plan, clearances, chosen, progress)
            if isinstance(level, Within):
                from ..tolerance.fewest import fewest

                work = partial(fewest, level, about, builder, strictly=chosen.clearance or 0.0)
            else:
                work = partial(builder.build, level)
            try:
                done = passed(work(), inner, chosen.clearance or 0.0)
                break
            except NestedCagesError as error:
                if error.code in ("time.over", "work.over"):
                    from ..level.so_far import best_so_far, note_on

                    limits.over = True
                    found = builder.best if isinstance(level, Within) else best_so_far(builder)
                    if found is None:
                        raise
                    done = passed(found, inner, chosen.clearance or 0.0)
                    late = (note_on(error),)
                    break
                if not isinstance(level, Rising):
                    raise
                level = level.after(error)  # more vertices each time, and at most those of the mesh
        advised = level.notes() if isinstance(level, Rising) else ()
        told = any(each.code == "note.count" for each in done.report.notes)
        if isinstance(level, int) and len(done.cage.vertices) < level and not told:
            advised += (note("note.count", on="fewer", asked=int(level), given=len(done.cage.vertices)),)
        notes: Sequence[Fault] = (*remarks, *done.report.notes, *advised, *late)
        return replace(done, report=replace(done.report, notes=notes))

    failure: NestedCagesError | None = None
    while True:
        finished: list[Level] = []
        try:
            for index, level in enumerate(wanted):
                chosen = settings if failure is None else _with_room(settings, len(wanted) - 1 - index)
                finished.append(made(index, level, finished[-1].cage if finished else fine, chosen))
                logger.debug("level %d: %s", index, finished[-1].report)
            return Hierarchy(fine, tuple(finished))
        except NestedCagesError as error:
            if failure is not None:
                raise failure from error
            error.partial = Hierarchy(fine, tuple(finished))
            if error.code != "clearance.no_room" or not finished or not isinstance(settings.tightening, Tightening):
                raise
            failure = error  # the levels before may have taken the room between their loops


def _with_room(settings: Settings, levels: int) -> Settings:
    """The settings of a level that leaves room for that many levels around it."""
    return replace(settings, tightening=replace(settings.tightening, apart=ROOM_OF_A_LEVEL * levels))


class _Limits:
    """Passes on progress until the time or the steps of a level are over, which raises NestedCagesError once."""

    def __init__(self, seconds: float, deadline: float, steps: int, report: Callable[[Progress], None]) -> None:
        self.seconds, self.deadline, self.steps, self._report = seconds, deadline, steps, report
        self.over = False
        """Whether what has been reached is brought to its end, without limit."""
        self._reported = 0

    def report(self, reached: Progress) -> None:
        """Pass on progress."""
        self._reported += 1
        late = perf_counter() > self.deadline
        if not self.over and (late or self._reported > self.steps):
            from ..level.so_far import over

            raise over(reached, seconds=self.seconds if late else None, steps=self.steps)
        self._report(reached)


def _about(settings: Settings, fine: Mesh, side: int) -> Mesh:
    """The mesh that the settings are about. Raises NestingError if it is no mesh inside the fine one, or around it."""
    if settings.about is None or settings.about is fine:
        return fine
    about = settings.about.validated()
    same = np.array_equal(about.vertices, fine.vertices) and np.array_equal(about.edges, fine.edges)
    if not same and not verify(*by_side(fine, about, side), same_loops=False):
        raise NestingError(
            f"The mesh that the settings are about does not lie {'in' if side > 0 else 'around'} the fine one.",
            code="coarse.not_nested",
        )
    return about


def _checked(
    fine: MeshLike, levels: Sequence[Wanted], *, convex: bool, keeps: bool
) -> tuple[Mesh, list[int | Mesh | Within]]:
    """The fine mesh and the levels, all meshes validated.

    NestingError for levels that no cage can have, InvalidMeshError for moved meshes that are not valid any more.
    """
    if not is_mesh_like(fine):
        raise NestingError(f"The fine mesh must be {MESH_LIKE}, not {type(fine).__name__}.", code="mesh.unreadable")
    fine = Mesh.of(fine).validated()
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
