"""Fine to coarse with a wanted vertex count. Each method is a frozen object with one method, `decimate`.

- `Decimation`: the interface, with `Count`, the vertices of a level; `SeveralStarts` for methods that offer several
  coarse meshes.
- `LineCycles`: the lines of least area around each loop; put on the curve.
- `OnCurve`: vertices on the fine mesh, distributed like those of the outer hull.
- `OuterHull`: strictly encloses the fine mesh from the start; works for any count down to a triangle per loop.
- `ArcLength`: evenly spaced along each loop.
- `DouglasPeucker`, `Visvalingam`: a subset of the fine vertices, by distance from chords or by area.
- `EdgeCollapse`: vertices near the fine mesh, by squared distances to its lines.
- `OwnDecimation`: a function of the user's own.
"""

from __future__ import annotations

from .base import Count, Decimation, SeveralStarts, Start
from .choices.arc_length import ArcLength
from .choices.douglas_peucker import DouglasPeucker
from .choices.edge_collapse import EdgeCollapse
from .choices.own_decimation import OwnDecimation
from .choices.visvalingam import Visvalingam
from .hull.outer_hull import OuterHull
from .line_cycles import LineCycles
from .on_curve import OnCurve

__all__ = [
    "ArcLength",
    "Count",
    "Decimation",
    "DouglasPeucker",
    "EdgeCollapse",
    "LineCycles",
    "OnCurve",
    "OuterHull",
    "OwnDecimation",
    "SeveralStarts",
    "Start",
    "Visvalingam",
]
