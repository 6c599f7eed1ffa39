"""Cages with an exact symmetry."""

from __future__ import annotations

from .detection import Found
from .symmetry import Mirror, Rotation

__all__ = ["Found", "Mirror", "Rotation"]
