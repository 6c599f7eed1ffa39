"""Simplifications by vertex count, as decimations: they lie across the fine mesh, and their loops stay simple.

- `DouglasPeucker`, `Visvalingam`: a subset of the fine vertices, by distance from chords or by area.
- `EdgeCollapse`: vertices near the fine mesh, by squared distances to its lines.
"""

from .douglas_peucker import DouglasPeucker
from .edge_collapse import EdgeCollapse
from .visvalingam import Visvalingam

__all__ = ["DouglasPeucker", "EdgeCollapse", "Visvalingam"]
