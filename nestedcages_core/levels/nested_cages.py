"""Nested cages, level by level."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..errors import NestedCagesError, NestingError, note
from ..geometry.mesh import MESH_LIKE, Mesh, MeshLike, is_mesh_like, outer_and_inner
from ..progress import listened
from ..tightening import Tightening
from ..tolerance.within import Within
from ..verification import verify
from .build import Maker, build_level
from .constraints import Asked, constraints_of
from .plan import Plan
from .progress import OutOfTimeError, Progress, Watch
from .report import Hierarchy, Level
from .settings import Settings
from .targets import Rising, Share, Wanted, in_order, is_count, wanted_levels
from .work import Work, clearances_for, methods_for

if TYPE_CHECKING:
    from .keywords import SettingsKeywords

logger = logging.getLogger(__name__)

MOST_STEPS, STEPS_OF_A_LOOP = 10_000, 50
"""Steps of work that a level may take, and more for each loop of the shape. Usual ones take 10 to 150, and 5 a loop."""

ROOM_OF_A_LEVEL = 2.5
"""Distance between loops, in clearances, that leaves room for those of a further level: 2 fit exactly."""

Target = int | Mesh | Within
"""A level that was checked."""


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
    return listened(making(fine, levels, 1, settings, **options), progress)


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
    return listened(making(fine, levels, -1, settings, **options), progress)


def making(
    fine: MeshLike,
    levels: Wanted | Sequence[Wanted],
    side: int,
    settings: Settings | None = None,
    **options: Unpack[SettingsKeywords],
) -> Callable[[Callable[[Progress], None]], Hierarchy]:
    """What makes cages around a mesh (side 1) or inside it (-1), as a function of what it reports to."""
    return partial(_hierarchy, fine, listed_levels(levels), side, Settings.of(settings, **options))


def listed_levels(levels: Wanted | Sequence[Wanted]) -> list[Any]:
    """The levels as a list, with texts read; a single one needs none. Raises NestedCagesError."""
    single = int, np.integer, Share, Within, Mesh, Mapping, str
    is_loop = isinstance(levels, np.ndarray) and levels.ndim == 2
    if isinstance(levels, single) or hasattr(levels, "__geo_interface__") or is_loop:
        given: Iterable[Any] = [levels]
    elif isinstance(levels, Iterable):
        given = levels
    else:
        raise NestingError(
            f'A level must be a vertex count, a text such as "8%", a Mesh or Within(…), for instance [64, 16], not '
            f"{levels!r}.",
            code="level.invalid",
        )
    return [read for level in given for read in (_parsed(level) if isinstance(level, str) else [level])]


def _parsed(text: str) -> list[int | Share | Within]:
    from .level_text import level_words, parse_level

    return [parse_level(word) for word in level_words(text) or [text]]


def _hierarchy(
    fine: MeshLike, levels: Sequence[Wanted], side: int, settings: Settings, report: Callable[[Progress], None]
) -> Hierarchy:
    """All levels; where one finds no room, all are made again, with room between their loops."""
    deadline = perf_counter() + (inf if settings.seconds is None else settings.seconds)
    if side < 0 and settings.loops == "one":
        raise NestingError('Inner cages keep all loops; leave out loops="one".', code="setting.conflict")
    keeps = side < 0 or settings.loops == "keep"
    fine, targets = _checked(fine, levels, side, convex=settings.convex, keeps=keeps)
    about = _about(settings, fine, side)
    asked, clearances = constraints_of(settings, about, side), clearances_for(settings, fine)
    every = _Levels(about, asked, settings, len(targets), clearances, keeps, side, deadline, report)
    failure: NestedCagesError | None = None
    for room in (0.0, ROOM_OF_A_LEVEL):
        made: list[Level] = []
        try:
            for index, target in enumerate(targets):
                inner = made[-1].cage if made else fine
                made.append(every.level(index, target, inner, apart=room * (len(targets) - 1 - index)))
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

    def level(self, index: int, target: Target, inner: Mesh, *, apart: float) -> Level:
        """One level, with more vertices where its number may rise; apart: see `Tightening`."""
        settings, most = self.settings, MOST_STEPS + STEPS_OF_A_LOOP * len(inner.loops)
        if apart > 0.0:
            settings = replace(settings, tightening=replace(settings.tightening, apart=apart))
        watch = Watch(index, self.number, self.report, settings.seconds, self.deadline, most)
        plan = Plan.of(inner, self.asked.constraints, self.asked.importance, side=self.side)
        along = isinstance(target, int) and not self.keeps and not settings.convex
        work = Work(plan, methods_for(settings, plan), self.clearances, watch, along)
        while True:
            try:
                level = self._makes(work, target)(work, target).level
                break
            except OutOfTimeError:
                raise
            except NestedCagesError as error:
                from .explanations import explained

                refusal = explained(work, error) if isinstance(target, int) else error
                least = refusal.data.get("least", 0) if refusal.code == "count.too_small" else 0
                if not isinstance(target, Rising) or least <= target:
                    raise refusal from error.__cause__
                target = target.raised(int(least))  # at most the number of the mesh
        given, notes = len(level.cage.vertices), (*self.asked.notes, *level.report.notes)
        notes += target.notes() if isinstance(target, Rising) else ()
        asked = int(target) if isinstance(target, int) else len(target.vertices) if isinstance(target, Mesh) else given
        if given < asked and not any(each.code == "note.count" for each in notes):
            notes += (note("note.count", on="fewer", asked=asked, given=given),)
        watch.stop_clock()
        report = replace(level.report, seconds=dict(watch.seconds), notes=(*notes, *watch.note))
        return replace(level, report=report)

    def _makes(self, work: Work, target: int | Mesh | Within) -> Maker:
        """What makes the level of a target."""
        if isinstance(target, Within):
            from .fewest import fewest

            return partial(fewest, self.about, self._makes)
        if isinstance(target, Mesh) or not (work.plan.grid or (work.plan.has_wishes and work.compares)):
            return build_level
        from .fewer import tightest_on_grid, with_wishes

        return with_wishes if work.plan.grid is None else tightest_on_grid


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
) -> tuple[Mesh, list[Target]]:
    """The fine mesh and the levels, all meshes validated.

    NestingError for levels that no cage can have, InvalidMeshError for moved meshes that are not valid any more.
    """
    if not is_mesh_like(fine):
        raise NestingError(f"The fine mesh must be {MESH_LIKE}, not {type(fine).__name__}.", code="mesh.unreadable")
    fine = Mesh.of(fine, inside=side < 0).validated()
    checked: list[Target] = []
    loops = len(fine.loops) if keeps and not convex else 1  # convex cages have this many vertices around each part
    ordered = in_order(levels, len(fine.vertices))
    for number, level in enumerate(wanted_levels(ordered, fine, keeps=keeps), start=1):
        least = MIN_PER_LOOP * loops
        if isinstance(level, Within):
            checked.append(level)
        elif isinstance(level, Rising):
            checked.append(level.raised(least))
        elif is_mesh_like(level):
            if convex:
                raise NestingError(
                    "A convex cage needs a number of vertices, not a coarse mesh.", code="setting.conflict"
                )
            checked.append(mesh := Mesh.of(level).validated())
            loops = len(mesh.loops) if keeps else 1
        elif not is_count(level):
            raise NestingError(
                f"Level {number} must be a number of vertices, a Mesh or Within(…), not {level!r}.",
                code="setting.invalid",
            )
        elif int(level) < least:
            raise NestingError(
                f"Level {number} asks for {level} vertices, but {loops} loop{'s need' if loops > 1 else ' needs'} "
                f"at least {least}{f', {MIN_PER_LOOP} each' if loops > 1 else ''}.",
                code="count.too_small",
                total=int(level),
                least=least,
            )
        else:
            checked.append(int(level))
    if not checked:
        raise NestingError("There are no levels: give at least one vertex count or coarse mesh.", code="level.invalid")
    return fine, checked
