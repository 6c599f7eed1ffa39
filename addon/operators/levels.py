"""Buttons next to the list of levels."""

from __future__ import annotations

import bpy
from bpy.props import IntProperty

from ..properties import level_list
from ..properties.settings import settings_of
from .base import Mixin, Outcome


class OnLevels(Mixin):
    """Base of operators that need a list with entries."""

    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = settings_of(context)
        if settings.level_index < len(settings.level_list):
            return True
        cls.poll_message_set("Choose a level in the list")
        return False


class SCENE_OT_nested_cages_level_add(bpy.types.Operator):
    """Adds a level."""

    bl_idname = "scene.nested_cages_level_add"
    bl_label = "Add Level"
    bl_description = "Add a coarser level, and show the levels as a list"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    def execute(self, context: bpy.types.Context) -> Outcome:
        level_list.add(settings_of(context))
        return {"FINISHED"}


class SCENE_OT_nested_cages_level_remove(OnLevels, bpy.types.Operator):
    """Removes a level."""

    bl_idname = "scene.nested_cages_level_remove"
    bl_label = "Remove Level"
    bl_description = "Remove the chosen level; at least one stays"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if len(settings_of(context).level_list) < 2:
            cls.poll_message_set("At least one level is needed")
            return False
        return super().poll(context)

    def execute(self, context: bpy.types.Context) -> Outcome:
        level_list.remove(settings_of(context))
        return {"FINISHED"}


class SCENE_OT_nested_cages_level_move(OnLevels, bpy.types.Operator):
    """Moves a level."""

    bl_idname = "scene.nested_cages_level_move"
    bl_label = "Move Level"
    bl_description = "Move the chosen level up or down in the list, which goes from the inside out"

    step: IntProperty(name="Step", description="Lines to move it down; up if negative", default=1, min=-1, max=1)

    def execute(self, context: bpy.types.Context) -> Outcome:
        level_list.move(settings_of(context), self.step)
        return {"FINISHED"}


CLASSES = (SCENE_OT_nested_cages_level_add, SCENE_OT_nested_cages_level_remove, SCENE_OT_nested_cages_level_move)
