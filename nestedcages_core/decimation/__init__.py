"""Fine to coarse with a wanted vertex count. Each method is a frozen object with one method, `decimate`.

- `Decimation`: the interface, with `Count`, the vertices of a level; `SeveralStarts` for methods that offer several
  coarse meshes.
- `LineCycles`: the lines of least area around each loop; put on the curve.
- `OuterHull`: strictly encloses the fine mesh from the start; works for any count down to a triangle per loop.
- `choices/`: others.
"""

from .base import Count, Decimation, SeveralStarts, Start
from .hull.outer_hull import OuterHull
from .line_cycles import LineCycles

__all__ = [
    "Count",
    "Decimation",
    "LineCycles",
    "OuterHull",
    "SeveralStarts",
    "Start",
]
