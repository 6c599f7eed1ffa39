"""Modifiers and attributes of bindings by earlier versions, which followed in other ways."""

from __future__ import annotations

from typing import Any

import bpy

from .. import keys
from ..scene import display
from .field import FOLLOW

NAMES = (
    "Nested Cages Remember Edits",
    "Nested Cages Coordinates",
    "Nested Cages Surface Deform",
    "Nested Cages Mesh Deform",
    "Nested Cages Add Edits",
)


def release(obj: bpy.types.Object) -> None:
    """Removes the modifiers and weights of a bound mesh."""
    for name in NAMES:
        modifier = obj.modifiers.get(name)
        if modifier is not None:
            display.remove_modifier(obj, modifier)
    _clear(obj.data, keys.WEIGHT)


def release_originals(collection: bpy.types.Collection) -> None:
    """Restores the own shapes of the drawings that follow a collection."""
    for obj in [obj for obj in bpy.data.objects if obj.get(keys.FOLLOWS) == collection]:
        modifier = obj.modifiers.get(FOLLOW)
        if modifier is not None:
            display.remove_modifier(obj, modifier)
        if obj.type == "MESH":
            _clear(obj.data, keys.WEIGHT)
        for layer in obj.data.layers if obj.type == "GREASEPENCIL" else ():
            for drawing in [frame.drawing for frame in layer.frames if frame.drawing is not None]:
                _clear(drawing, keys.FOLLOWED, keys.OFFSET)
        del obj[keys.FOLLOWS]


def _clear(data: Any, *prefixes: str) -> None:
    for name in [attribute.name for attribute in data.attributes if attribute.name.startswith(prefixes)]:
        data.attributes.remove(data.attributes[name])
