"""Energies of the cage, and the terms of reinflation that are not contact."""

from __future__ import annotations

from .area import Area, signed_area
from .base import Blocks, CageEnergy, Energy

__all__ = ["Area", "Blocks", "CageEnergy", "Energy", "signed_area"]
