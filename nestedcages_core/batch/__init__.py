"""Cages for many shapes, on any executor of concurrent.futures, with finished results kept on disk."""

from __future__ import annotations

from .many import BatchProgress, nested_cages_many
from .store import OutcomeFolder
from .tasks import Outcome

__all__ = ["BatchProgress", "Outcome", "OutcomeFolder", "nested_cages_many"]
