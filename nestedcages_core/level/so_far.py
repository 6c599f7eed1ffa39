"""The best level of a builder whose time or work is over."""

from __future__ import annotations

from dataclasses import replace

from ..energies import signed_area
from ..errors import Fault, NestedCagesError, note
from .assembly import CageInProgress
from .builder import FAILURES, LevelBuilder
from .report import Level, Progress


def best_so_far(builder: LevelBuilder) -> Level | None:
    """The best cage that a builder has by now, as a certified level; None if there is none.

    The tightening is taken as far as it is; without any, a start that is a cage. On a grid the first places do.
    """
    plan, attempt, cages = builder.plan, builder.attempt, list(builder.cages)
    if attempt is None:
        return None
    if builder.at_work is not None:
        cage, steps = builder.at_work
        cages.append(replace(cage, tightened=cage.untightened.with_tightening(steps)))

    def size(cage: CageInProgress) -> float:
        return plan.side * signed_area(cage.reinflation.cage_steps[-1], cage.unit_coarse.successor)

    level: Level | None = None
    at_once = replace(attempt, clearances=attempt.clearances[:1])
    for cage in sorted(cages, key=size):
        try:
            level = builder.certified(at_once, cage, plan.outline.notes)
            break
        except FAILURES:
            continue
    try:
        if level is None and builder.start is not None:
            level = builder.assembly.untightened(builder.start, attempt.clearances, plan.outline.notes)
        if level is not None and builder.settling is not None:
            level = builder.settling.hasty().settled(level)
        if level is not None and plan.outline.inner is not None:
            level = builder.assembly.around(plan.outline.inner, level)
    except NestedCagesError:
        return None
    return level


def over(reached: Progress, *, seconds: float | None = None, steps: int = 0) -> NestedCagesError:
    """The error when the time, or the steps of work that a level may take, are over."""
    stage = f"{reached.message[:1].lower()}{reached.message[1:]}"
    place = {"level": reached.level, "stage": reached.stage}
    if seconds is not None:
        said = (
            f"The time of {seconds:g} s was over during {stage}; give more seconds, or ask for fewer or easier levels"
        )
        return NestedCagesError(f"{said}.", code="time.over", seconds=seconds, **place)
    said = f"No cage was found in {steps} steps of work, which ended during {stage}; ask for another number of vertices"
    return NestedCagesError(f"{said}.", code="work.over", steps=steps, **place)


def note_on(error: NestedCagesError) -> Fault:
    """The note on a cage that is the best by then."""
    return note("note.time" if error.code == "time.over" else "note.work", **error.data)
