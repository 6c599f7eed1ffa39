"""Fine to coarse with a wanted vertex count: each way is a frozen object with one method, `decimate`."""

from __future__ import annotations

from .base import Candidates, Count, Decimation
from .on_curve import OnCurve
from .outer_hull import OuterHull
from .resample import ArcLength

__all__ = ["ArcLength", "Candidates", "Count", "Decimation", "OnCurve", "OuterHull"]
