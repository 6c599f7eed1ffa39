"""The part of the sidebar about characters: bones, the rig, and parts that are added later."""

from __future__ import annotations

import bpy

from ..binding import binding
from ..scene import ownership
from ..scene.selection import collection_of_active


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The buttons in the order of the work, and which parts a bound cage can take along."""
    column = layout.column(align=True)
    column.operator("object.nested_cages_suggest_bones", icon="GROUP_BONE")
    column.operator("object.nested_cages_rig", icon="ARMATURE_DATA")
    collection = collection_of_active(context)
    if collection is not None and ownership.is_bound(collection) and binding.newcomers(context, collection):
        layout.operator("object.nested_cages_bind", text="Bind New Parts", icon="LINKED")
