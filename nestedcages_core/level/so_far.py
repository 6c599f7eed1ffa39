"""The best level of a builder whose time is over."""

from __future__ import annotations

from dataclasses import replace

from ..energies import signed_area
from ..errors import NestedCagesError
from ..tasks import Stage
from .assembly import CageInProgress
from .builder import FAILURES, LevelBuilder
from .report import Level, Progress


def best_so_far(builder: LevelBuilder) -> Stage[Progress, Level | None]:
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
            level = yield from builder.certified(at_once, cage, plan.outline.notes)
            break
        except FAILURES:
            continue
    try:
        if level is None:
            level = yield from builder.assembly.untightened(builder.starts, attempt.clearances, plan.outline.notes)
        if level is not None and builder.settling is not None:
            level = yield from builder.settling.hasty().settled(level)
        if level is not None and plan.outline.inner is not None:
            level = yield from builder.assembly.around(plan.outline.inner, level)
    except NestedCagesError:
        return None
    return level
