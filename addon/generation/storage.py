"""Levels in the numbers that Blender stores, certified as such."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..core import core

Steps = NDArray[np.float32]


@dataclass(frozen=True)
class CageLevel:
    """One level as Blender stores it: `fine_steps` (S, n, 2) and `cage_steps` (S, m, 2), float32, of flow (up to index
    `flow_end`), reinflation and tightening (from index `tightening`); the last ones are the result. `need`: a sentence
    on the distance or the excess that was asked for.
    """

    fine_edges: NDArray[np.int64]
    cage_edges: NDArray[np.int64]
    fine_steps: Steps
    cage_steps: Steps
    flow_end: int
    tightening: int
    certificate: core.Certificate
    report: core.NestingReport
    inside: bool = False
    need: str = ""

    @property
    def excess(self) -> float:
        """How much more area the cage has than what it is around or inside of, as a part of that; negative inside."""
        found = float(self.certificate.excess)  # inside, that of the drawing around the cage
        return 1.0 / (1.0 + found) - 1.0 if self.inside else found

    @property
    def cage(self) -> NDArray[np.float32]:
        """The cage's vertices (m, 2)."""
        vertices: NDArray[np.float32] = self.cage_steps[-1]
        return vertices

    @cached_property
    def mesh(self) -> core.Mesh:
        """The cage as the core's ``Mesh``, validated on first use."""
        return core.Mesh(self.cage.astype(np.float64), self.cage_edges)

    @property
    def last(self) -> int:
        """Index of the last step."""
        return len(self.cage_steps) - 1


def stored(fine: core.Mesh, level: core.Level, clearance: float, *, shrink: bool = False) -> CageLevel:
    """The core's level in float32 with its certificate: flow, during which the coarse mesh rests, and reinflation
    in one sequence. `shrink`: the flow goes on inside the coarse mesh, and reinflation starts with the return.
    """
    flow, reinflation = level.flow.steps, level.reinflation
    further = core.flow.shrink(fine, level.coarse, flow[-1]) if shrink and not level.inside else flow[:0]
    way = [flow[-1:], further, further[-2::-1]] if len(further) else []
    before = np.concatenate([flow[:-1], *way])
    standing = np.broadcast_to(level.coarse.vertices, (len(before), *level.coarse.vertices.shape))
    fine_steps = np.concatenate([before, reinflation.fine_steps]).astype(np.float32)
    cage_steps = np.concatenate([standing, reinflation.cage_steps]).astype(np.float32)
    same_loops = level.coarse.has_loops_like(fine)
    cage = level.cage.moved(cage_steps[-1].astype(np.float64))
    outer, inner = (fine, cage) if level.inside else (cage, fine)
    nested = _nested_from(cage, fine, cage_steps, fine_steps, len(flow) - 1)
    if len(further) and nested >= len(flow):
        return stored(fine, level, clearance)
    flow_end = nested + len(further)
    return CageLevel(
        fine_edges=fine.edges,
        cage_edges=level.cage.edges,
        fine_steps=fine_steps,
        cage_steps=cage_steps,
        flow_end=flow_end,
        tightening=max(flow_end, len(before) + reinflation.tightening_start),
        certificate=core.verify(outer, inner, clearance, same_loops=same_loops),
        report=level.report,
        inside=level.inside,
    )


def _nested_from(cage: core.Mesh, fine: core.Mesh, cage_steps: Steps, fine_steps: Steps, first: int) -> int:
    """The step from which on the motion is certified collision-free in float32 too.

    This is the last step of the flow, unless rounding closed a gap later: then all earlier steps count as flow.
    """
    while True:
        cages, fines = (steps[first:].astype(np.float64) for steps in (cage_steps, fine_steps))
        motion = core.verify_motion(cage, fine, cages, fines)
        if motion.free or motion.step is None:
            return first
        first += motion.step + 1
