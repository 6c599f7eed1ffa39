"""The number of vertices of a cage on a grid: with ever fewer, the excess falls at first, then rises."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..errors import FlowError, NestingError, ReinflationError
from .draft import PAPER_PREFERENCE
from .progress import OutOfTimeError
from .report import Level
from .snap import UnsettledError
from .work import LOOSE_ON_GRID, Work, methods_for

FEWER = (3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 36, 40, 48, 56, 64, 80, 96, 128, 192, 256, 384, 512)
"""Numbers of vertices that are tried below the wanted one, where a vertex too many is moved outwards."""

CLEARLY_FEWER, STRIDE, TRIES_WITH_FEWER, NEAR = 0.8, 3, 3, 1.2
"""Up to which part of the number of vertices, and every which of these, is tried; how many of them may be no better;
excess of the best of them, relative to the least one, up to which those next to it are tried too."""

Make = Callable[[Work, int], tuple[Level, float]]
"""Makes the level of a number of vertices; returns it with the loss of the cage before it moved onto the grid."""


def tightest_on_grid(work: Work, count: int, make: Make) -> Level | None:
    """The tightest level found with at most a number of vertices; None if there is none."""
    first, off_grid = _made(work, count, make, None)
    if not np.isfinite(off_grid):
        return first
    still = replace(work, settings=methods_for(replace(work.settings, steps=False), work.plan))
    best = _tightest_of_fewer(still, count, make, first, off_grid)
    if best is None or best is first or work.rests or not work.settings.steps or work.watch.over is not None:
        return best
    moving, _ = _made(work, len(best.cage.vertices), make, None)
    return best if moving is None or work.merit(moving) > (1.0 + PAPER_PREFERENCE) * work.merit(best) else moving


def _tightest_of_fewer(work: Work, count: int, make: Make, best: Level | None, off_grid: float) -> Level | None:
    """The tightest level with fewer vertices than a number, or the best one so far."""
    number = count if best is None else min(count, len(best.cage.vertices))
    fewer = [each for each in FEWER if each < number]
    near, tries = dict[int, float](), TRIES_WITH_FEWER
    first = sum(each <= CLEARLY_FEWER * number for each in fewer) - 1
    for k in range(first, -1, -STRIDE):
        if tries == 0 or (best is not None and work.merit(best) <= (1.0 + LOOSE_ON_GRID) * off_grid):
            return best
        found, loss = _made(work, fewer[k], make, best)
        if found is not None:
            near[k] = work.loss(found)
            tries -= best is not None and work.loss(found) >= work.loss(best)
            best = min(found, best or found, key=work.merit)
        elif best is not None and loss >= work.loss(best):
            break
    if best is None or not near or min(near.values()) > NEAR * work.loss(best):
        return best
    k = min(near, key=lambda k: near[k])
    below = fewer[max(0, k - STRIDE + 1) : k] if near[k] <= work.loss(best) else []
    for number in (*below, *fewer[k + 1 : k + STRIDE]):
        found, _ = _made(work, number, make, best)
        best = min(found or best, best, key=work.merit)
    return best


def _made(work: Work, number: int, make: Make, best: Level | None) -> tuple[Level | None, float]:
    """The level of a number of vertices, if it may be tighter than the best one; and what it loses off the grid."""
    if work.watch.over is not None and best is not None:
        return None, np.inf
    try:
        return make(work if best is None else replace(work, below=work.loss(best)), number)
    except UnsettledError as error:
        return None, work.plan.side * (error.path.cage.area / work.plan.fine.area - 1.0)
    except (FlowError, ReinflationError, NestingError, OutOfTimeError):
        return None, np.inf
