"""Cages for many shapes, over any executor of concurrent.futures, and what is finished of them on the disk."""

from __future__ import annotations

from .many import BatchProgress, nested_cages_many
from .store import OutcomeFolder
from .tasks import Outcome

__all__ = ["BatchProgress", "Outcome", "OutcomeFolder", "nested_cages_many"]
