"""The add-on: the only place that knows Blender."""

from __future__ import annotations

import bpy

from . import operators, presets
from .properties import settings
from .properties.settings import copy_values, settings_of
from .ui import manual, panels, preferences

# In the order of registration; each knows only those before it.
_ROOMS = (settings, operators, presets, panels, preferences, manual)


def _object_menu(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    """The entries in the 3D view's Object menu, with the scene's settings."""
    self.layout.separator()
    copy_values(settings_of(context), self.layout.operator("object.nested_cages_generate", icon="MOD_MESHDEFORM"))
    self.layout.operator("object.nested_cages_verify", icon="CHECKMARK")
    self.layout.operator("object.nested_cages_bind", icon="LINKED")
    self.layout.operator("object.nested_cages_from_image", icon="IMAGE_DATA")
    self.layout.operator("object.nested_cages_silhouette", icon="MOD_SOLIDIFY")
    self.layout.operator("object.nested_cages_export", icon="EXPORT")


def _import_menu(self: bpy.types.Menu, _context: bpy.types.Context) -> None:
    self.layout.operator("object.nested_cages_import", text="Outlines for Cages (.svg/.geojson/.json)")


def _export_menu(self: bpy.types.Menu, _context: bpy.types.Context) -> None:
    self.layout.operator("object.nested_cages_export", text="Nested Cages (.svg/.geojson/.json)")


_MENUS = (
    ("VIEW3D_MT_object", _object_menu),
    ("TOPBAR_MT_file_import", _import_menu),
    ("TOPBAR_MT_file_export", _export_menu),
)


def register() -> None:
    for room in _ROOMS:
        room.register()
    for menu, entries in _MENUS:
        getattr(bpy.types, menu).append(entries)


def unregister() -> None:
    for menu, entries in _MENUS:
        getattr(bpy.types, menu).remove(entries)
    for room in reversed(_ROOMS):
        room.unregister()
