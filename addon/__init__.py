"""The add-on: the only place that knows Blender."""

from __future__ import annotations

import bpy

from . import operators, panels, properties
from .properties import copy_values

_CLASSES = (*operators.CLASSES, *panels.CLASSES)


def _object_menu(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    """The entry in the 3D view's Object menu, with the scene's settings."""
    self.layout.separator()
    copy_values(context.scene.nested_cages, self.layout.operator("object.nested_cages_generate", icon="MOD_MESHDEFORM"))


def register() -> None:
    properties.register()
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_object.append(_object_menu)


def unregister() -> None:
    bpy.types.VIEW3D_MT_object.remove(_object_menu)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    properties.unregister()
