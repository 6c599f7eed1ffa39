"""Even resampling by arc length: a coarse mesh whose vertices lie on the fine one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InvalidMeshError, NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.vectors import norm
from .base import MIN_PER_LOOP, Count
from .problem import Problem

PHASES = (0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875)
"""Fractions of the spacing by which the first vertex is shifted along its loop, tried in this order."""


@dataclass(frozen=True)
class ArcLength:
    """Vertices evenly spaced along each loop; a total count is distributed in proportion to length."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh whose vertices lie on the fine one, whatever the clearance; loop k on loop k.

        Raises NestingError if the count is impossible or the loops cross in all phases.
        """
        problem = Problem.of(fine, count)
        loops, sizes = problem.outline.split(), problem.per_loop
        if sizes is None:
            lengths = np.array([_arc_lengths(loop)[-1] for loop in loops])
            sizes = _apportioned(problem.total, lengths)
        crossing = ""
        for phase in PHASES:
            spread = [_spread(loop, size, phase) for loop, size in zip(loops, sizes.tolist(), strict=True)]
            try:
                mesh = problem.mesh(spread)
            except InvalidMeshError as error:
                crossing = crossing or str(error)
                continue
            if mesh.has_roles_of(fine):
                return mesh
        raise NestingError(
            f"{problem.total} evenly spaced vertices are too few to follow the mesh: {crossing} Ask for more vertices, "
            "or use line cycles.",
            code="count.too_small",
        )


def _arc_lengths(loop: FloatArray) -> FloatArray:
    """(k + 1,) length along a closed loop (k, 2) up to each vertex and back to the first."""
    return np.concatenate(([0.0], np.cumsum(norm(np.roll(loop, -1, axis=0) - loop))))


def _spread(loop: FloatArray, size: int, phase: float) -> FloatArray:
    """(size, 2) points evenly spaced along a closed loop (k, 2), the first `phase` spacings after its start."""
    along = _arc_lengths(loop)
    where = (np.arange(size) + phase) * (along[-1] / size)
    closed = np.concatenate((loop, loop[:1]))
    return np.stack([np.interp(where, along, closed[:, axis]) for axis in (0, 1)], axis=1)


def _apportioned(total: int, lengths: FloatArray) -> IntArray:
    """Numbers (K,) in proportion to lengths (K,), at least three each, whose sum is `total`.

    Each vertex in turn goes where the spacing is longest (D'Hondt's method), which minimises the longest spacing. Ties
    go to the first.
    """
    spacings = lengths[:, None] / np.arange(MIN_PER_LOOP, total + 1)
    longest = np.argsort(-spacings, axis=None, kind="stable")[: total - MIN_PER_LOOP * len(lengths)]
    return MIN_PER_LOOP + np.bincount(longest // spacings.shape[1], minlength=len(lengths))
