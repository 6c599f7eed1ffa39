"""The interface that every way to resolve contact shares."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from ..energies import CageEnergy
from ..geometry.arrays import FloatArray
from ..solver import Solver
from .pairs import Bodies


@dataclass(frozen=True, eq=False)
class ContactOutcome:
    """Where a reinflation ended."""

    x: FloatArray
    """(m + n, 2) positions of cage and fine vertices after the last accepted step."""
    came_home: bool
    """Whether the fine mesh stands at the last target, to the last bit."""
    iterations: int
    """Number of systems of equations or quadratic programs solved."""
    reason: str = ""
    """Part of a sentence: what stopped it, naming the vertex; empty when the fine mesh came home."""


class Contact(Protocol):
    """Moves the fine mesh back along a path while the cage gives way."""

    def reinflate(
        self,
        bodies: Bodies,
        x: FloatArray,
        path: Sequence[FloatArray],
        *,
        clearance: float,
        energy: CageEnergy,
        solver: Solver,
        on_step: Callable[[FloatArray], None],
    ) -> ContactOutcome:
        """Bring the fine vertices from x[m:] through the targets in ``path`` to exactly the last of them.

        bodies: what does not change; x: (m + n, 2) positions (cage, fine) free of contact; path: fine positions (n, 2)
        to pass, the last one is home; clearance: wanted distance, which the result need not reach but should not be far
        from; energy: what the cage minimises meanwhile; solver: how, for contacts that minimise. ``on_step`` is called
        with every accepted x: the linear motion from the one before is free of collisions. It may raise to cancel.
        Never raises for a failure: the outcome says so.
        """
        ...
