"""The sidebar tab: settings, the button or the progress, and what was found. Panels read; they compute nothing."""

from __future__ import annotations

import textwrap

import bpy

from .. import keys
from ..generation import output
from ..generation.job import running
from ..presets import NESTEDCAGES_PT_presets
from ..properties import settings as properties
from ..properties.settings import copy_values, timing
from ..scene import ownership
from ..scene.selection import collection_of_active

CATEGORY = "Nested Cages"
# Letters in a line of a note: what fits into the sidebar as wide as Blender opens it.
NOTE_WIDTH = 36


class SidebarPanel:
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
        layout, settings = self.layout, context.scene.nested_cages
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        levels = column.row(align=True)
        levels.active = not settings.use_selected_as_levels
        levels.prop(settings, "levels")
        levels.operator("scene.nested_cages_level_add", text="", icon="ADD")
        if len(settings.level_list):
            _draw_list(column, settings)
        properties.draw(column, settings, properties.WHAT)
        properties.draw(layout.column(align=True), settings, properties.FRAMES)
        properties.draw(layout.column(), settings, (*properties.ANIMATION, *properties.LOOKS))
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
        properties.draw(layout.column(), context.scene.nested_cages, self.names)


class VIEW3D_PT_nested_cages_reading(SettingsPanel, bpy.types.Panel):
    """How the selected objects are read"""

    bl_label = "Drawing"
    names = properties.READING


class VIEW3D_PT_nested_cages_advanced(SettingsPanel, bpy.types.Panel):
    """The methods, for those who compare them; what is dimmed has no part in what is chosen"""

    bl_label = "Advanced"
    names = properties.ADVANCED


class VIEW3D_PT_nested_cages_result(SidebarPanel, bpy.types.Panel):
    """What is known of the active object's cages"""

    bl_label = "Result"
    bl_parent_id = "VIEW3D_PT_nested_cages"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return collection_of_active(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        collection = collection_of_active(context)
        layout = self.layout
        layout.label(text=collection.name, icon="OUTLINER_COLLECTION", translate=False)
        for obj in ownership.members(collection):
            box = layout.box().column(align=True)
            icon = "MOD_MESHDEFORM" if obj[keys.LEVEL] else "MESH_DATA"
            box.label(text=obj.name, icon=icon, translate=False)
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
        if ownership.is_bound(collection_of_active(context)):
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


def _draw_list(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
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
    frames = output.length(collection, timing(scene.nested_cages)) if collection is not None else None
    if frames is not None:
        seconds = frames * scene.render.fps_base / scene.render.fps
        layout.label(text=f"Length as before: {frames} frames, {seconds:.1f} s")


class NESTEDCAGES_UL_levels(bpy.types.UIList):
    """One level per line"""

    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property, _index=0) -> None:
        row = layout.row(align=True)
        row.prop(item, "kind", text="")
        row.prop(item, {"COUNT": "count", "PERCENT": "percent", "OBJECT": "own"}[item.kind], text="")


def _readout(obj: bpy.types.Object) -> list[tuple[str, str]]:
    """Label and value of what is stored on an output object."""
    rows = [("Vertices", str(obj.get(keys.VERTICES, "")))]
    if obj[keys.LEVEL]:
        rows += [
            ("Excess", f"{100.0 * obj[keys.EXCESS]:.2f} %"),
            ("Clearance", f"{obj[keys.CLEARANCE]:.3g}"),
            ("Time", f"{obj[keys.SECONDS]:.2f} s"),
        ]
        if keys.END in obj:
            rows.append(("Frames", f"{obj[keys.FLOW_START]} – {obj[keys.END]}"))
        if keys.CHECK in obj:
            rows.append(("Check", obj[keys.CHECK]))
    return rows


def _notes(obj: bpy.types.Object) -> list[str]:
    """Lines of what is said about an output object in whole sentences."""
    sentences = [f"Follows by {obj[keys.LINK]}"] if keys.LINK in obj else []
    sentences.append(obj.get(keys.NOTES, ""))
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
