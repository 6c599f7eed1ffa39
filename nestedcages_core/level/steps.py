"""The steps of a finished level on other numbers, or with a flow that goes on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation
from ..flow.shrinking import shrink
from ..geometry.arrays import FloatArray
from ..verification.motion import certify_motion
from .report import Level


def as_stored(points: FloatArray, stored: str | None) -> FloatArray:
    """Points (..., 2) as a type of numpy holds them; None: as they are."""
    return points if stored is None else points.astype(stored).astype(np.float64)


def with_stored_steps(level: Level) -> Level:
    """The level with all of its steps on the numbers of its report, and its motion certified on these.

    The fine mesh keeps its coordinates. Where rounding closes a gap during the flow, the steps up to there belong to
    the flow, and the coarse mesh is the cage after them.
    """
    stored, way = level.report.stored, level.reinflation
    flow, moving = (as_stored(steps, stored) for steps in (level.flow.steps, way.moving_steps))
    cages = as_stored(way.cage_steps, stored)
    flow[0] = moving[-1] = level.fine.vertices
    moving[0] = flow[-1]
    bodies, first = Bodies.of(level.cage, level.fine), 0
    rounded = Reinflation(moving, cages, way.iterations)
    while not (found := certify_motion(bodies, list(cages[first:]), rounded.fine_path[first:])):
        assert found.step is not None
        first += found.step + 1
    away = min(first, len(moving) - 1)
    return replace(
        level,
        coarse=level.coarse.moved(cages[first]),
        flow=replace(level.flow, steps=np.concatenate([flow, moving[1 : away + 1]])),
        reinflation=Reinflation(moving[away:], cages[first:], way.iterations),
    )


def shrunk(level: Level) -> Level:
    """The level with a fine mesh that shrinks on inside the coarse one, as an animation shows it, and comes back before
    the reinflation; the same level if it lies inside, or where there is no room.
    """
    if level.side < 0:
        return level
    start, way = level.flow.steps[-1], level.reinflation
    further = as_stored(shrink(level.fine, level.coarse, start), level.report.stored)
    standing = np.broadcast_to(level.coarse.vertices, (len(further) + 1, *level.coarse.vertices.shape))
    inwards = [start, *further]
    if not len(further) or not certify_motion(Bodies.of(level.cage, level.fine), list(standing), inwards):
        return level
    return replace(
        level,
        flow=replace(level.flow, steps=np.concatenate([level.flow.steps, further])),
        reinflation=Reinflation(
            np.concatenate([further[::-1], way.moving_steps]),
            np.concatenate([standing[:-1], way.cage_steps]),
            way.iterations,
        ),
    )
