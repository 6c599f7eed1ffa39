"""The sidebar tab: settings, the button or the progress, and what was found. Panels read; they compute nothing."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import bpy

from .. import keys
from ..generation import output
from ..generation.job import running
from ..presets import NESTEDCAGES_PT_presets
from ..properties import conversion, groups
from ..properties.settings import NestedCagesSettings, copy_values, settings_of
from ..scene import ownership
from ..scene.selection import collection_of_active, output_of_active

CATEGORY = "Nested Cages"
# Letters in a line of a note: what fits into the sidebar as wide as Blender opens it.
NOTE_WIDTH = 36


# Blender looks for what panels share only in bases that it does not know itself.
if TYPE_CHECKING:
    Mixin = bpy.types.Panel
else:
    Mixin = object


class SidebarPanel(Mixin):
    """Where all panels of the add-on are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = CATEGORY


class VIEW3D_PT_nested_cages(SidebarPanel, bpy.types.Panel):
    """Settings of the cages and the button that generates them"""

    bl_label = "Nested Cages"

    def draw_header_preset(self, _context: bpy.types.Context) -> None:
        NESTEDCAGES_PT_presets.draw_panel_header(self.layout)

    def draw(self, context: bpy.types.Context) -> None:
        settings = settings_of(context)
        layout: Any = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        levels = column.row(align=True)
        levels.active = not settings.use_selected_as_levels
        levels.prop(settings, "levels")
        levels.operator("scene.nested_cages_level_add", text="", icon="ADD")
        if len(settings.level_list):
            _draw_list(column, settings)
        groups.draw(column, settings, groups.WHAT)
        groups.draw(layout.column(align=True), settings, groups.FRAMES)
        groups.draw(layout.column(), settings, (*groups.ANIMATION, *groups.LOOKS))
        _draw_length(layout, context)
        job = running()
        if job is None:
            row = layout.row()
            row.scale_y = 1.5
            copy_values(settings, row.operator("object.nested_cages_generate", icon="MOD_MESHDEFORM"))
        else:
            layout.progress(factor=job.fraction, text=job.message)
            layout.operator("object.nested_cages_cancel", icon="CANCEL")


class SettingsPanel(SidebarPanel):
    """A closed part of the main panel with settings."""

    bl_parent_id = "VIEW3D_PT_nested_cages"
    bl_options = {"DEFAULT_CLOSED"}
    names: tuple[str, ...] = ()

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        groups.draw(layout.column(), settings_of(context), self.names)


class VIEW3D_PT_nested_cages_reading(SettingsPanel, bpy.types.Panel):
    """How the selected objects are read"""

    bl_label = "Drawing"
    names = groups.READING


class VIEW3D_PT_nested_cages_advanced(SettingsPanel, bpy.types.Panel):
    """Methods of computation. Greyed-out settings don't apply to the chosen methods"""

    bl_label = "Advanced"
    names = groups.ADVANCED


class VIEW3D_PT_nested_cages_result(SidebarPanel, bpy.types.Panel):
    """What is known of the active object's cages"""

    bl_label = "Result"
    bl_parent_id = "VIEW3D_PT_nested_cages"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return collection_of_active(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        collection, layout = output_of_active(context), self.layout
        layout.label(text=collection.name, icon="OUTLINER_COLLECTION", translate=False)
        for obj in ownership.members(collection):
            box = layout.box().column(align=True)
            box.label(text=obj.name, icon="MOD_MESHDEFORM" if ownership.level_of(obj) else "MESH_DATA", translate=False)
            for label, text in _readout(obj):
                row = box.split(factor=0.45)
                row.label(text=label)
                row.label(text=text, translate=False)
            for line in _notes(obj):
                box.label(text=line, translate=False)
        column = layout.column(align=True)
        column.operator("object.nested_cages_verify", icon="CHECKMARK")
        if ownership.is_bound(collection):
            column.operator("object.nested_cages_verify", text="Verify Whole Animation", icon="SEQUENCE").whole = True


class VIEW3D_PT_nested_cages_use(SidebarPanel, bpy.types.Panel):
    """What can be done with the active object's cages"""

    bl_label = "Use"
    bl_parent_id = "VIEW3D_PT_nested_cages"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return collection_of_active(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        if ownership.is_bound(output_of_active(context)):
            row = layout.row(align=True)
            row.operator("object.nested_cages_rebind", icon="FILE_REFRESH")
            row.operator("object.nested_cages_unbind", icon="UNLINKED")
        else:
            layout.operator("object.nested_cages_bind", icon="LINKED")
        column = layout.column(align=True)
        column.operator("object.nested_cages_bake_action", icon="ACTION")
        column.operator("object.nested_cages_remove_animation", icon="X")
        column = layout.column(align=True)
        column.operator(
            "object.nested_cages_to_objects", text="Convert Cages to Curves", icon="OUTLINER_OB_CURVE"
        ).shape = "CURVE"
        column.operator_menu_enum("object.nested_cages_to_objects", "shape", icon="OUTLINER_OB_MESH")
        layout.operator("object.nested_cages_export", icon="EXPORT")


def _draw_list(layout: bpy.types.UILayout, settings: NestedCagesSettings) -> None:
    """The levels one by one, and the buttons that change their number and order."""
    row = layout.row()
    row.active = not settings.use_selected_as_levels
    row.template_list("NESTEDCAGES_UL_levels", "", settings, "level_list", settings, "level_index", rows=3)
    buttons = row.column(align=True)
    buttons.operator("scene.nested_cages_level_remove", text="", icon="REMOVE")
    buttons.operator("scene.nested_cages_level_move", text="", icon="TRIA_UP").step = -1
    buttons.operator("scene.nested_cages_level_move", text="", icon="TRIA_DOWN").step = 1


def _draw_length(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How long the animation will be with these settings, known from the steps that the cages were made of before."""
    collection, scene = collection_of_active(context), context.scene
    frames = output.length(collection, conversion.timing(settings_of(context))) if collection is not None else None
    if frames is not None:
        seconds = frames * scene.render.fps_base / scene.render.fps
        layout.label(text=f"Length as before: {frames} frames, {seconds:.1f} s")


class NESTEDCAGES_UL_levels(bpy.types.UIList):
    """One level per line"""

    def draw_item(
        self,
        _context: bpy.types.Context,
        layout: bpy.types.UILayout,
        _data: Any,
        item: Any,
        _icon: int | None,
        _active_data: Any,
        _active_property: str | None,
        _index: int | None = 0,
        _filter_flag: int | None = 0,
    ) -> None:
        row = layout.row(align=True)
        row.prop(item, "kind", text="")
        row.prop(item, {"COUNT": "count", "PERCENT": "percent", "OBJECT": "own"}[item.kind], text="")


# What is stored on cages, and how it is shown.
READOUT: tuple[tuple[str, str, Callable[[float], str]], ...] = (
    ("Excess", keys.EXCESS, lambda value: f"{100.0 * value:.2f} %"),
    ("Clearance", keys.CLEARANCE, lambda value: f"{value:.3g}"),
    ("Time", keys.SECONDS, lambda value: f"{value:.2f} s"),
)


def _readout(obj: bpy.types.Object) -> list[tuple[str, str]]:
    """Label and value of what is stored on an output object."""
    vertices = keys.integer(obj, keys.VERTICES)
    rows = [("Vertices", "" if vertices is None else str(vertices))]
    for label, key, shown in READOUT:
        value = keys.number(obj, key)
        if value is not None:
            rows.append((label, shown(value)))
    start, end = keys.integer(obj, keys.FLOW_START), keys.integer(obj, keys.END)
    if start is not None and end is not None:
        rows.append(("Frames", f"{start} – {end}"))
    if verdict := keys.text(obj, keys.CHECK):
        rows.append(("Check", verdict))
    return rows


def _notes(obj: bpy.types.Object) -> list[str]:
    """Lines of what is said about an output object in whole sentences."""
    link = keys.text(obj, keys.LINK)
    sentences = [f"Follows by {link}" if link else "", keys.text(obj, keys.NOTES)]
    return [line for sentence in sentences for line in textwrap.wrap(sentence, NOTE_WIDTH)]


CLASSES = (
    NESTEDCAGES_UL_levels,
    VIEW3D_PT_nested_cages,
    VIEW3D_PT_nested_cages_reading,
    VIEW3D_PT_nested_cages_advanced,
    VIEW3D_PT_nested_cages_result,
    VIEW3D_PT_nested_cages_use,
)


def move_to(category: str) -> None:
    """Shows the panels in another tab of the sidebar."""
    panels = [cls for cls in CLASSES if issubclass(cls, SidebarPanel)]
    if all(cls.bl_category == category for cls in panels):
        return
    unregister()
    for cls in panels:
        cls.bl_category = category
    register()


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
