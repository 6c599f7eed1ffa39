"""What the user works with, and what is given back selected."""

from __future__ import annotations

import bpy

from . import ownership


def collection_of_active(context: bpy.types.Context) -> bpy.types.Collection | None:
    """The output that the active object belongs to or is the source of."""
    active = context.view_layer.objects.active
    return ownership.collection_about(context.scene, active) if active is not None else None


class OnOutput:
    """What operators share that work on the output of the active object."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        collection = collection_of_active(context)
        if context.mode != "OBJECT":
            sentence = "Switch to Object Mode"
        elif collection is None:
            sentence = "Select a drawing that has cages, or one of its cages"
        else:
            sentence = cls.obstacle(collection)
        if sentence:
            cls.poll_message_set(sentence)
        return not sentence

    @classmethod
    def obstacle(cls, collection: bpy.types.Collection) -> str:
        """What speaks against working on this output, as a sentence; empty if nothing does."""
        return ""


def select(context: bpy.types.Context, *objects: bpy.types.Object) -> None:
    """Makes the objects the only selected ones, and the last of them the active one."""
    for other in context.selected_objects:
        other.select_set(False)
    for obj in objects:
        obj.select_set(True)
    context.view_layer.objects.active = objects[-1]
