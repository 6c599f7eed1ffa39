"""The sidebar tab: three doors, results, and settings. Panels only read; they compute nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
from bpy.types import Context

from ..animation.timeline import Timing
from ..generation import output
from ..properties import groups
from ..properties.kinds import registration
from ..properties.settings import filled, settings_of
from ..scene.ownership import set_of_active, sets_of_active
from . import doors, results

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
    """A closed part of the main panel, with settings of cages around drawings that its title stands for."""

    bl_parent_id = "VIEW3D_PT_nested_cages"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        return doors.opened(context) == doors.CAGES

    def draw(self, context: Context) -> None:
        groups.draw(_split(self.layout).column(), settings_of(context), groups.SECTIONS[self.bl_label])


class VIEW3D_PT_nested_cages(SidebarPanel, bpy.types.Panel):
    """Three doors by task, and what is behind the one that fits the selection"""

    bl_label = "Nested Cages"

    def draw(self, context: Context) -> None:
        doors.draw(self.layout, context)


class VIEW3D_PT_nested_cages_result(SidebarPanel, bpy.types.Panel):
    """Results for the active object's cages"""

    bl_label = "Result"
    bl_parent_id = "VIEW3D_PT_nested_cages"

    @classmethod
    def poll(cls, context: Context) -> bool:
        return set_of_active(context) is not None

    def draw(self, context: Context) -> None:
        layout: Any = self.layout
        outputs = sets_of_active(context)
        for cage_set in outputs:
            results.draw_set(layout, context, cage_set)
        column = layout.column(align=True)
        column.operator("object.nested_cages_verify", icon="CHECKMARK")
        if any(bool(each.bound) or each.record.moving for each in outputs):
            column.operator("object.nested_cages_verify", text="Verify Whole Animation", icon="SEQUENCE").whole = True
        results.draw_live(column)


class VIEW3D_PT_nested_cages_animation(PartPanel, bpy.types.Panel):
    """Timing of the animation of how the cages form"""

    bl_label = "Animation"

    def draw(self, context: Context) -> None:
        settings, layout = settings_of(context), _split(self.layout)
        groups.draw(layout.column(align=True), settings, groups.FRAMES)
        groups.draw(layout.column(), settings, groups.ANIMATION)
        cage_set, scene = set_of_active(context), context.scene
        timing = filled(Timing, settings)
        frames = output.duration(cage_set, timing) if cage_set is not None else None
        if frames is not None:  # with these settings, from the steps of the output
            seconds = frames * scene.render.fps_base / scene.render.fps
            layout.label(text=f"Length as before: {frames} frames, {seconds:.1f} s")
        if cage_set is not None:
            layout.operator("object.nested_cages_remove_animation", icon="X")


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
        layout.operator_menu_enum("object.nested_cages_to_objects", "shape", icon="OUTLINER_OB_MESH")
        layout.operator("object.nested_cages_export", icon="EXPORT")


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
