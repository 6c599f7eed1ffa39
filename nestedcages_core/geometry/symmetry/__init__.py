"""Cages with an exact symmetry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...libraries import imported_later
from .maps import Mirror, Rotation

if TYPE_CHECKING:
    from .detection import DetectSymmetry as DetectSymmetry
else:
    __getattr__ = imported_later(__name__, {"detection": "DetectSymmetry"})

__all__ = ["DetectSymmetry", "Mirror", "Rotation"]
