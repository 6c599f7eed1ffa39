"""One level, as in the paper: a coarse mesh, flow, reinflation, tightening, and a certificate.

Coarse meshes are tried in turn: where loops need not be kept, along the sequence of outlines, from the drawing to a box
around it, the tightest first. The fine mesh flows into the one on the curve and comes back, pushing the cage out; where
that is blocked, or looser than the enclosing mesh, the enclosing mesh is tightened: the fine mesh is inside already.

A cage inside has the unbounded region around it as its solid. Walked backwards, its loops are the oriented boundary of
that region, so start and solvers push it away from the fine mesh as they do with a cage outside.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from math import inf

from ..decimation import Count, Decimation, LineCycles, Start, Starts
from ..decimation.base import MIN_PER_LOOP
from ..decimation.cycle_search import OFFSET
from ..decimation.offset import is_wide, offset_loop_by_loop
from ..decimation.starts import Outlines, lacks_shapely
from ..energies import Area
from ..errors import Fault, FlowError, InvalidMeshError, NestedCagesError, NestingError, ReinflationError, note
from ..flow.matching import match_loops
from ..geometry.mesh import Mesh
from .draft import OWN, PAPER_PREFERENCE, at_rest, tight_draft
from .finish import finished
from .progress import OutOfTimeError
from .report import Level
from .work import LOOSE_ON_GRID, Draft, Work, methods_for

logger = logging.getLogger(__name__)

FAILURES = (FlowError, ReinflationError, NestingError, OutOfTimeError)
"""Errors after which another way or start is tried, while there is time; any other error ends the run."""

ON_CURVE = "on the curve"
"""What a start with its vertices on the fine mesh is called."""

NO_EXCESS = 3e-4
"""Excess up to which the clearance decides: a cage from flow and reinflation is not compared."""

FURTHER_ON_GRID = 2
"""Further starts along the sequence that are tried where they may be tighter on a grid."""

FEWER, TRIES_WITH_FEWER = 0.8, 8
"""Factor on the number of vertices where wishes are missed, and how many numbers are tried, the last by bisection."""

Offered = Iterator[tuple[Start, tuple[Fault, ...]]]
"""Starts, and what is to be said of each."""

Made = tuple[Level, float]
"""A level, and the loss of its cage before that moved onto certain numbers."""


def build_level(work: Work, target: int | Mesh) -> Level:
    """The level with at most a number of vertices, or from the user's own coarse mesh. Raises NestedCagesError."""
    work = replace(work, settings=methods_for(work.settings, work.plan))
    numbers = work.plan.numbers
    if numbers is None or numbers.grid is None or isinstance(target, Mesh):
        level = along_starts(work, target)[0]
        return with_fewer(work, level) if isinstance(target, int) and work.compares else level
    from .on_grid import tightest_on_grid

    found = tightest_on_grid(work, target, lambda of, count: along_starts(of, count, most=1))
    return along_starts(work, target)[0] if found is None else found


def with_fewer(work: Work, level: Level) -> Level:
    """A better level with fewer vertices, where there are too many for the wishes."""
    best, kept, missed = level, 0, len(level.cage.vertices)
    for _ in range(TRIES_WITH_FEWER if work.misses(level) else 0):
        count = (kept + missed) // 2 if kept else int(FEWER * missed)
        if count < max(MIN_PER_LOOP, kept + 1) or work.watch.over is not None:
            break
        with suppress(*FAILURES):
            other = along_starts(work, count)[0]
            best = min(best, other, key=work.merit)
            if not work.misses(other):
                kept = count
        if kept < count:
            missed = count
    return best


def along_starts(work: Work, target: int | Mesh, most: int | None = None) -> Made:
    """The level from the first start, of so many at most, that leads to one, or from a rival of it.

    Raises NestedCagesError.
    """
    failures, failed = list[NestedCagesError](), list[Mesh]()
    others = starts(work, target, failures)
    try:
        for start, notes in islice(others, most):
            try:
                made = with_room(work, start, notes)
            except FAILURES as failure:
                logger.debug("no level from %s: %s", start.source, failure)
                failures.append(failure)
                failed.append(start.coarse)
                if work.watch.over is not None:
                    break
            else:
                return best_of_rivals(work, made, (start, notes), others, failed)
    except FAILURES as failure:  # there is no start, or no other one
        failures.append(failure)
    if work.watch.over is not None:
        raise work.watch.over
    raise failures[0] if most else explained(work, target, failures[0])


def best_of_rivals(
    work: Work, made: Made, made_from: tuple[Start, tuple[Fault, ...]], others: Offered, failed: Sequence[Mesh]
) -> Made:
    """The best of a level and those from the rivals of its start, without meshes from which none could be made."""
    start, notes = made_from
    with suppress(*FAILURES):  # there is no other start
        for rival in rivals(work, start, others, made[0]):
            if all(rival.coarse is not mesh for mesh in failed):
                with suppress(*FAILURES):
                    made = min(made, with_room(work, rival, notes), key=lambda each: work.merit(each[0]))
    return made


def rivals(work: Work, start: Start, others: Offered, level: Level) -> Iterator[Start]:
    """Starts that may lead to a tighter cage: about as good, and on a grid further ones along the sequence."""
    if not work.compares or work.below < inf or start.source == OWN:
        return
    yield from start.rivals
    numbers = work.plan.numbers
    for other, _ in islice(others, FURTHER_ON_GRID if numbers is not None and numbers.grid is not None else 0):
        excess = other.coarse.area / work.plan.outline.mesh.area - 1.0
        if (1.0 + LOOSE_ON_GRID) * excess >= level.excess:
            return
        if all(other.coarse is not rival.coarse for rival in start.rivals):
            yield other


def with_room(work: Work, start: Start, notes: tuple[Fault, ...]) -> Made:
    """The level from a start, with more distance where its cage has no place on the numbers. Raises NestingError."""
    if work.plan.numbers is None:
        return level_from_start(work, start, notes)
    from .snap import UnsettledError, rooms

    unsettled: list[UnsettledError] = []
    for room in (0.0, *(rooms(work.plan.numbers) if work.below == inf else ())):
        try:
            return level_from_start(replace(work, room=room), start, notes)
        except UnsettledError as error:
            unsettled.append(error)
        except NestingError:
            if not unsettled:
                raise
            break
    raise unsettled[0]


def level_from_start(work: Work, start: Start, notes: tuple[Fault, ...]) -> Made:
    """The paper's way from the mesh on the curve; where that is blocked or looser, the enclosing mesh at rest; where no
    cage can be certified, that mesh as it is.

    Raises one of `FAILURES`.
    """
    start = work.plan.started(start)
    drafts, failures = list[Draft](), list[NestedCagesError]()
    for mesh in ways(work, start, drafts):
        try:
            drafts.append(tight_draft(work, mesh))
        except FAILURES as failure:
            logger.debug("start from %s failed: %s", mesh.source, failure)
            failures.append(failure)
    refusals = list[NestedCagesError]()
    through = start.on_curve is None or any(draft.start.source == ON_CURVE for draft in drafts)
    blocked = [each for each in failures[:1] if not through and not isinstance(each, OutOfTimeError)]
    stands = work.settings.fallback is not None or start.on_curve is None
    last = [replace(at_rest(work, start), still=True)] if stands else []
    for draft in (*sorted(drafts, key=lambda draft: draft.rank), *last):
        said = notes
        if blocked and draft.start is start and not draft.still:
            on = "flow" if isinstance(blocked[0], FlowError) else "reinflation"
            said = (*notes, note("note.start", on=on, source=start.source, first=ON_CURVE))
        try:
            return finished(work, draft, said), draft.excess
        except NestingError as refusal:
            refusals.append(refusal)
    raise (failures or refusals)[0] if not drafts else refusals[0]


def ways(work: Work, start: Start, drafts: Sequence[Draft]) -> Iterator[Start]:
    """The meshes of a start that are worth trying: that on the curve, and the enclosing one.

    drafts: the cages so far.
    """
    fine = work.plan.outline.mesh
    if start.on_curve is not None:
        yield Start(start.on_curve, ON_CURVE)
        if work.settings.fallback is None:
            return
        # lines keep a little away from the fine mesh, beyond the clearance
        away = max(0.0, OFFSET * fine.diagonal - work.clearances[0]) * float(start.coarse.edge_lengths.sum())
        enclosing = (start.coarse.area - away) / fine.area - 1.0
        enough = max((1.0 + PAPER_PREFERENCE) * enclosing, NO_EXCESS) if isinstance(work.settings.energy, Area) else inf
        if drafts and drafts[0].rank <= enough:
            return
    yield start


def starts(work: Work, target: int | Mesh, failures: Sequence[NestedCagesError]) -> Offered:
    """Coarse meshes to begin with, the best first, and what is to be said of them. Raises NestingError.

    failures: of those handed out so far; the caller adds to them.
    """
    plan, settings, fine = work.plan, work.settings, work.plan.outline.mesh
    tried: Decimation | None = None
    notes = plan.outline.notes
    if isinstance(target, Mesh):
        if plan.side > 0 or plan.verify(target, 0.0):
            yield Start(target, OWN), notes
        else:
            said = "The coarse mesh does not lie strictly inside the fine one, loop by loop"
            outside = NestingError(f"{said}; move it inside, or give a vertex count.", code="coarse.not_nested")
            failures = [outside]
        count = _counts_like(target, fine)
    else:
        clearance, tried = work.clearances[0], settings.decimation
        count, clamped = plan.possible(target, unlimited=work.along and is_wide(fine, target, clearance))
        notes += clamped
        if work.along and lacks_shapely(fine, target, clearance):
            notes += (note("note.library", library="shapely"),)
        try:
            for start in decimated(work, tried, count):
                yield start, notes
                if settings.fallback is None:
                    return
        except NestingError as failure:
            failures = [*failures, failure]
    other = settings.fallback
    if not failures:
        return
    if other is None or (isinstance(tried, LineCycles) and isinstance(other, LineCycles)):
        raise failures[0]
    for start in decimated(work, other, count):
        told = (*notes, note("note.start", on="fallback", source=start.source, text=str(failures[0])))
        numbers = [len(loop) for loop in start.coarse.loops]
        if not isinstance(count, int) and numbers != list(count):
            told = (*told, note("note.count", on="loops", asked=count, given=numbers))
        yield start, told


def decimated(work: Work, decimation: Decimation, count: Count) -> Iterator[Start]:
    """The coarse meshes of a decimation, along the sequence of outlines. Raises NestingError."""
    work.watch.begin("decimation")
    outline, clearance = work.plan.outline.mesh, work.clearances[0]
    tick, kept = work.watch.tick("decimation"), work.plan.kept()
    if isinstance(decimation, LineCycles) and work.along and isinstance(count, int):
        outlines = Outlines(outline, count, clearance, kept, decimation, tick)
        yield from outlines.starts(one_loop=work.settings.loops == "one")
        return
    if isinstance(decimation, LineCycles):  # at large clearances
        wide = offset_loop_by_loop(outline, clearance, work.plan.side)
        with suppress(NestingError, InvalidMeshError):
            yield from () if wide is None else decimation.outside.starts(wide, count, kept=kept, tick=tick)
    if isinstance(decimation, Starts):
        yield from decimation.starts(outline, count, clearance=clearance, kept=kept, tick=tick)
    else:
        name = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(decimation).__name__).lower()
        yield Start(decimation.decimate(outline, count, clearance=clearance), name)


def explained(work: Work, target: int | Mesh, failure: NestedCagesError) -> NestedCagesError:
    """An error with what would help: the least number of vertices, or a grid."""
    if work.plan.numbers is not None:
        from .snap import UnsettledError, with_finer_grid

        if isinstance(failure, UnsettledError):
            return with_finer_grid(failure, work.plan, work.settings.energy, work.watch)
    if isinstance(target, Mesh) or not work.plan.is_free:
        return failure
    from .least_count import with_least

    return with_least(failure, work.settings.decimation, work.plan.outline.mesh, work.clearances, work.plan.side)


def _counts_like(coarse: Mesh, fine: Mesh) -> Count:
    """The vertices of each loop of a coarse mesh, in the order of those of the fine one, or their total where its loops
    are others."""
    total = max(len(coarse.vertices), 3 * len(fine.loops))
    if len(coarse.loops) != len(fine.loops):
        return total
    try:
        return [len(coarse.loops[k]) for k in match_loops(fine, coarse).partner]
    except FlowError:
        return total
