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
    """A new drawing with a closed polyline per loop (k, 3) and a material. Raises: UserError before Blender 4.3."""
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


def is_shown(layer: Any) -> bool:
    """Whether a layer and the groups that it is in are shown."""
    group = layer.parent_group
    while group is not None and not group.hide:
        group = group.parent_group
    return group is None and not layer.hide and layer.opacity > 0.0


def unseen(obj: bpy.types.Object) -> dict[Any, list[int]]:
    """Shown layers, each with the numbers of its strokes that do not show. Raises: UserError for masks."""
    layers = [layer for layer in obj.data.layers if is_shown(layer)]
    for layer in layers:
        if layer.use_masks and any(not mask.hide for mask in layer.mask_layers):
            raise UserError(f"layer '{layer.name}' of '{obj.name}' has masks: switch them off, or cut the strokes")
    drawn = {layer: frame.drawing for layer in layers if (frame := layer.current_frame()) is not None}
    found = {layer: list(drawing.strokes) for layer, drawing in drawn.items() if drawing is not None}
    # Strokes made by scripts have no opacity unless it is set, and are meant to be seen.
    opaque = any(_has_opacity(stroke) for strokes in found.values() for stroke in strokes)
    return {
        layer: [
            number
            for number, stroke in enumerate(strokes)
            if (opaque and not _has_opacity(stroke)) or getattr(style_of(obj, stroke), "hide", False)
        ]
        for layer, strokes in found.items()
    }


def hides(obj: bpy.types.Object) -> bool:
    """Whether anything of an object is not displayed. Raises: UserError for masks."""
    found = unseen(obj)
    return any(found.values()) or not all(map(is_shown, obj.data.layers))


def remove_hidden(obj: bpy.types.Object) -> None:
    """Removes what an object does not display."""
    layers: Any = obj.data.layers
    for layer, numbers in unseen(obj).items():
        if numbers:
            layer.current_frame().drawing.remove_strokes(indices=numbers)
    for layer in [layer for layer in layers if not is_shown(layer)]:
        layers.remove(layer)


def style_of(obj: bpy.types.Object, stroke: Any) -> Any:
    """The Grease Pencil style of a stroke, None without a material."""
    slots, index = obj.material_slots, stroke.material_index
    material = slots[index].material if index < len(slots) else None
    return material.grease_pencil if material is not None else None


def _has_opacity(stroke: Any) -> bool:
    """Whether a stroke has any opacity."""
    return stroke.fill_opacity > 0.0 or any(point.opacity > 0.0 for point in stroke.points)
