"""Cage coordinates: move a drawing with its cage, and functions between the levels of a hierarchy."""

from __future__ import annotations

from .base import CageCoordinates, cage_coordinates, deform
from .harmonic import Harmonic
from .mean_value import MeanValue
from .piecewise_linear import PiecewiseLinear
from .transfer import Grids, grids

__all__ = [
    "CageCoordinates",
    "Grids",
    "Harmonic",
    "MeanValue",
    "PiecewiseLinear",
    "cage_coordinates",
    "deform",
    "grids",
]
