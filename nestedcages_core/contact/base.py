"""The interface that every way to resolve contact shares."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from ..geometry.arrays import FloatArray
from .pairs import Bodies

OnStep: TypeAlias = Callable[[FloatArray], None]
"""Called with every accepted state; the linear motion from the one before is free of collisions. The same array again
adds no step: the work only goes on."""


def no_step(x: FloatArray) -> None:
    """An `OnStep` that does nothing."""


class ContactOutcome(NamedTuple):
    """Where a reinflation ended."""

    x: FloatArray
    """(m + n, 2) positions of cage and fine vertices after the last accepted step."""
    reached_target: bool
    """Whether the fine mesh is exactly at the last target."""
    iterations: int
    """Number of linear systems or quadratic programs solved."""
    reason: str = ""
    """Part of a sentence: what stopped it, naming the vertex; empty when the target was reached."""


def farthest_vertex(fine: FloatArray, target: FloatArray) -> str:
    """The fine vertex that is farthest from its target, both (n, 2), in words."""
    return f"the cage holds up fine vertex {int(np.hypot(*(target - fine).T).argmax())}"


class Contact(Protocol):
    """Moves the fine mesh back along a path and pushes the cage away."""

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float, on_step: OnStep = no_step
    ) -> ContactOutcome:
        """Bring the fine mesh through the targets of a path to exactly the last of them.

        Failure is part of the outcome, not an exception.

        Parameters
        ----------
        bodies : Bodies
            What does not change: the edges of cage and fine mesh.
        x : (m + n, 2) array
            Positions of the m cage vertices, then of the n fine vertices, free of contact.
        path : sequence of (n, 2) arrays
            Positions of the fine vertices to pass.
        clearance : float
            Distance that the cage is to keep in the end, for guidance: tightening and the certificate see to it.
        on_step : callable
            Called with every accepted state, see `OnStep`.

        Returns
        -------
        ContactOutcome
        """
