"""The add-on's preferences: the tab of its panels."""

from __future__ import annotations

import bpy
from bpy.types import Context

from ..blender.props import registration, text
from ..generate import groups
from . import panels


def _move_panels(preferences: NestedCagesPreferences, _context: Context) -> None:
    panels.move_to(preferences.category)


class NestedCagesPreferences(bpy.types.AddonPreferences):
    """Preferences of Nested Cages."""

    bl_idname = groups.PACKAGE

    category: text(
        "Sidebar Tab",
        "Tab in the sidebar of the 3D view that holds the panels",
        default=panels.CATEGORY,
        update=_move_panels,
    )

    def draw(self, _context: Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "category")


_register, unregister = registration((NestedCagesPreferences,))


def register() -> None:
    _register()
    chosen = groups.preferences()
    if chosen is not None:
        panels.move_to(chosen.category)
