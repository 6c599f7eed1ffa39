"""The check for coordinates that are only defined inside the cage."""

from __future__ import annotations

import numpy as np

from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number
from ..geometry.vectors import place


def require_inside(points: FloatArray, cage: Mesh) -> None:
    """Raise NestedCagesError unless all (P, 2) points lie in the solid of the cage or on it, by exact predicates."""
    outside = np.flatnonzero(winding_number(points, cage.vertices, cage.vertices[cage.successor]) == 0)
    if len(outside):
        raise NestedCagesError(
            f"Point {outside[0]} at {place(points[outside[0]])} is outside the cage, where these coordinates are not "
            "defined; use a cage that encloses all points, or MeanValue().",
            code="coordinates.outside",
            vertex=outside[0],
            place=points[outside[0]],
        )
