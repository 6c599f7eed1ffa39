"""Adopt: copied, appended or instanced drawings and their cages become sets of their own."""

from __future__ import annotations

import bpy

from ..binding.adoption import adopt, waiting
from ..errors import counted
from ..scene.selection import chosen, scene_of
from .base import Outcome, Reporting


class OBJECT_OT_nested_cages_adopt(Reporting, bpy.types.Operator):
    """Makes copies their own."""

    bl_idname = "object.nested_cages_adopt"
    bl_label = "Adopt Cages"
    bl_description = (
        "Give copied, appended or instanced cages, or cages without their collection, to the selected drawing as its "
        "own. All other operators do so too"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        if waiting(chosen(context)):
            return ""
        return "Select a drawing whose cages were copied with it, or have lost their collection"

    def execute(self, context: bpy.types.Context) -> Outcome:
        made = adopt(scene_of(context), chosen(context))
        self.report({"INFO"}, f"{counted(len(made), 'set')} of cages adopted")
        return {"FINISHED"}


CLASSES = (OBJECT_OT_nested_cages_adopt,)
