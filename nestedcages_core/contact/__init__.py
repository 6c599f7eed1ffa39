"""Ways to resolve contact between fine mesh and cage, behind one interface."""

from __future__ import annotations

from .base import Contact, ContactOutcome
from .ipc import IPC
from .pair_search import AllPairs, BroadPhase, Cells, UniformGrid
from .sequential_qp import SequentialQP
from .step_filter import NoFilter, SmallestDistance, StepFilter, TimeOfImpact

__all__ = [
    "IPC",
    "AllPairs",
    "BroadPhase",
    "Cells",
    "Contact",
    "ContactOutcome",
    "NoFilter",
    "SequentialQP",
    "SmallestDistance",
    "StepFilter",
    "TimeOfImpact",
    "UniformGrid",
]
