"""Fine to coarse with a wanted vertex count: each way is a frozen object with one method, `decimate`."""

from __future__ import annotations

from .base import Candidates, Count, Decimation
from .douglas_peucker import DouglasPeucker
from .edge_collapse import EdgeCollapse
from .level_set import LevelSet
from .on_curve import OnCurve
from .outer_hull import OuterHull
from .resample import ArcLength
from .user import OwnDecimation
from .visvalingam import Visvalingam

__all__ = [
    "ArcLength",
    "Candidates",
    "Count",
    "Decimation",
    "DouglasPeucker",
    "EdgeCollapse",
    "LevelSet",
    "OnCurve",
    "OuterHull",
    "OwnDecimation",
    "Visvalingam",
]
