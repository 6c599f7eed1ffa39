"""What is given to a writer, as meshes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh


def meshes_of(shapes: Any) -> list[Mesh]:
    """The meshes of a result, the items of a list of meshes, or one shape as a mesh. Raises InvalidMeshError."""
    if isinstance(shapes, Drawable):
        return list(shapes.meshes)
    if not isinstance(shapes, np.ndarray | str) and isinstance(shapes, Iterable):
        shapes = list(shapes)
        meshes = [item for item in shapes if isinstance(item, Mesh)]
        if len(meshes) == len(shapes):
            return meshes
    return [Mesh.of(shapes)]
