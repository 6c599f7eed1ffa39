"""Add Handles: bones or empties at the corners of a bound cage."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty

from ..binding import handles
from ..errors import UserError, counted
from ..scene import ownership
from ..scene.selection import output_of_active, select
from .base import OnOutput, Outcome

KIND_ITEMS = (
    (handles.BONES, "Bones", "One armature with a bone per corner"),
    (handles.EMPTIES, "Empties", "An empty with a hook per corner"),
)


class OBJECT_OT_nested_cages_add_handles(OnOutput, bpy.types.Operator):
    """Adds handles."""

    bl_idname = "object.nested_cages_add_handles"
    bl_label = "Add Handles"
    bl_description = "Add a bone or an empty per corner of the coarsest cage to move that corner and the drawing"
    bl_options = {"REGISTER", "UNDO"}
    purpose = "move it: select cages around it"

    kind: EnumProperty(name="Handles", description="What moves a corner", items=KIND_ITEMS, default=handles.BONES)

    @classmethod
    def unsuitable(cls, collection: bpy.types.Collection) -> str:
        if not ownership.is_bound(collection):
            return "Bind the drawing to its cages first"
        cage = ownership.members(collection)[-1]
        if handles.handles_of(cage):
            return f"'{cage.name}' has handles already"
        return "" if cage.is_editable else f"'{cage.name}' cannot be changed because it is linked from another file"

    def execute(self, context: bpy.types.Context) -> Outcome:
        cage = ownership.members(output_of_active(context))[-1]
        try:
            made = handles.add(context, cage, self.kind)
        except UserError as error:
            return self.fail(error)
        select(context, *made)
        if self.kind == handles.BONES:
            bpy.ops.object.mode_set(mode="POSE")
        self.report({"INFO"}, f"{counted(len(cage.data.vertices), 'handle')}: move them, and the drawing follows")
        return {"FINISHED"}


CLASSES = (OBJECT_OT_nested_cages_add_handles,)
