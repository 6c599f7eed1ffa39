"""Bake to One Action, and Remove Animation."""

from __future__ import annotations

import bpy

from ..animation import bake
from ..errors import UserError
from ..scene import ownership
from ..scene.selection import output_of_active, scene_of
from .base import OnOutput, Outcome


class OnAnimation(OnOutput):
    """Base of both operators, which work on the animated cages of the active object."""

    @classmethod
    def unsuitable(cls, collection: bpy.types.Collection) -> str:
        if ownership.is_bound(collection):
            return "Unbind the drawing from its cages first: its animation is put aside"
        return "" if bake.is_animated(collection) else "The cages have no animation"


class OBJECT_OT_nested_cages_bake_action(OnAnimation, bpy.types.Operator):
    """Bakes the animation into one action."""

    bl_idname = "object.nested_cages_bake_action"
    bl_label = "Bake to One Action"
    bl_description = "Put the animation of the drawing and all of its cages into one action with a slot for each"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        return super().unavailable(context) if bake.has_slots() else "One action for several objects needs Blender 4.4"

    def execute(self, context: bpy.types.Context) -> Outcome:
        try:
            action = bake.bake(output_of_active(context))
        except UserError as error:
            return self.fail(error)
        self.report({"INFO"}, f"The animation is in the action '{action.name}'")
        return {"FINISHED"}


class OBJECT_OT_nested_cages_remove_animation(OnAnimation, bpy.types.Operator):
    """Removes the animation and keeps the result."""

    bl_idname = "object.nested_cages_remove_animation"
    bl_label = "Remove Animation, Keep Cages"
    bl_description = "Remove the steps, their keyframes and markers, and keep the finished cages"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> Outcome:
        try:
            bake.remove(scene_of(context), output_of_active(context))
        except UserError as error:
            return self.fail(error)
        return {"FINISHED"}


CLASSES = (OBJECT_OT_nested_cages_bake_action, OBJECT_OT_nested_cages_remove_animation)
