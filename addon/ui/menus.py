"""The menus: one submenu in Object and in the context menu, which F3 searches, and files in File."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.types import Context

from ..blender.props import registration
from ..generate.settings import copy_values, settings_of
from ..operators.files import SELECTED

# Operators of the menu by their names, with their icons: groups after Generate, and what comes last.
ENTRIES: tuple[dict[str, Any], ...] = (
    {"select_fault": "VIEWZOOM", "verify": "CHECKMARK"},
    {
        "bind": "LINKED",
        "puppet": "OUTLINER_OB_ARMATURE",
        "walk": "ACTION",
        "snap": "SNAP_ON",
        "follow": "CON_FOLLOWTRACK",
        "live": "REC",
    },
    {"remove_animation": "X"},
)
OUTLINE = "Outline of Selected"
ON_FILES: dict[str, Any] = {"cutout": "IMAGE_PLANE", "import": "IMPORT", "export": "EXPORT"}


class VIEW3D_MT_nested_cages(bpy.types.Menu):
    """Operators for drawings and their cages"""

    bl_label = "Nested Cages"

    def draw(self, context: Context) -> None:
        layout = self.layout
        copy_values(settings_of(context), layout.operator("object.nested_cages_generate", icon="MOD_MESHDEFORM"))
        for group in ENTRIES:
            for name, icon in group.items():
                layout.operator(f"object.nested_cages_{name}", icon=icon)
            layout.separator()
        outline = layout.operator("object.nested_cages_import", text=OUTLINE, icon="OUTLINER_OB_MESH")
        outline.outlines = SELECTED
        for name, icon in ON_FILES.items():
            layout.operator(f"object.nested_cages_{name}", icon=icon)


def _object_menu(self: bpy.types.Menu, _context: Context) -> None:
    self.layout.separator()
    self.layout.menu(VIEW3D_MT_nested_cages.__name__, icon="MOD_MESHDEFORM")


def _file_menu(name: str, text: str) -> Any:
    """Draws an operator on files."""
    return lambda menu, _context: menu.layout.operator(f"object.nested_cages_{name}", text=text)


MENUS = (
    ("VIEW3D_MT_object", _object_menu),
    ("VIEW3D_MT_object_context_menu", _object_menu),
    ("TOPBAR_MT_file_import", _file_menu("import", "Outlines for Cages (.svg/.geojson/.json)")),
    ("TOPBAR_MT_file_export", _file_menu("export", "Nested Cages (.svg/.geojson/.json)")),
)


_register, _unregister = registration((VIEW3D_MT_nested_cages,))


def register() -> None:
    _register()
    for menu, entries in MENUS:
        getattr(bpy.types, menu).append(entries)


def unregister() -> None:
    for menu, entries in MENUS:
        getattr(bpy.types, menu).remove(entries)
    _unregister()
