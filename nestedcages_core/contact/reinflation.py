"""Reinflation: the fine mesh goes back along its flow, and the cage gives way (Gurditta & Jacobson 2022, section
3.2)."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..energies import CageEnergy
from ..energies.containment_energy import ContainmentEnergy
from ..errors import ReinflationError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..solver import Solver
from . import Contact
from .pairs import Bodies

logger = logging.getLogger(__name__)

REMEDY = "use more cage vertices, or a coarse mesh closer to the fine one"
"""What a user can change when the way home is blocked."""

Progress = Callable[[float, str], None]
"""Called with the fraction that is done and a short message; may raise to cancel."""


@dataclass(frozen=True, eq=False)
class Reinflation:
    """Every step of fine mesh and cage; between consecutive steps, linear motion of both is free of collisions."""

    fine_steps: FloatArray = field(repr=False)
    """(K + 1, n, 2): step 0 lies inside the coarse mesh, step K is the fine mesh itself, bit by bit."""
    cage_steps: FloatArray = field(repr=False)
    """(K + 1, m, 2): step 0 is the coarse mesh, step K the cage."""
    tightening_start: int
    """Index of the step at which the fine mesh is home; what follows only tightens the cage."""
    iterations: int
    """Systems of equations or quadratic programs solved on the way home."""

    def with_tightening(self, cages: list[FloatArray]) -> Reinflation:
        """The same with the steps of tightening added; the fine mesh stands still meanwhile."""
        if not cages:
            return self
        resting = np.broadcast_to(self.fine_steps[-1], (len(cages), *self.fine_steps.shape[1:]))
        return replace(
            self,
            fine_steps=np.concatenate([self.fine_steps, resting]),
            cage_steps=np.concatenate([self.cage_steps, np.stack(cages)]),
        )


def reinflate(
    fine: Mesh,
    coarse: Mesh,
    flow_steps: FloatArray,
    *,
    contacts: Sequence[Contact],
    energy: CageEnergy,
    solver: Solver,
    clearance: float,
    progress: Progress | None = None,
) -> Reinflation:
    """Walk the flow's steps (J + 1, n, 2) back while the cage, starting as the coarse mesh, is pushed out.

    contacts: ways to resolve contact; each begins anew where the one before could not bring the fine mesh home.
    ReinflationError when none can, or when exact predicates refuse what came out; its ``partial`` is the reinflation
    so far.
    """
    bodies = Bodies.of(coarse, fine)
    containment = ContainmentEnergy(bodies.cage_successor, bodies.fine_successor)
    start = np.concatenate([coarse.vertices, flow_steps[-1]])
    path = list(flow_steps[-2::-1])
    way = float(np.abs(flow_steps[-1] - flow_steps[0]).sum())
    steps: list[FloatArray] = []

    def on_step(x: FloatArray) -> None:
        steps.append(x)
        if progress is not None:
            left = float(np.abs(x[bodies.m :] - flow_steps[0]).sum())
            progress(1.0 - left / way if way > 0.0 else 1.0, f"step {len(steps) - 1}")

    reason = ""
    for contact in contacts:
        steps[:] = [start]
        iterations, came_home = 0, True
        if path:
            outcome = contact.reinflate(
                bodies, start, path, clearance=clearance, energy=energy, solver=solver, on_step=on_step
            )
            iterations, came_home, reason = outcome.iterations, outcome.came_home, outcome.reason
            logger.debug("reinflation by %s: %d systems, %d steps: %s", contact, iterations, len(steps) - 1,
                         "home" if came_home else reason)  # fmt: skip
        if came_home:
            vertex = containment.first_contact(steps[-1])
            if vertex is None:
                return _recorded(steps, bodies.m, iterations)
            which = f"cage vertex {vertex}" if vertex < bodies.m else f"fine vertex {vertex - bodies.m}"
            reason = f"it ended in contact at {which}"
    partial = _recorded(steps, bodies.m, 0) if steps else None
    raise ReinflationError(f"Reinflation did not bring the fine mesh home: {reason}; {REMEDY}.", partial=partial)


def _recorded(steps: list[FloatArray], m: int, iterations: int) -> Reinflation:
    stacked = np.stack(steps)
    return Reinflation(stacked[:, m:], stacked[:, :m], len(steps) - 1, iterations)
