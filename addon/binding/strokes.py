"""Grease Pencil strokes follow the fine mesh by Geometry Nodes, from Blender 4.3 on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
from mathutils.kdtree import KDTree

from .. import keys
from ..scene import filling
from ..scene.plane import space_to_space, transform
from . import node_groups

# Largest difference of a layer's matrix from none that is round-off.
UNMOVED = 1e-6


def why_not(source: bpy.types.Object) -> str:
    """Reason why the strokes of an object cannot follow; empty if they can."""
    data: Any = source.data
    for layer in data.layers:
        if np.abs(np.array(layer.matrix_local) - np.eye(4)).max() > UNMOVED:
            return f"layer '{layer.name}' of '{source.name}' has a transform of its own: clear it, then bind again"
    return ""


def add(source: bpy.types.Object, fine: bpy.types.Object, shown: bpy.types.Object) -> bpy.types.NodesModifier:
    """Makes each point of the strokes on this frame follow the nearest vertex of the fine mesh, which `shown` shows in
    the space of the strokes.

    Points drawn later do not follow until the drawing is bound again.
    """
    there = space_to_space(source, fine)
    corners = transform(there, filling.points_of(filling.mesh_of(fine)))
    tree = KDTree(len(corners))
    for number, corner in enumerate(corners):
        tree.insert(corner, number)
    tree.balance()
    clear(source)
    for drawing in _drawings(source):
        points = np.empty((len(drawing.attributes["position"].data), 3), np.float32)
        drawing.attributes["position"].data.foreach_get("vector", points.ravel())
        nearest = np.array([tree.find(point)[1] for point in points], dtype=np.int32)
        _store(drawing, keys.FOLLOWED, "INT", "value", nearest + 1)  # points without the attribute read 0
        _store(drawing, keys.OFFSET, "FLOAT_VECTOR", "vector", (points - corners[nearest]).astype(np.float32))
    return node_groups.add(source, node_groups.STROKES, Object=shown)


def clear(source: bpy.types.Object) -> None:
    """Removes the attributes of `add` from the strokes of all frames."""
    data: Any = source.data
    for drawing in (frame.drawing for layer in data.layers for frame in layer.frames):
        for name in (keys.FOLLOWED, keys.OFFSET):
            attribute = drawing.attributes.get(name) if drawing is not None else None
            if attribute is not None:
                drawing.attributes.remove(attribute)


def _drawings(source: bpy.types.Object) -> Iterator[Any]:
    """The drawings of all layers on this frame that have points."""
    data: Any = source.data
    for layer in data.layers:
        frame = layer.current_frame()
        if frame is not None and frame.drawing is not None and "position" in frame.drawing.attributes:
            yield frame.drawing


def _store(drawing: Any, name: str, kind: str, field: str, values: Any) -> None:
    drawing.attributes.new(name, kind, "POINT").data.foreach_set(field, values.ravel())
