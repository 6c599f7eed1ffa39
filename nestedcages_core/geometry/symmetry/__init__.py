"""Cages with an exact symmetry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...libraries import imported_later
from .maps import Mirror, Rotation

if TYPE_CHECKING:
    from .detection import Found as Found
else:
    __getattr__ = imported_later(__name__, {"detection": "Found"})

__all__ = ["Found", "Mirror", "Rotation"]
