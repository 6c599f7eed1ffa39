"""Bake the animation into one action, or remove it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from .. import record
from ..errors import UserError
from ..scene import ownership
from . import shape_keys, stage, timeline, visibility


def is_animated(collection: bpy.types.Collection) -> bool:
    """Whether the steps of an output collection play."""
    return any(isinstance(owner, bpy.types.Key) for owner, _ in _owners(collection))


def has_slots() -> bool:
    """Whether one action can animate several data-blocks in this Blender."""
    return "slots" in bpy.types.Action.bl_rna.properties


def bake(collection: bpy.types.Collection) -> bpy.types.Action:
    """Moves the animation of all levels into one action with a slot for each data-block. Raises: UserError.

    Every keyframe stays as it is. Blender has such actions since version 4.4.
    """
    _check(collection)
    if not has_slots():
        raise UserError("One action for several objects needs Blender 4.4 or later")
    owners = list(_owners(collection))
    for owner, name in owners:
        if any(len(curve.modifiers) for curve in shape_keys.curves_of(owner)):
            raise UserError(f"The F-curves of '{name}' have modifiers, which stay with their action")
    whole = bpy.data.actions.new(collection.name)
    for owner, name in owners:
        data, curves = owner.animation_data, list(shape_keys.curves_of(owner))
        old = data.action
        slot = whole.slots.new(owner.id_type, name)
        data.action = whole
        data.action_slot = slot
        for curve in curves:
            made = whole.fcurve_ensure_for_datablock(owner, curve.data_path, index=curve.array_index)
            shape_keys.copy_keyframes(curve, made)
        if old.users == 0:
            bpy.data.actions.remove(old)
    return whole


def remove(scene: bpy.types.Scene, collection: bpy.types.Collection) -> None:
    """Removes the steps, their keyframes and markers; the fine mesh, the cages, other keys and animation stay.

    Raises: UserError.
    """
    _check(collection)
    stage.leave(collection)
    timeline.restore_scene(scene, collection)
    for obj in ownership.members(collection):
        shape_keys.remove_steps(obj)
        if obj.animation_data is not None and obj.animation_data.action is not None:
            visibility.always_show(obj)
        obj.hide_viewport = obj.hide_render = False
        forget_times(obj)
    record.written(collection).moving = False
    record.keep(collection)


def forget_times(obj: bpy.types.Object) -> None:
    """Removes what an object says about its animation."""
    record.described(obj).property_unset("phases")
    record.described(obj).property_unset("frames")


def _owners(collection: bpy.types.Collection) -> Iterator[tuple[Any, str]]:
    """The animated data-blocks of all levels, with a name for each slot."""
    for obj in ownership.members(collection):
        keys = obj.data.shape_keys if obj.type == "MESH" else None
        for owner, name in ((obj, obj.name), (keys, f"{obj.name} Steps")):
            if owner is not None and owner.animation_data is not None and owner.animation_data.action is not None:
                yield owner, name


def _check(collection: bpy.types.Collection) -> None:
    """Raises: UserError."""
    if ownership.is_bound(collection):
        raise UserError(f"'{collection.name}' is bound to its cages, which turns off the animation: unbind it first")
    for obj in ownership.members(collection):
        if obj.mode != "OBJECT":
            raise UserError(f"'{obj.name}' is being edited: go back to Object Mode first")
        if not obj.is_editable or not obj.data.is_editable:
            raise UserError(f"'{obj.name}' cannot be changed because it is linked from another file")
    if not is_animated(collection):
        raise UserError(f"'{collection.name}' has no animation")
