"""Ways to resolve contact between fine mesh and cage, behind one interface."""

from __future__ import annotations

from .base import Contact, ContactOutcome
from .ipc import IPC

__all__ = ["IPC", "Contact", "ContactOutcome"]
