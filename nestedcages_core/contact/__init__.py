"""Ways to resolve contact between fine mesh and cage, behind one interface."""

from __future__ import annotations

from .base import Contact, ContactOutcome
from .ipc import IPC
from .pair_search import AllPairs, BroadPhase, Cells
from .paper import PaperContact, Repairs
from .paper_potential import PaperWeights
from .sequential_qp import SequentialQP
from .step_filter import NoFilter, SmallestDistance, StepFilter, TimeOfImpact
from .velocity_filter import VelocityFilter

__all__ = [
    "IPC",
    "AllPairs",
    "BroadPhase",
    "Cells",
    "Contact",
    "ContactOutcome",
    "NoFilter",
    "PaperContact",
    "PaperWeights",
    "Repairs",
    "SequentialQP",
    "SmallestDistance",
    "StepFilter",
    "TimeOfImpact",
    "VelocityFilter",
]
