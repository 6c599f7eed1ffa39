"""Join parts that nearly touch, where the gap between them is too narrow for a cage."""

from __future__ import annotations

import math

from ..geometry.mesh import Mesh
from .fill import Painted, regions, united
from .hairlines import without_hairlines
from .libraries import load_shapely
from .limits import invalid


def joined(mesh: Mesh, distance: float) -> Mesh:
    """A solid with its gaps narrower than `distance` filled; all other vertices keep their coordinates.

    Gaps are between components or inside one, such as a slit. Without any, the mesh is returned unchanged.
    Raises NestedCagesError for a distance that is not positive.
    """
    if not 0.0 < distance < math.inf:
        raise invalid(f"The distance must be a positive length, not {distance!r}.")
    shapely = load_shapely("parts that nearly touch")
    (solid,) = regions(shapely, [Painted([mesh.vertices[loop] for loop in mesh.loops])])
    found = without_hairlines(shapely, solid, gap=distance)
    return united(shapely, [found.region]) if found.gaps else mesh
