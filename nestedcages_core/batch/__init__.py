"""Cages for many shapes, on any executor of concurrent.futures."""

from .many import BatchProgress, nested_cages_many
from .outcome import Outcome

__all__ = ["BatchProgress", "Outcome", "nested_cages_many"]
