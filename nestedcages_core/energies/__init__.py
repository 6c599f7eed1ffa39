"""Energies of the cage, and the terms of reinflation that are not contact."""

from __future__ import annotations

from .area import Area, signed_area
from .base import Blocks, CageEnergy

__all__ = ["Area", "Blocks", "CageEnergy", "signed_area"]
