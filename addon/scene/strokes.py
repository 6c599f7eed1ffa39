"""Grease Pencil drawings of version 3, available since Blender 4.3."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import UserError

# Stored values of the type of a stroke: Catmull-Rom spline, and polyline.
SMOOTH, STRAIGHT = 0, 1


def drawing(name: str, loops: Sequence[NDArray[np.float64]], radius: float) -> bpy.types.ID:
    """A new drawing with a closed stroke of straight pieces per loop (k, 3), and a material of its own.

    Raises: UserError before Blender 4.3.
    """
    if not hasattr(bpy.types, "GreasePencilDrawing"):
        raise UserError("Grease Pencil drawings need Blender 4.3 or later: choose curves instead")
    known: Any = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils)
    data: Any = known.new(name)
    strokes = data.layers.new(name).frames.new(bpy.context.scene.frame_current).drawing
    strokes.add_strokes([len(loop) for loop in loops])
    points = np.concatenate(loops).astype(np.float32)
    strokes.attributes["position"].data.foreach_set("vector", points.ravel())
    for stroke in strokes.strokes:
        stroke.cyclic = True
    for point in (point for stroke in strokes.strokes for point in stroke.points):
        point.radius = radius
        point.opacity = 1.0
    material = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(material)
    data.materials.append(material)
    made: bpy.types.ID = data
    return made


def set_colour(obj: bpy.types.Object, colour: Sequence[float]) -> None:
    """Gives the strokes of a new drawing a colour (4,)."""
    material: Any = obj.active_material
    material.grease_pencil.color = colour
    obj.color = colour
