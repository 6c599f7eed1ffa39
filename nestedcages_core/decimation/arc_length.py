"""Even resampling by arc length: a coarse mesh whose vertices lie on the fine one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InvalidMeshError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .apportion import shares
from .base import LEAST_PER_LOOP, Count, checked_budget
from .canonical_order import Unrolled, unroll

PHASES = (0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875)
"""Fractions of the spacing by which the first vertex is shifted along its loop, tried in this order."""


@dataclass(frozen=True)
class ArcLength:
    """Vertices evenly spaced along each loop; a total count is shared out in proportion to length."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh whose vertices lie on the fine one, whatever the clearance; loop k on loop k.

        Raises NestingError if the count is impossible or the loops cross in all of the phases that are tried.
        """
        budget = checked_budget(fine, count)
        unrolled = unroll(fine)
        loops = unrolled.outline.loops
        sizes = unrolled.per_loop(budget)
        if sizes is None:
            lengths = np.array([_arc_lengths(loop)[-1] for loop in loops])
            sizes = shares(budget.total, lengths, LEAST_PER_LOOP)
        problem = ""
        for phase in PHASES:
            spread = [_spread(loop, size, phase) for loop, size in zip(loops, sizes.tolist(), strict=True)]
            try:
                return same_loops(unrolled, spread, fine)
            except InvalidMeshError as error:
                problem = problem or str(error)
        raise NestingError(
            f"{budget.total} evenly spaced vertices are too few to follow the mesh: {problem} Ask for more vertices, "
            "or use the outer hull."
        )


def same_loops(unrolled: Unrolled, loops: Sequence[FloatArray], fine: Mesh) -> Mesh:
    """A mesh of loops that stand for those of the fine mesh. Raises InvalidMeshError if they cross or change roles."""
    mesh = unrolled.rolled_up(loops)
    changed = (mesh.loop_signs != fine.loop_signs) | (mesh.component_of_loop != fine.component_of_loop)
    if changed.any():
        k = int(np.flatnonzero(changed)[0])
        raise InvalidMeshError(f"Loop {k} comes to lie in another loop than in the mesh inside.")
    return mesh


def _arc_lengths(loop: FloatArray) -> FloatArray:
    """(k + 1,) length along a closed loop (k, 2) up to each vertex and back to the first."""
    steps = np.roll(loop, -1, axis=0) - loop
    return np.concatenate(([0.0], np.cumsum(np.hypot(*steps.T))))


def _spread(loop: FloatArray, size: int, phase: float) -> FloatArray:
    """(size, 2) points evenly spaced along a closed loop (k, 2), the first `phase` spacings after its start."""
    along = _arc_lengths(loop)
    where = (np.arange(size) + phase) * (along[-1] / size)
    closed = np.concatenate((loop, loop[:1]))
    return np.stack([np.interp(where, along, closed[:, axis]) for axis in (0, 1)], axis=1)
