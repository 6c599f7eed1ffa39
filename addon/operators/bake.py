"""Bake to One Action, and Remove Animation."""

from __future__ import annotations

import bpy

from ..animation import bake
from ..generation.job import Work
from ..scene import ownership
from ..scene.selection import scene_of
from .base import OutputOperator


class OnAnimation(OutputOperator):
    """Base of both operators, which work on animated cages."""

    @classmethod
    def unsuitable(cls, collection: bpy.types.Collection) -> str:
        if ownership.is_bound(collection):
            return "Unbind the drawing from its cages first: its animation is turned off while bound"
        return "" if bake.is_animated(collection) else "The cages have no animation"


class OBJECT_OT_nested_cages_bake_action(OnAnimation, bpy.types.Operator):
    """Put the animation of the drawing and all of its cages into one action with a slot for each"""

    bl_label = "Bake to One Action"

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        return super().unavailable(context) if bake.has_slots() else "One action for several objects needs Blender 4.4"

    def each(self, _context: bpy.types.Context, collection: bpy.types.Collection) -> Work[None]:
        action = bake.bake(collection)
        self.report({"INFO"}, f"The animation is in the action '{action.name}'")
        yield from ()


class OBJECT_OT_nested_cages_remove_animation(OnAnimation, bpy.types.Operator):
    """Remove the steps, their keyframes and markers, and keep the finished cages"""

    bl_label = "Remove Animation, Keep Cages"

    def each(self, context: bpy.types.Context, collection: bpy.types.Collection) -> Work[None]:
        bake.remove(scene_of(context), collection)
        yield from ()
