"""Bake to One Action, and Remove Animation."""

from __future__ import annotations

import bpy

from ..animation import bake
from ..errors import UserError
from ..scene import ownership
from ..scene.selection import OnOutput, collection_of_active


class OnAnimation(OnOutput):
    """What both operators share: they work on the animated cages of the active object."""

    @classmethod
    def obstacle(cls, collection: bpy.types.Collection) -> str:
        if ownership.is_bound(collection):
            return "Unbind the drawing from its cages first: its animation is put aside"
        return "" if bake.is_animated(collection) else "The cages have no animation"


class OBJECT_OT_nested_cages_bake_action(OnAnimation, bpy.types.Operator):
    """Makes one action of many."""

    bl_idname = "object.nested_cages_bake_action"
    bl_label = "Bake to One Action"
    bl_description = "Put the animation of the drawing and of all of its cages into one action, each with its own slot"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not bake.has_slots():
            cls.poll_message_set("One action for several objects needs Blender 4.4 or later")
            return False
        return super().poll(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            action = bake.bake(collection_of_active(context))
        except UserError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"The animation is in the action '{action.name}'")
        return {"FINISHED"}


class OBJECT_OT_nested_cages_remove_animation(OnAnimation, bpy.types.Operator):
    """Leaves the result alone."""

    bl_idname = "object.nested_cages_remove_animation"
    bl_label = "Remove Animation, Keep Cages"
    bl_description = "Take away the steps, their keyframes and their markers; the finished cages stay"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            bake.remove(context.scene, collection_of_active(context))
        except UserError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (OBJECT_OT_nested_cages_bake_action, OBJECT_OT_nested_cages_remove_animation)
