"""Fewer vertices than asked for, where a cage is better with them.

On a grid the excess falls at first, with ever fewer vertices, and then rises. Least edges and angles need room.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from math import inf

from ..decimation.base import MIN_PER_LOOP
from .build import LOOSE_ON_GRID, Candidate, build_level
from .certify import UnsettledError
from .draft import PAPER_PREFERENCE
from .work import FAILURES, Work, methods_for

COUNTS = (3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 36, 40, 48, 56, 64, 80, 96, 128, 192, 256, 384, 512)
"""Numbers of vertices that are tried below the wanted one, where a vertex too many is moved outwards."""

SMALLER, TRIES_FOR_WISHES = 0.8, 8
"""Factor on the number of vertices where wishes are missed, and how many numbers are tried, the last by bisection."""

CLEARLY_FEWER, TRIES = 0.9, 3
"""Up to which part of the number of vertices others are tried, and how many of them may be no better."""


def tightest_on_grid(work: Work, count: int) -> Candidate:
    """The tightest level found with at most a number of vertices. Raises NestedCagesError."""
    first, off_grid = _made(work, count)
    best = first
    if off_grid == inf:
        return build_level(work, count)
    still = replace(work, settings=methods_for(replace(work.settings, steps=False), work.plan))
    number, tries = count if best is None else min(count, len(best.level.cage.vertices)), TRIES
    for fewer in reversed([each for each in COUNTS if each <= CLEARLY_FEWER * number]):
        if tries == 0 or work.watch.over is not None:
            break
        if best is not None and work.merit(best.level) <= (1.0 + LOOSE_ON_GRID) * off_grid:
            break
        below = inf if best is None else work.plan.side * best.level.excess
        other, _ = _made(replace(still, below=below), fewer)
        if other is not None and (best is None or work.merit(other.level) < work.merit(best.level)):
            best = other
        elif best is not None:
            tries -= 1
    if best is None:
        return build_level(work, count)
    if best is first or work.rests or not work.settings.steps or work.watch.over is not None:
        return best
    moving, _ = _made(work, len(best.level.cage.vertices))
    if moving is None or work.merit(moving.level) > (1.0 + PAPER_PREFERENCE) * work.merit(best.level):
        return best
    return moving


def with_wishes(work: Work, count: int) -> Candidate:
    """The level with at most a number of vertices, or with the most that leave room for the wishes, if that is better.

    Raises NestedCagesError.
    """
    best = build_level(work, count)
    kept, missed = 0, len(best.level.cage.vertices)
    for _ in range(TRIES_FOR_WISHES if work.misses(best.level) else 0):
        number = (kept + missed) // 2 if kept else int(SMALLER * missed)
        if number < max(MIN_PER_LOOP, kept + 1) or work.watch.over is not None:
            break
        with suppress(*FAILURES):
            other = build_level(work, number)
            best = min(best, other, key=lambda each: work.merit(each.level))
            if not work.misses(other.level):
                kept = number
        if kept < number:
            missed = number
    return best


def _made(work: Work, count: int) -> tuple[Candidate | None, float]:
    """The level of a number of vertices from the first start, if there is one; and what it loses off the grid."""
    try:
        made = build_level(work, count, most=1)
    except UnsettledError as error:
        return None, error.excess
    except FAILURES:
        return None, inf
    return made, made.excess
