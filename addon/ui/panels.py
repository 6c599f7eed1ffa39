"""The sidebar tab: Cages, Puppet and Cutout. Panels compute nothing; what they show of objects is in `data`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
from bpy.types import Context

from ..blender.jobs import running
from ..blender.props import registration
from ..errors import last_fault
from ..generate import groups
from ..generate.settings import copy_values, settings_of
from ..motion import live
from ..operators.bind import REST
from ..operators.files import SELECTED
from ..operators.puppet import ONE_CAGE
from ..puppets.controls import reach_of
from . import data, sentences
from .menus import OUTLINE

CATEGORY = "Nested Cages"

# Blender only reads properties of bases that are not registered.
if TYPE_CHECKING:
    Mixin = bpy.types.Panel
else:
    Mixin = object


class SidebarPanel(Mixin):
    """Base of all panels: their place."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = CATEGORY


class SettingsPanel(SidebarPanel):
    """A closed sub-panel of Cages with the settings that its title stands for."""

    bl_parent_id = "VIEW3D_PT_nested_cages"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        groups.draw(_settings(self.layout), settings_of(context), groups.SECTIONS[self.bl_label])


def _settings(layout: Any) -> Any:
    """A column with names at the left of settings."""
    column = layout.column()
    column.use_property_split, column.use_property_decorate = True, False
    return column


def _button(layout: Any, name: str, **options: Any) -> Any:
    """The button to press, or in its place what it is doing."""
    row, job = layout.row(align=True), running()
    row.scale_y = 1.5
    if job is None:
        return row.operator(f"object.nested_cages_{name}", **options)
    row.progress(factor=job.fraction, text=job.message)
    row.operator("object.nested_cages_cancel", text="", icon="CANCEL")
    return None


def _menu(layout: Any, name: str, prop: str, **options: Any) -> None:
    """A menu of the values of a setting of an operator, greyed out like its button."""
    row = layout.row()
    row.enabled = getattr(bpy.ops.object, f"nested_cages_{name}").poll()
    row.operator_menu_enum(f"object.nested_cages_{name}", prop, **options)


class VIEW3D_PT_nested_cages(SidebarPanel, bpy.types.Panel):
    """Coarse outlines that strictly enclose drawings, and move them"""

    bl_label = "Cages"

    def draw(self, context: Context) -> None:
        layout: Any = self.layout
        settings, now = settings_of(context), data.shown(context)
        row = layout.row()
        if now.title:
            row.label(text=now.title, translate=False)
        if last_fault:
            row.operator("object.nested_cages_select_fault", icon="VIEWZOOM")
        if now.hint:
            sentences.draw(layout.column(align=True), context, now.hint, "INFO")
            if context.mode in data.USABLE:
                layout.operator("object.nested_cages_import", icon="IMPORT")
            else:
                layout.operator("object.mode_set", text="Object Mode", icon="OBJECT_DATAMODE").mode = "OBJECT"
        button = _button(layout, "generate", text="Generate", icon="MOD_MESHDEFORM")
        if button is not None:
            copy_values(settings, button)
        column = _settings(layout)
        row = column.row()
        row.active = not settings.use_selected_as_levels
        row.prop(settings, "levels")
        if now.counts:
            sentences.draw(column.column(align=True), context, now.counts)
        groups.draw(column, settings, (*groups.SPACE, *groups.WHICH))
        following = live.current()
        row = layout.row(align=True)
        row.operator(
            "object.nested_cages_bind", text="Bound" if now.bound else "Bind", icon="LINKED", depress=now.bound
        )
        row.operator("object.nested_cages_live", icon="REC", depress=following is not None)
        if now.bound:
            layout.operator("object.nested_cages_bind", text="Rest from Pose", icon="FILE_REFRESH").action = REST
        if following is not None:
            state, icon = ("Out of date", "TIME") if following.behind else ("Up to date", "CHECKMARK")
            sentences.draw(layout.column(align=True), context, following.problem or state, icon)
        column = layout.column(align=True)
        column.operator("object.nested_cages_export", icon="EXPORT")
        outline = column.operator("object.nested_cages_import", text=OUTLINE, icon="OUTLINER_OB_MESH")
        outline.outlines = SELECTED


class VIEW3D_PT_nested_cages_result(SidebarPanel, bpy.types.Panel):
    """The cages of the active object, and whether they hold"""

    bl_label = "Result"
    bl_parent_id = "VIEW3D_PT_nested_cages"

    @classmethod
    def poll(cls, context: Context) -> bool:
        return bool(data.shown(context).sets)

    def draw(self, context: Context) -> None:
        layout: Any = self.layout
        now = data.shown(context)
        for each in now.sets:
            layout.label(text=each.name, icon="OUTLINER_COLLECTION", translate=False)
            if each.changed:
                layout.label(text="Drawing changed", icon=data.EDITED)
            column = layout.box().column(align=True)
            for cage in each.cages:
                sentences.draw(column, context, cage.text, cage.icon)
                sentences.draw(column, context, cage.sentence, "BLANK1")
                if cage.icon == data.BROKEN:
                    column.operator("object.nested_cages_select_fault", icon="VIEWZOOM").cage = cage.name
        row = layout.row(align=True)
        row.operator("object.nested_cages_verify", text="Verify", icon="CHECKMARK")
        if now.plays:
            row.operator("object.nested_cages_verify", text="All Frames", icon="SEQUENCE").whole = True


class VIEW3D_PT_nested_cages_constraints(SettingsPanel, bpy.types.Panel):
    """What cages must be, apart from tight: convex, on a grid, symmetric, finer where it matters"""

    bl_label = groups.CONSTRAINTS


class VIEW3D_PT_nested_cages_animation(SettingsPanel, bpy.types.Panel):
    """How the forming of cages plays; cages of a moving drawing"""

    bl_label = "Animation"

    def draw(self, context: Context) -> None:
        SettingsPanel.draw(self, context)
        column = self.layout.column(align=True)
        column.operator("object.nested_cages_follow", icon="CON_FOLLOWTRACK")
        column.operator("object.nested_cages_remove_animation", icon="X")


class VIEW3D_PT_nested_cages_advanced(SettingsPanel, bpy.types.Panel):
    """How drawings are read, and the parts of the method"""

    bl_label = "Advanced"


class VIEW3D_PT_nested_cages_puppet(SidebarPanel, bpy.types.Panel):
    """Bones that move the parts of a character, or one cage around it"""

    bl_label = "Puppet"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        layout, now = self.layout, data.shown(context)
        if not now.title or (now.armature and not now.sets):
            hint = "Select the drawings to move, too." if now.armature else "Select parts of a character, or import it."
            sentences.draw(layout.column(align=True), context, hint, "INFO")
        button = _button(layout, "puppet", icon="ARMATURE_DATA")
        if button is not None and now.armature:
            button.source = ONE_CAGE
        column = layout.column(align=True)
        _menu(column, "puppet", "source", text="From", icon="MOD_ARMATURE")
        if now.armature or now.puppet:
            column.operator("object.nested_cages_bind", text="Bind New Parts", icon="LINKED")
        column.operator("object.nested_cages_import", text="Import Puppet", icon="IMPORT").outlines = "PUPPET"
        puppet = bpy.data.objects.get(now.puppet)
        if puppet is not None:
            layout.operator("object.nested_cages_walk")
            column = layout.column(align=True)
            bones = filter(None, map(puppet.pose.bones.get, now.reaching))
            for reach in filter(None, map(reach_of, bones)):
                row = column.row(align=True)
                row.prop(reach, "influence", text=reach.subtarget, slider=True, translate=False)
                row.operator("object.nested_cages_snap", text="", icon="SNAP_ON").control = reach.subtarget
            layout.operator("object.nested_cages_verify", text="Verify All Frames", icon="SEQUENCE").whole = True
        layout.operator("object.nested_cages_export", icon="EXPORT")


class VIEW3D_PT_nested_cages_cutout(SidebarPanel, bpy.types.Panel):
    """Pictures with a transparent background as meshes to pose"""

    bl_label = "Cutout"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        layout = self.layout
        if not data.shown(context).title:
            sentences.draw(
                layout.column(align=True), context, "Press Cutout to choose pictures, or select some.", "INFO"
            )
        _button(layout, "cutout", icon="IMAGE_PLANE")
        column = layout.column(align=True)
        column.operator("object.nested_cages_import", text=OUTLINE, icon="IMAGE_DATA").outlines = SELECTED
        column.operator("object.nested_cages_export", icon="EXPORT")


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
    if all(cls.bl_category == category for cls in CLASSES):
        return
    unregister()
    for cls in CLASSES:
        cls.bl_category = category
    register()
