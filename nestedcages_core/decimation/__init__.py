"""Decimation: coarse meshes with at most so many vertices.

- `LineCycles`: the lines of least area around each loop, the default.
- `ArcLength`: evenly spaced along each loop.
- `OnCurve`: vertices on the fine mesh, at the places closest to those of another decimation's mesh.
- `OwnDecimation`: a function of the user's own.
"""

from typing import TYPE_CHECKING

from ..libraries import imported_later
from .base import Count, Decimation, Start, Starts
from .line_cycles import LineCycles

if TYPE_CHECKING:
    from .arc_length import ArcLength as ArcLength
    from .on_curve import OnCurve as OnCurve
    from .own_decimation import OwnDecimation as OwnDecimation
else:
    names = {"arc_length": "ArcLength", "on_curve": "OnCurve", "own_decimation": "OwnDecimation"}
    __getattr__ = imported_later(__name__, names)

__all__ = ["Count", "Decimation", "LineCycles", "Start", "Starts"]
