"""Cage coordinates: move a drawing with its cage, and functions between the levels of a hierarchy.

- `cage_coordinates`, `deform`: weights of the fine vertices, and their positions under a posed cage.
- `CageCoordinates`: the interface of `Harmonic` (never negative, needs points inside), `MeanValue` (closed form,
  anywhere) and `PiecewiseLinear` (three weights per point).
- `field_of`: a `Field`, a mesh that carries the motion of a cage to anything in it; `folded`: where a pose lays it on
  itself; `holding`: where a shape is in it.
- `grids`: `Grids` on all levels, with prolongations between them.
"""

from .base import CageCoordinates, cage_coordinates, deform
from .field import Field, field_of, folded, holding
from .harmonic import Harmonic, PiecewiseLinear
from .mean_value import MeanValue
from .transfer import Grids, grids

__all__ = [
    "CageCoordinates",
    "Field",
    "Grids",
    "Harmonic",
    "MeanValue",
    "PiecewiseLinear",
    "cage_coordinates",
    "deform",
    "field_of",
    "folded",
    "grids",
    "holding",
]
