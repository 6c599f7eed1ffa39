"""The add-on's preferences: where its panels are."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty

from . import panels

# The extension's package, whatever name Blender gave it.
PACKAGE = __package__.rpartition(".")[0]


def _move_panels(preferences: NestedCagesPreferences, _context: bpy.types.Context) -> None:
    panels.move_to(preferences.category.strip() or panels.CATEGORY)


class NestedCagesPreferences(bpy.types.AddonPreferences):
    """Preferences of Nested Cages."""

    bl_idname = PACKAGE

    category: StringProperty(  # type: ignore[valid-type]
        name="Sidebar Tab",
        description="Tab of the 3D view's sidebar that holds the panels",
        default=panels.CATEGORY,
        update=_move_panels,
    )

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.prop(self, "category")


def register() -> None:
    bpy.utils.register_class(NestedCagesPreferences)
    addon = bpy.context.preferences.addons.get(PACKAGE)
    if addon is not None and addon.preferences is not None:
        panels.move_to(addon.preferences.category.strip() or panels.CATEGORY)


def unregister() -> None:
    bpy.utils.unregister_class(NestedCagesPreferences)
