"""Add Handles: bones or empties at the corners of a bound cage."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..binding import handles
from ..errors import counted
from ..generation.job import Work
from ..properties.kinds import choice
from ..scene import filling, ownership
from ..scene.selection import select
from .base import OutputOperator

KIND_ITEMS = (
    (handles.BONES, "Bones", "One armature with a bone per corner"),
    (handles.EMPTIES, "Empties", "An empty with a hook per corner"),
)


class OBJECT_OT_nested_cages_add_handles(OutputOperator, bpy.types.Operator):
    """Add a bone or an empty per corner of the coarsest cage to move that corner and the drawing"""

    bl_label = "Add Handles"
    purpose = "move it: select cages around it"

    kind: choice("Handles", "What moves a corner", KIND_ITEMS, default=handles.BONES)

    @classmethod
    def unsuitable(cls, collection: bpy.types.Collection) -> str:
        if not ownership.is_bound(collection):
            return "Bind the drawing to its cages first"
        cage = ownership.members(collection)[-1]
        if handles.handles_of(cage):
            return f"'{cage.name}' has handles already"
        return "" if cage.is_editable else f"'{cage.name}' cannot be changed because it is linked from another file"

    def each(self, _context: bpy.types.Context, collection: bpy.types.Collection) -> Work[bpy.types.Object]:
        yield from ()
        return ownership.members(collection)[-1]

    def finish(self, context: bpy.types.Context, done: Sequence[tuple[bpy.types.Collection, bpy.types.Object]]) -> None:
        cages = [cage for _, cage in done]
        select(context, *handles.add(context, cages, self.kind))
        if self.kind == handles.BONES:
            bpy.ops.object.mode_set(mode="POSE")
        number = sum(len(filling.points_of(filling.mesh_of(cage))) for cage in cages)
        self.report({"INFO"}, f"{counted(number, 'handle')}: move them, and the drawing follows")
