"""One mesh follows one cage by cage coordinates: weights as attributes, summed by a node group stored in the file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np

from .. import keys
from ..core import core
from ..errors import UserError
from ..generation.memory import remembered
from ..scene import filling
from ..scene.plane import PLANARITY, Array, size, space_to_space, transform
from . import node_groups

HARMONIC, LINEAR = "HARMONIC", "LINEAR"
# The core's coordinates by method.
KINDS: dict[str, Callable[[], Any]] = {
    HARMONIC: lambda: core.Harmonic(),
    LINEAR: lambda: core.PiecewiseLinear(),
}
# Maximum product of the vertex counts of mesh and cage: Blender sums this many weights in a few hundredths of a
# second per frame.
MAX_WEIGHTS = 1_000_000


def fits(obj: bpy.types.Object, cage: bpy.types.Object) -> bool:
    """Whether the weights are few enough for interactive use."""
    return len(obj.data.vertices) * len(cage.data.vertices) <= MAX_WEIGHTS


def add(
    obj: bpy.types.Object,
    cage: bpy.types.Object,
    points: Array,
    method: str,
    surface: bpy.types.Object | None = None,
) -> bpy.types.Modifier:
    """Stores the weights of an object's vertices at `points` (n, 3), in its own space, and adds the modifier.

    surface: an object that shows the cage in the space of `obj`, to follow instead: copies then follow too.

    Raises: UserError if the points are not in the plane and the inside of the cage.
    """
    there = space_to_space(cage, obj)
    inside, corners = transform(there, points), filling.points_of(filling.mesh_of(cage))
    if np.ptp(np.concatenate([inside[:, 2], corners[:, 2]])) > PLANARITY * size(corners):
        raise UserError(f"'{obj.name}' and '{cage.name}' do not lie in one plane")
    try:
        kind, outline = KINDS[method](), filling.outline(cage)
        flat = np.ascontiguousarray(inside[:, :2])
        found, gradients = remembered(
            lambda: (core.cage_coordinates(flat, outline, kind), kind.gradients(flat, outline)),
            3 * flat.itemsize * len(flat) * len(outline.vertices),
            "coordinates", flat, outline, kind,
        )  # fmt: skip
        slopes = gradients @ there[:2, :2]  # along the object's own axes
    except core.NestedCagesError as error:
        raise UserError(f"'{obj.name}': {error}") from error
    dense = found if isinstance(found, np.ndarray) else found.toarray()
    columns = np.concatenate([dense[:, :, None], slopes], axis=2).astype(np.float32)
    clear(obj)
    for corner in range(columns.shape[1]):
        filling.add_attribute(filling.mesh_of(obj), f"{keys.WEIGHT}{corner}", "FLOAT_VECTOR", columns[:, corner])
    if surface is not None:
        return node_groups.add(obj, node_groups.COORDINATES_IN_PLACE, Object=surface)
    return node_groups.add(obj, node_groups.COORDINATES, Object=cage)


def clear(obj: bpy.types.Object) -> None:
    """Removes the weights from a mesh object."""
    attributes = obj.data.attributes
    for name in [attribute.name for attribute in attributes if attribute.name.startswith(keys.WEIGHT)]:
        attributes.remove(attributes[name])
