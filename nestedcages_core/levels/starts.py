"""The coarse meshes that a level may start from, the best first."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from itertools import chain, islice, repeat

from ..decimation import Count, Decimation, LineCycles, Start, Starts
from ..decimation.offset import is_wide, offset_loop_by_loop
from ..decimation.starts import Outlines, lacks_shapely
from ..errors import Fault, FlowError, InvalidMeshError, NestedCagesError, NestingError, note
from ..flow.matching import match_loops
from ..geometry.mesh import Mesh
from .draft import OWN
from .work import Work

Notes = tuple[Fault, ...]


def starts(work: Work, target: int | Mesh, refusals: list[NestedCagesError]) -> Iterator[tuple[Start, Notes]]:
    """The user's own coarse mesh, or those of a decimation with at most a number of vertices, and what is to be said of
    them; if there are refusals by then, those of the fallback.

    refusals: of starts so far; the caller adds to them, and so do decimations that have none.
    """
    plan, settings, fine = work.plan, work.settings, work.plan.outline.mesh
    if isinstance(target, Mesh):
        nested = plan.side > 0 or bool(plan.verify(target, 0.0))
        if not nested:
            said = "The coarse mesh does not lie strictly inside the fine one, loop by loop"
            refusals.append(NestingError(f"{said}; move it inside, or give a vertex count.", code="coarse.not_nested"))
        own, notes = repeat(Start(target, OWN), int(nested)), plan.outline.notes
        return chain(zip(own, repeat(notes)), _of_fallback(work, None, _counts_like(target, fine), notes, refusals))
    clearance = work.clearances[0]
    count, clamped = plan.possible(target, unlimited=work.along and is_wide(fine, target, clearance))
    notes = (*plan.outline.notes, *clamped)
    if work.along and lacks_shapely(fine, target, clearance):
        notes += (note("note.library", library="shapely"),)
    first = islice(decimated(work, settings.decimation, count, refusals), None if settings.fallback else 1)
    return chain(zip(first, repeat(notes)), _of_fallback(work, settings.decimation, count, notes, refusals))


def _of_fallback(
    work: Work, tried: Decimation | None, count: Count, notes: Notes, refusals: list[NestedCagesError]
) -> Iterator[tuple[Start, Notes]]:
    """Starts of another decimation than the one that was tried, if that was refused."""
    other = work.settings.fallback
    if not refusals or other is None or (isinstance(tried, LineCycles) and isinstance(other, LineCycles)):
        return
    for start in decimated(work, other, count, refusals):
        why = note("note.start", on="fallback", source=start.source, text=str(refusals[0]))
        numbers = [len(loop) for loop in start.coarse.loops]
        again = not isinstance(count, int) and numbers != list(count)
        yield start, (*notes, why, *([note("note.count", on="loops", asked=count, given=numbers)] if again else []))


def decimated(work: Work, decimation: Decimation, count: Count, refusals: list[NestedCagesError]) -> Iterator[Start]:
    """The coarse meshes of a decimation, along the sequence of outlines; why there are no more goes to the refusals."""
    work.watch.begin("decimation")
    outline, clearance = work.plan.outline.mesh, work.clearances[0]
    tick, kept = work.watch.tick("decimation"), work.plan.kept()
    try:
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
    except NestingError as refusal:
        refusals.append(refusal)


def _counts_like(coarse: Mesh, fine: Mesh) -> Count:
    """The vertices of each loop of a coarse mesh, in the order of those of the fine one, or their total where its loops
    are others."""
    if len(coarse.loops) == len(fine.loops):
        with suppress(FlowError):
            return [len(coarse.loops[k]) for k in match_loops(fine, coarse).partner]
    return max(len(coarse.vertices), 3 * len(fine.loops))
