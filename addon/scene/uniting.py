"""Overlapping or touching areas as one outline, in float32 precision."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..core import chains, core
from ..errors import UserError
from .plane import size

Loop = NDArray[np.float64]
Loops = tuple[Loop, ...]

# Gaps narrower than this fraction of the size are closed if they collapse in float32: about ten roundings.
CLOSED_GAP = 1e-5


def outline_of(name: str, loops: Sequence[Loop], *, evenodd: bool = False) -> Loops:
    """The outline of one area given by loops (k, 2), in float32; unchanged unless they cross or touch.

    evenodd: the rule that decides what is inside, instead of non-zero winding. Raises: UserError.
    """
    try:
        core.Mesh.from_loops(loops)
    except core.NestedCagesError:
        return united(name, [core.exchange.Painted(loops, evenodd)])
    return tuple(loops)


def united(name: str, areas: Sequence[core.exchange.Painted]) -> Loops:
    """The outline of the union of areas, loops (k, 2), float32 values as float64. Raises: UserError."""
    points = np.concatenate([loop for area in areas for loop in area.loops])
    extent = size(points)
    problem: core.NestedCagesError | None = None
    for gap in (0.0, CLOSED_GAP * extent):
        try:
            mesh = core.exchange.solid(areas, seam=gap)
            loops = tuple(stored(mesh.vertices[loop]) for loop in mesh.loops)
            loops = tuple(loop for loop in loops if len(loop) >= chains.SMALLEST_LOOP)  # others are slits of rounding
            core.Mesh.from_loops(loops)
        except core.NestedCagesError as error:
            problem = problem or error
        else:
            return loops
    raise UserError(f"'{name}': {problem}") from problem


def stored(points: Loop) -> Loop:
    """A loop (k, 2) rounded to float32, as float64, without points that coincide then."""
    rounded = points.astype(np.float32).astype(np.float64)
    kept: Loop = rounded[(rounded != np.roll(rounded, 1, axis=0)).any(axis=1)]
    return kept


def divided(loop: Loop, longest: float) -> Loop:
    """A loop (k, 2) whose edges are at most so long; an edge gets the same points in both directions."""
    pieces = []
    for start, end in zip(loop, np.roll(loop, -1, axis=0), strict=True):
        count = max(int(np.ceil(np.hypot(*(end - start)) / longest)), 1)
        first, last = sorted((start.tolist(), end.tolist()))
        points = np.linspace(first, last, count + 1)
        pieces.append(points[:-1] if first == start.tolist() else points[:0:-1])
    return np.concatenate(pieces)
