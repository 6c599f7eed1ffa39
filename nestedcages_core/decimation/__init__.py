"""Fine to coarse with a wanted vertex count: each way is a frozen object with one method, `decimate`."""

from __future__ import annotations

from .arc_length import ArcLength
from .base import Candidates, Count, Decimation
from .douglas_peucker import DouglasPeucker
from .edge_collapse import EdgeCollapse
from .on_curve import OnCurve
from .outer_hull import OuterHull
from .own_decimation import OwnDecimation
from .visvalingam import Visvalingam

__all__ = [
    "ArcLength",
    "Candidates",
    "Count",
    "Decimation",
    "DouglasPeucker",
    "EdgeCollapse",
    "OnCurve",
    "OuterHull",
    "OwnDecimation",
    "Visvalingam",
]
