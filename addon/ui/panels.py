"""The sidebar tab: settings, the button or the progress, and results. Panels only read; they compute nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
from bpy.types import Collection, Context

from .. import record
from ..animation.timeline import Timing
from ..binding import binding
from ..binding.adoption import waiting
from ..errors import UserError
from ..generation import output
from ..generation.job import running
from ..generation.levels import lengths, loop_sizes, meanings, parse_levels
from ..operators.base import last_fault
from ..operators.presets import NESTEDCAGES_PT_presets
from ..properties import groups
from ..properties.kinds import registration
from ..properties.settings import NestedCagesSettings, copy_values, filled, settings_of
from ..scene import ownership
from ..scene.ownership import chosen, collection_of_active, outputs_of_active, scene_of
from . import results

CATEGORY = "Nested Cages"

# Blender only reads properties of bases that are not registered.
if TYPE_CHECKING:
    Mixin = bpy.types.Panel
else:
    Mixin = object


def _split(layout: Any) -> Any:
    """A layout with names at the left of settings."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


class SidebarPanel(Mixin):
    """Base of all panels: their place."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = CATEGORY


class PartPanel(SidebarPanel):
    """A closed part of the main panel, with the settings that its title stands for."""

    bl_parent_id = "VIEW3D_PT_nested_cages"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        groups.draw(_split(self.layout).column(), settings_of(context), groups.SECTIONS[self.bl_label])


class VIEW3D_PT_nested_cages(SidebarPanel, bpy.types.Panel):
    """Settings of the cages and the button that generates them"""

    bl_label = "Nested Cages"

    def draw_header_preset(self, _context: Context) -> None:
        NESTEDCAGES_PT_presets.draw_panel_header(self.layout)

    def draw(self, context: Context) -> None:
        settings, layout = settings_of(context), _split(self.layout)
        column = layout.column()
        levels = column.row()
        levels.active = not settings.use_selected_as_levels
        levels.prop(settings, "levels")
        for line in _said_of_levels(context, settings):
            row = column.row()
            row.alignment = "RIGHT"
            row.label(text=line, translate=False)
        groups.draw(column, settings, groups.SPACE)
        job = running()
        if job is None:
            row = layout.row()
            row.scale_y = 1.5
            copy_values(settings, row.operator("object.nested_cages_generate", icon="MOD_MESHDEFORM"))
        else:
            layout.progress(factor=job.fraction, text=job.message)
            layout.operator("object.nested_cages_cancel", icon="CANCEL")
        if last_fault:
            layout.operator("object.nested_cages_select_fault", icon="VIEWZOOM")
        _draw_binding(layout, collection_of_active(context))


class VIEW3D_PT_nested_cages_result(SidebarPanel, bpy.types.Panel):
    """Results for the active object's cages"""

    bl_label = "Result"
    bl_parent_id = "VIEW3D_PT_nested_cages"

    @classmethod
    def poll(cls, context: Context) -> bool:
        return collection_of_active(context) is not None

    def draw(self, context: Context) -> None:
        layout: Any = self.layout
        outputs = outputs_of_active(context)
        for collection in outputs:
            results.draw_output(layout, collection)
        column = layout.column(align=True)
        column.operator("object.nested_cages_verify", icon="CHECKMARK")
        if any(ownership.is_bound(each) or record.of(each).moving for each in outputs):
            column.operator("object.nested_cages_verify", text="Verify Whole Animation", icon="SEQUENCE").whole = True
        column.operator("object.nested_cages_report", icon="TEXT")
        results.draw_live(column)


class VIEW3D_PT_nested_cages_animation(PartPanel, bpy.types.Panel):
    """Timing of the animation of how the cages form"""

    bl_label = "Animation"

    def draw(self, context: Context) -> None:
        settings, layout = settings_of(context), _split(self.layout)
        groups.draw(layout.column(align=True), settings, groups.FRAMES)
        groups.draw(layout.column(), settings, groups.ANIMATION)
        collection, scene = collection_of_active(context), context.scene
        timing = filled(Timing, settings)
        frames = output.duration(collection, timing) if collection is not None else None
        if frames is not None:  # with these settings, from the steps of the output
            seconds = frames * scene.render.fps_base / scene.render.fps
            layout.label(text=f"Length as before: {frames} frames, {seconds:.1f} s")
        if collection is not None:
            layout.operator("object.nested_cages_remove_animation", icon="X")


class VIEW3D_PT_nested_cages_character(PartPanel, bpy.types.Panel):
    """Many drawings in one cage that bones move"""

    bl_label = "Character"

    def draw(self, context: Context) -> None:
        layout, collection = self.layout, collection_of_active(context)
        column = layout.column(align=True)
        column.operator("object.nested_cages_suggest_bones", icon="GROUP_BONE")
        column.operator("object.nested_cages_rig", icon="ARMATURE_DATA")
        if collection is not None and ownership.is_bound(collection) and binding.newcomers(context, collection):
            layout.operator("object.nested_cages_bind", text="Bind New Parts", icon="LINKED")


class VIEW3D_PT_nested_cages_motion(PartPanel, bpy.types.Panel):
    """Cages that follow a drawing"""

    bl_label = "Motion"

    def draw(self, context: Context) -> None:
        self.layout.operator("object.nested_cages_follow", icon="ARMATURE_DATA")


class VIEW3D_PT_nested_cages_rules(PartPanel, bpy.types.Panel):
    """What cages must be, apart from tight: convex, on a grid, symmetric, finer where it matters"""

    bl_label = groups.SHAPE_TITLE


class VIEW3D_PT_nested_cages_reading(PartPanel, bpy.types.Panel):
    """Which objects to enclose, how to read them, and how cages start"""

    bl_label = "Drawing and Cages"


class VIEW3D_PT_nested_cages_use(PartPanel, bpy.types.Panel):
    """The active object's cages as other objects and as files"""

    bl_label = "Convert and Export"
    poll = VIEW3D_PT_nested_cages_result.poll

    def draw(self, context: Context) -> None:
        layout = self.layout
        column = layout.column(align=True)
        column.operator(
            "object.nested_cages_to_objects", text="Convert Cages to Curves", icon="OUTLINER_OB_CURVE"
        ).shape = "CURVE"
        column.operator_menu_enum("object.nested_cages_to_objects", "shape", icon="OUTLINER_OB_MESH")
        column.operator("object.nested_cages_pieces", icon="MOD_EXPLODE")
        layout.operator("object.nested_cages_export", icon="EXPORT")


def _said_of_levels(context: Context, settings: NestedCagesSettings) -> list[str]:
    """The vertex counts of the levels for the active drawing: "20 % = 93 vertices"."""
    active = context.view_layer.objects.active
    if active is None or active.mode != "OBJECT" or ownership.level_of(active) is not None:
        return []
    sizes, known = loop_sizes(active, settings.resolution), lengths(scene_of(context))
    try:
        levels = parse_levels(settings.levels, known) if sum(sizes) else ()
    except UserError:
        return []
    return meanings(levels, sizes, active.dimensions.length, next(iter(known.items()))) if levels else []


def _draw_binding(layout: bpy.types.UILayout, collection: Collection | None) -> None:
    """Bind, or the operators for bound cages."""
    if collection is None or not ownership.is_bound(collection):
        layout.operator("object.nested_cages_bind", icon="LINKED")
        if collection is None and waiting(chosen(bpy.context)):
            layout.operator("object.nested_cages_adopt", icon="COMMUNITY")
        return
    layout.operator("object.nested_cages_add_handles", icon="BONE_DATA")
    row = layout.row(align=True)
    row.operator("object.nested_cages_rebind", icon="FILE_REFRESH")
    row.operator("object.nested_cages_unbind", icon="UNLINKED")


# In this order, which is that of the panels.
CLASSES: list[Any] = [
    found
    for found in list(globals().values())
    if isinstance(found, type) and found.__module__ == __name__ and issubclass(found, bpy.types.Panel)
]

register, unregister = registration(CLASSES)


def move_to(category: str) -> None:
    """Shows the panels in another tab of the sidebar; without a name, in their own."""
    category = category.strip() or CATEGORY
    panels = [cls for cls in CLASSES if issubclass(cls, SidebarPanel)]
    if all(cls.bl_category == category for cls in panels):
        return
    unregister()
    for cls in panels:
        cls.bl_category = category
    register()
