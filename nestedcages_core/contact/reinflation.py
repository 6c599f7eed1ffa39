"""Reinflation: the fine mesh moves back along its flow and pushes the cage out
(Gurditta & Jacobson 2022, section 3.2)."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ReinflationError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..progress import Tick, no_tick
from .base import Contact
from .pairs import Bodies

if TYPE_CHECKING:
    from ..constraints.base import Bound

logger = logging.getLogger(__name__)

REMEDY = "use more cage vertices, or a coarse mesh closer to the fine one"
"""Advice in messages when the path is blocked."""


@dataclass(frozen=True, eq=False)
class Reinflation:
    """Every step of fine mesh and cage; between consecutive steps, linear motion of both is free of collisions."""

    moving_steps: FloatArray = field(repr=False)
    """(R + 1, n, 2) steps of the fine mesh until it is back; during the K - R steps of the tightening it rests."""
    cage_steps: FloatArray = field(repr=False)
    """(K + 1, m, 2): step 0 is the coarse mesh, step K the cage."""
    iterations: int
    """Linear systems or quadratic programs solved."""

    @property
    def tightening_start(self) -> int:
        """R, the index of the step at which the fine mesh is back and tightening begins."""
        return len(self.moving_steps) - 1

    @property
    def fine_path(self) -> Sequence[FloatArray]:
        """The steps (n, 2) of the fine mesh, as views."""
        return [*self.moving_steps, *[self.moving_steps[-1]] * (len(self.cage_steps) - len(self.moving_steps))]

    @cached_property
    def fine_steps(self) -> FloatArray:
        """(K + 1, n, 2): step 0 lies inside the coarse mesh, step K is exactly the fine mesh.

        Read-only. Computed on first use, unless the fine mesh rests all the time.
        """
        count, (moving, *shape) = len(self.cage_steps), self.moving_steps.shape
        if moving == 1:
            return np.broadcast_to(self.moving_steps[0], (count, *shape))
        if moving == count:
            return self.moving_steps
        steps: FloatArray = np.empty((count, *shape))
        steps[:moving] = self.moving_steps
        steps[moving:] = self.moving_steps[-1]
        steps.flags.writeable = False
        return steps

    def with_tightening(self, cages: Sequence[FloatArray]) -> Reinflation:
        """The same with the cages (m, 2) of the tightening as further steps."""
        return Reinflation(self.moving_steps, np.stack([*self.cage_steps, *cages]), self.iterations)

    def __getstate__(self) -> dict[str, Any]:
        """The state without the steps that can be computed again."""
        return {name: value for name, value in vars(self).items() if name != "fine_steps"}


def reinflate(
    fine: Mesh,
    coarse: Mesh,
    flow_steps: FloatArray,
    *,
    contacts: Sequence[Contact],
    clearance: float,
    bounds: tuple[Bound, ...] = (),
    tick: Tick = no_tick,
) -> Reinflation:
    """Follow the flow's steps (J + 1, n, 2) back while the cage, starting as the coarse mesh, is pushed out.

    contacts: ways to resolve contact; each starts over where the one before is blocked. bounds: what the cage keeps,
    which only sequential QPs know. tick: called with the fraction done.

    Raises ReinflationError when no contact succeeds, or when exact predicates find a contact in the result; its
    ``partial`` is the reinflation so far.
    """
    bodies = Bodies.of(coarse, fine, bounds=bounds)
    failure = ReinflationError("No contact was given for reinflation.", code="setting.invalid")
    for contact in contacts:
        try:
            return _by(contact, bodies, flow_steps, clearance, tick)
        except ReinflationError as error:
            failure = error
    raise failure


def _by(contact: Contact, bodies: Bodies, flow_steps: FloatArray, clearance: float, tick: Tick) -> Reinflation:
    """The reinflation by one contact. Raises ReinflationError."""
    steps, path = [np.concatenate([bodies.coarse.vertices, flow_steps[-1]])], list(flow_steps[-2::-1])
    distance = float(np.abs(flow_steps[-1] - flow_steps[0]).sum())

    def on_step(x: FloatArray) -> None:
        if x is not steps[-1]:
            steps.append(x)
        tick(1.0 - float(np.abs(x[bodies.m :] - flow_steps[0]).sum()) / distance if distance > 0.0 else 1.0)

    iterations, reason = 0, ""
    if path:
        outcome = contact.reinflate(bodies, steps[0], path, clearance=clearance, on_step=on_step)
        iterations, reason = outcome.iterations, "" if outcome.reached_target else outcome.reason or "it was stopped"
        logger.debug("reinflation by %s: %d systems, %d steps: %s", contact, iterations, len(steps) - 1,
                     reason or "reached the fine mesh")  # fmt: skip
    if not reason:
        vertex = bodies.first_contact(steps[-1])
        if vertex is None:
            return _recorded(steps, bodies.m, iterations)
        which = f"cage vertex {vertex}" if vertex < bodies.m else f"fine vertex {vertex - bodies.m}"
        reason = f"it ended in contact at {which}"
    sentence = f"Reinflation did not return the fine mesh to its position: {reason}; {REMEDY}."
    raise ReinflationError(sentence, partial=_recorded(steps, bodies.m, 0), code="reinflation.blocked")


def _recorded(steps: list[FloatArray], m: int, iterations: int) -> Reinflation:
    stacked = np.stack(steps)
    return Reinflation(stacked[:, m:], stacked[:, :m], iterations)
