"""The active object's output, and selection of results."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ..errors import UserError
from . import ownership


def scene_of(context: bpy.types.Context) -> bpy.types.Scene:
    """The scene of a context; operators and panels always have one."""
    assert context.scene is not None
    return context.scene


def scene_again(name: str) -> bpy.types.Scene:
    """The scene of that name after a job. Raises: UserError if it is gone."""
    found = bpy.data.scenes.get(name)
    if found is None:
        raise UserError("The scene of the drawing is gone, so its cages were discarded")
    return found


def check_free(objects: Iterable[bpy.types.Object]) -> None:
    """Raises: UserError if an output object is being edited, or cannot be changed."""
    for obj in objects:
        if obj.mode != "OBJECT":
            raise UserError(f"'{obj.name}' is being edited: go back to Object Mode first")
        if problem := ownership.why_locked(obj):
            raise UserError(problem)


def collection_of_active(context: bpy.types.Context) -> bpy.types.Collection | None:
    """The output that the active object belongs to or is the source of."""
    return next(iter(outputs_of_active(context)), None)


def outputs_of_active(context: bpy.types.Context) -> list[bpy.types.Collection]:
    """The same, and of a drawing with cages around it and inside both."""
    active = context.view_layer.objects.active
    return ownership.outputs_about(scene_of(context), active) if active is not None else []


def chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The active object and all selected ones. An original that its animation hides is active, but not selected."""
    active = context.view_layer.objects.active
    return list(dict.fromkeys((*((active,) if active is not None else ()), *context.selected_objects)))


def outputs_of_chosen(context: bpy.types.Context, *, both: bool = True) -> list[bpy.types.Collection]:
    """The outputs of all these; of a drawing with cages around it and inside `both`, or the former."""
    found = [ownership.outputs_about(scene_of(context), obj) for obj in chosen(context)]
    moved = [obj.type in {"ARMATURE", "EMPTY"} for obj in chosen(context)]
    few = [outputs if both or many else outputs[:1] for outputs, many in zip(found, moved, strict=True)]
    return list(dict.fromkeys(output for outputs in few for output in outputs))


def select(context: bpy.types.Context, *objects: bpy.types.Object) -> None:
    """Makes the objects the only selected ones, and the last of them the active one."""
    for other in context.selected_objects:
        other.select_set(False)
    for obj in objects:
        obj.select_set(True)
    context.view_layer.objects.active = objects[-1]
