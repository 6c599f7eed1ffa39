"""Decimations that a user may choose instead of the default one.

- `ArcLength`: evenly spaced along each loop.
- `OnCurve`: vertices on the fine mesh, at the places closest to those of another decimation's mesh.
- `OwnDecimation`: a function of the user's own.
"""

from .arc_length import ArcLength
from .on_curve import OnCurve
from .own_decimation import OwnDecimation

__all__ = ["ArcLength", "OnCurve", "OwnDecimation"]
