"""Contact between fine mesh and cage: methods to resolve it, behind one interface."""

from __future__ import annotations

from .base import Contact, ContactOutcome
from .ipc import IPC
from .pair_search import AllPairs, BroadPhase, Cells, UniformGrid
from .sequential_qp import SequentialQP
from .step_filter import NoFilter, SmallestDistance, StepFilter, TimeOfImpact

__all__ = [  # noqa: RUF022 - in the order of explanation
    "Contact",  # the interface: bring the fine mesh back along a path; it pushes the cage out
    "ContactOutcome",  # where that ended
    "IPC",  # Incremental Potential Contact: minimise a barrier energy by collision-free steps
    "SequentialQP",  # long steps, with a quadratic program for the response of the cage to each
    "StepFilter",  # interface: the fraction of a step that is free of collisions
    "TimeOfImpact",  # by continuous collision detection
    "SmallestDistance",  # by the smallest distance and the fastest approach
    "NoFilter",  # none, as in the paper
    "BroadPhase",  # interface: the pairs to consider
    "UniformGrid",  # those near each other
    "Cells",  # former name of UniformGrid
    "AllPairs",  # all of them, as in the paper
]
