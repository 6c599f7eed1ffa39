"""Contact between fine mesh and cage: methods to resolve it, behind one interface."""

from __future__ import annotations

from .base import Contact, ContactOutcome
from .pair_search import AllPairs, BroadPhase, Cells, UniformGrid
from .sequential_qp import SequentialQP

__all__ = [  # noqa: RUF022 - in the order of explanation
    "Contact",  # the interface: bring the fine mesh back along a path; it pushes the cage out
    "ContactOutcome",  # where that ended
    "SequentialQP",  # long steps, with a quadratic program for the response of the cage to each
    "BroadPhase",  # interface: the pairs to consider
    "UniformGrid",  # those near each other
    "Cells",  # former name of UniformGrid
    "AllPairs",  # all of them, as in the paper
]
