"""The steps of a finished level on other numbers, or with a flow that goes on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..contact.reinflation import Reinflation
from ..errors import NestingError
from ..flow.shrinking import shrink
from ..geometry.lattice import as_stored
from .certify import Path, rerouted
from .report import Level


def with_stored_steps(level: Level, stored: str) -> Level:
    """The level with all of its steps as a type holds them, and its motion certified on these numbers.

    The fine mesh keeps its coordinates. Where rounding closes a gap during the flow, the steps up to there belong to
    the flow, and the coarse mesh is the cage after them.
    """
    way, first = level.reinflation, 0
    flow, moving, cages = (as_stored(steps, stored) for steps in (level.flow.steps, way.moving_steps, way.cage_steps))
    flow[0] = moving[-1] = level.fine.vertices
    moving[0] = flow[-1]
    while True:
        away = min(first, len(moving) - 1)
        later = Path(
            level.coarse.moved(cages[first]),
            replace(level.flow, steps=np.concatenate([flow, moving[1 : away + 1]])),
            Reinflation(moving[away:], cages[first:], way.iterations),
        )
        try:
            return rerouted(level, later, stored)
        except NestingError as error:
            if error.code != "motion.collides":
                raise
            first += error.data["step"] + 1


def shrunk(level: Level) -> Level:
    """The level with a fine mesh that shrinks on inside the coarse one, as an animation shows it, and comes back before
    the reinflation; the same level if it lies inside, or where there is no room.
    """
    if level.side < 0:
        return level
    way, stored = level.reinflation, level.report.stored
    further = as_stored(shrink(level.fine, level.coarse, level.flow.steps[-1]), stored)
    standing = np.broadcast_to(level.coarse.vertices, (len(further), *level.coarse.vertices.shape))
    longer = Path(
        level.coarse,
        replace(level.flow, steps=np.concatenate([level.flow.steps, further])),
        Reinflation(
            np.concatenate([further[::-1], way.moving_steps]),
            np.concatenate([standing, way.cage_steps]),
            way.iterations,
        ),
    )
    try:
        return rerouted(level, longer, stored) if len(further) else level
    except NestingError as error:
        if error.code != "motion.collides":
            raise
        return level
