"""Distances and excesses as levels: requested with a margin for Blender's rounding, measured as stored."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeAlias

import numpy as np

from ..core import core, tolerance
from ..errors import UserError
from .storage import CageLevel

Level: TypeAlias = "int | core.Mesh | core.Within"


def stricter(level: Level, drawing: core.Mesh, slack: float) -> Level:
    """A stricter tolerance, so that points may move by a slack in the drawing's units. Raises: UserError if nothing is
    left."""
    if not isinstance(level, core.Within):
        return level
    if level.distance is not None:
        if level.distance <= slack:
            raise UserError(f"A distance must be more than {slack:.3g}, what Blender's single precision can tell apart")
        return replace(level, distance=level.distance - slack)
    boundary = float(np.hypot(*(drawing.edge_ends - drawing.vertices).T).sum())
    excess = level.limit - slack * boundary / drawing.area
    if excess <= 0.0:
        raise UserError("An excess so small is less than Blender's single precision can tell apart: ask for more")
    return replace(level, excess=excess)


def missed(level: Level, drawing: core.Mesh, made: CageLevel) -> str:
    """Why a stored cage misses the tolerance; empty if it does not."""
    if not isinstance(level, core.Within) or level.is_met(made.mesh, drawing):
        return ""
    return (
        "the cage is not within what was asked for in Blender's single precision; move the drawing closer to its "
        "object's origin, or ask for more"
    )


def kept(level: core.Within | None, cage: core.Mesh, drawing: core.Mesh, scale: float) -> str:
    """That a moved cage is still within a tolerance, as a sentence in units of the scene; empty for none."""
    if level is None:
        return ""
    taken, count = level.measured(cage, drawing), len(cage.vertices)
    if level.distance is None:
        return f"{count} vertices, within {100.0 * level.limit:.4g} % more area: {100.0 * taken:.4g} %."
    return f"{count} vertices, within a distance of {level.limit * scale:.4g}: {taken * scale:.4g}."


def told(made: CageLevel, level: Level, drawing: core.Mesh, clearance: float, scale: float) -> CageLevel:
    """A level made within a tolerance, with a sentence on that in units of the scene instead of the core's.

    clearance: kept by every cage, in the drawing's units. scale: length of such a unit in the scene.
    """
    if not isinstance(level, core.Within):
        return made
    count, taken = len(made.cage), level.measured(made.mesh, drawing)
    if level.distance is None:
        need = f"{count} vertices, the fewest found within {100.0 * level.limit:.4g} % more area: {100.0 * taken:.4g} %"
    else:
        need = f"{count} vertices, the fewest found within a distance of {level.limit * scale:.4g}: {taken * scale:.4g}"
        if made.report.fewest is not None:
            fewest_links = tolerance.fewest_links
            least = sum(fewest_links(drawing, k, level.distance, clearance) for k in range(len(drawing.loops)))
            need = f"{need}; no cage within it has fewer than {least}"
    notes = tuple(note for note in made.report.notes if note.code != "note.tolerance")
    return replace(made, need=f"{need}.", report=replace(made.report, notes=notes))
