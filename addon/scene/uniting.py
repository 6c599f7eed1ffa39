"""Areas that overlap or touch as one outline, in the numbers that Blender stores."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..core import core
from ..errors import UserError

Loop = NDArray[np.float64]
Loops = tuple[Loop, ...]

# Gaps narrower than this part of the size, closed where float32 cannot hold them open: some ten roundings.
CLOSED_GAP = 1e-5


def outline_of(name: str, loops: Sequence[Loop]) -> Loops:
    """The outline of one area that its loops (k, 2) go around, in float32; unchanged unless they cross or touch.

    Places are inside where the loops go around them more often in one sense than in the other. Raises: UserError.
    """
    try:
        core.Mesh.from_loops(loops)
    except core.NestedCagesError:
        return united(name, [core.exchange.Painted(loops)])
    return tuple(loops)


def united(name: str, areas: Sequence[core.exchange.Painted]) -> Loops:
    """The outline of all areas together, loops (k, 2) in float32, given as float64. Raises: UserError."""
    points = np.concatenate([loop for area in areas for loop in area.loops])
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    problem: core.NestedCagesError | None = None
    for gap in (0.0, CLOSED_GAP * extent):
        try:
            mesh = core.exchange.solid(areas, seam=gap)
            loops = tuple(stored(mesh.vertices[loop]) for loop in mesh.loops)
            core.Mesh.from_loops(loops)
        except core.NestedCagesError as error:
            problem = problem or error
        else:
            return loops
    raise UserError(f"'{name}': {problem}") from problem


def stored(points: Loop) -> Loop:
    """A loop (k, 2) as float32 holds it, given as float64, without points that become the same."""
    rounded = points.astype(np.float32).astype(np.float64)
    kept: Loop = rounded[(rounded != np.roll(rounded, 1, axis=0)).any(axis=1)]
    return kept
