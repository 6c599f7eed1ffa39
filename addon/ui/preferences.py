"""The add-on's preferences: the tab of its panels. The menus: one submenu in Object and in
the context menu, which F3 searches, and files in File; and the page of the guide, which comes with the add-on, about
the item under the pointer, for F1 and "Online Manual".
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
from bpy.app.handlers import persistent
from bpy.types import Context

from ..operators.base import last_fault
from ..operators.files import SHAPE_ITEMS
from ..properties import groups
from ..properties.groups import ANIMATION, FRAMES, PLACES, RULES, SHAPE
from ..properties.kinds import number, registration, text
from ..properties.settings import copy_values, settings_of
from . import panels

# Operators of the menu by their names, with their icons: groups after Generate, and what comes last.
ENTRIES: tuple[dict[str, Any], ...] = (
    {"select_fault": "VIEWZOOM", "verify": "CHECKMARK"},
    {"bind": "LINKED", "add_handles": "BONE_DATA", "suggest_bones": "GROUP_BONE", "rig": "ARMATURE_DATA"}
    | {
        "follow": "CON_FOLLOWTRACK",
        "live": "REC",
        "rebind": "FILE_REFRESH",
        "unbind": "UNLINKED",
        "adopt": "COMMUNITY",
    },
    {"remove_animation": "X"},
)
ON_FILES: dict[str, Any] = {"from_image": "IMAGE_DATA", "cutout": "IMAGE_PLANE", "silhouette": "MOD_SOLIDIFY"}
ON_FILES |= {"import": "IMPORT", "export": "EXPORT", "report": "TEXT"}


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
        for shape, name, _ in SHAPE_ITEMS:
            convert = layout.operator(
                "object.nested_cages_to_objects", text=f"Convert Cages to {name}", icon="OUTLINER_OB_MESH"
            )
            convert.shape = shape
        layout.operator("object.nested_cages_pieces", icon="MOD_EXPLODE")
        layout.separator()
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

# The folder of the extension, or of the repository.
ROOT = Path(__file__).resolve().parents[2]
# The guide in the extension's zip, and in the repository; the first one that exists is shown.
GUIDES = ((ROOT / "manual" / "docs" / "guide", ".html"), (ROOT / "docs" / "guide", ".md"))
# Suffixes of operators, prefixes of settings, and the page about each.
OPERATORS = {
    **dict.fromkeys(("verify", "report"), "verify"),
    **dict.fromkeys(("adopt", "bind", "rebind", "unbind", "add_handles"), "bind"),
    "remove_animation": "animation",
    **dict.fromkeys(("follow", "live"), "motion"),
    **dict.fromkeys(("to_objects", "pieces", "export", "import"), "export"),
    **dict.fromkeys(("from_image", "cutout"), "pictures"),
    **dict.fromkeys(("rig", "suggest_bones"), "characters"),
    "select_fault": "messages",
    "silhouette": "silhouette",
}
SETTINGS = {
    **dict.fromkeys(("level", "clearance", "inside", *SHAPE), "levels"),
    "use_selected_as_levels": "own_meshes",
    "together": "cages",
    **dict.fromkeys((*RULES, *PLACES), "shape"),
    **dict.fromkeys((*FRAMES, *ANIMATION), "animation"),
}
# Blender's names of items, in lower case with wildcards, and the page about them. The first match counts.
PAGES = (
    *((f"bpy.ops.object.nested_cages_{name}*", page) for name, page in OPERATORS.items()),
    *((f"bpy.types.*nested*cages*.{name}*", page) for name, page in SETTINGS.items()),
    ("bpy.ops.scene.nested_cages_preset*", "levels"),
    ("bpy.ops.scene.nested_cages_use_preset*", "levels"),
    ("bpy.types.nestedcagespreferences*", "install"),
    ("bpy.ops.*.nested_cages*", "cages"),
    ("bpy.types.*nested_cages*", "cages"),
    ("bpy.types.*nestedcages*", "cages"),
)


def manual_map() -> tuple[str, tuple[tuple[str, str], ...]]:
    """The prefix of all pages, and the pages; none without the guide."""
    found = next((guide for guide in GUIDES if guide[0].is_dir()), None)
    if found is None:
        return "", ()
    folder, ending = found
    return f"{folder.as_uri()}/", tuple((name, page + ending) for name, page in PAGES)


class NestedCagesPreferences(bpy.types.AddonPreferences):
    """Preferences of Nested Cages."""

    bl_idname = groups.PACKAGE

    category: text(
        "Sidebar Tab",
        "Tab in the sidebar of the 3D view that holds the panels",
        default=panels.CATEGORY,
        update=lambda preferences, _context: panels.move_to(preferences.category),
    )
    line_width: number(
        "Cage Width",
        "Width of cages in the 3D view; 0 leaves them as Blender's own wires",
        default=2.5,
        min=0.0,
        max=20.0,
        subtype="PIXEL",
    )

    def draw(self, _context: Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        for name in ("category", "line_width"):
            layout.prop(self, name)


@persistent  # type: ignore[untyped-decorator]
def _forget_fault(*_: object) -> None:
    """Forgets the fault of the file before."""
    last_fault.clear()


CLASSES = (VIEW3D_MT_nested_cages, NestedCagesPreferences)

_register, _unregister = registration(CLASSES)


def register() -> None:
    _register()
    bpy.utils.register_manual_map(manual_map)
    for menu, entries in MENUS:
        getattr(bpy.types, menu).append(entries)
    bpy.app.handlers.load_post.append(_forget_fault)
    found = groups.preferences()
    if found is not None:
        panels.move_to(found.category)


def unregister() -> None:
    bpy.app.handlers.load_post.remove(_forget_fault)
    for menu, entries in MENUS:
        getattr(bpy.types, menu).remove(entries)
    bpy.utils.unregister_manual_map(manual_map)
    _unregister()
