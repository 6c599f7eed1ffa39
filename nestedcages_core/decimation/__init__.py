"""Decimation: coarse meshes with at most so many vertices.

- `LineCycles`: the lines of least area around each loop, the default.
- `ArcLength`: evenly spaced along each loop.
- `OnCurve`: vertices on the fine mesh, at the places closest to those of another decimation's mesh.
- `OwnDecimation`: a function of the user's own.
"""

from .arc_length import ArcLength
from .base import Count, Decimation, Start, Starts
from .line_cycles import LineCycles
from .on_curve import OnCurve
from .own_decimation import OwnDecimation

__all__ = ["ArcLength", "Count", "Decimation", "LineCycles", "OnCurve", "OwnDecimation", "Start", "Starts"]
