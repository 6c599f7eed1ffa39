"""Ways to resolve contact between fine mesh and cage, behind one interface."""

from __future__ import annotations

from .base import Contact, ContactOutcome
from .ipc import IPC
from .sequential_qp import SequentialQP

__all__ = ["IPC", "Contact", "ContactOutcome", "SequentialQP"]
