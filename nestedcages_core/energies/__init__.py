"""Energies of the cage, and the terms of reinflation that are not contact."""

from __future__ import annotations

from .arap import BoundaryARAP, InteriorARAP
from .area import Area, signed_area
from .base import Blocks, CageEnergy, Energy
from .displacement import InitialDisplacement, StepDisplacement
from .element_energy import ElementEnergy
from .no_energy import NoEnergy
from .shape_keeping import ShapeKeeping
from .weighted_sum import WeightedSum

__all__ = [
    "Area",
    "Blocks",
    "BoundaryARAP",
    "CageEnergy",
    "ElementEnergy",
    "Energy",
    "InitialDisplacement",
    "InteriorARAP",
    "NoEnergy",
    "ShapeKeeping",
    "StepDisplacement",
    "WeightedSum",
    "signed_area",
]
