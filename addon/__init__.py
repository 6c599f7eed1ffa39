"""The add-on: the only place that knows Blender."""

from __future__ import annotations

import bpy

from . import manual, operators, panels, preferences, presets, properties
from .properties import copy_values

# In the order of registration; each knows only those before it.
_ROOMS = (properties, operators, presets, panels, preferences, manual)


def _object_menu(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    """The entries in the 3D view's Object menu, with the scene's settings."""
    self.layout.separator()
    copy_values(context.scene.nested_cages, self.layout.operator("object.nested_cages_generate", icon="MOD_MESHDEFORM"))
    self.layout.operator("object.nested_cages_verify", icon="CHECKMARK")
    self.layout.operator("object.nested_cages_bind", icon="LINKED")
    self.layout.operator("object.nested_cages_from_image", icon="IMAGE_DATA")
    self.layout.operator("object.nested_cages_export", icon="EXPORT")


def register() -> None:
    for room in _ROOMS:
        room.register()
    bpy.types.VIEW3D_MT_object.append(_object_menu)


def unregister() -> None:
    bpy.types.VIEW3D_MT_object.remove(_object_menu)
    for room in reversed(_ROOMS):
        room.unregister()
