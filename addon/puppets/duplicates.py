"""Copies of puppets: Blender copies no hidden meshes with them, so a copy gets its own as soon as it is there."""

from __future__ import annotations

import bpy
from bpy.types import Object

from .. import cage_sets
from ..bind import copies, field
from ..blender import display
from .armatures import drawings_of, is_puppet, part_of


def complete_puppets() -> None:
    """Gives copies of puppets hidden meshes of their own."""
    for armature in [obj for obj in bpy.data.objects if obj.type == "ARMATURE" and obj.is_editable]:
        if not is_puppet(armature) or armature.override_library is not None:
            continue
        own: dict[Object, Object] = {}
        for obj in _sharing(armature):
            carrier = field.followed(obj)
            assert carrier is not None
            if carrier not in own:
                own[carrier] = _own_carrier(carrier, armature, obj)
            modifier = display.nodes_modifier(field.shown_by(obj), field.FOLLOW)
            assert modifier is not None
            for name, value in (
                ("Cage", own[carrier]),
                ("Field", field.field_of(own[carrier])),
                ("Space", own[carrier]),
            ):
                display.set_input(modifier, name, value)
            field.shown_by(obj).update_tag()


def _sharing(armature: Object) -> list[Object]:
    """The drawings of a puppet that follow a hidden mesh of another one."""
    followed = [(obj, field.followed(obj)) for obj in drawings_of(armature) if obj.is_editable]
    return [obj for obj, mesh in followed if mesh is not None and part_of(mesh) and mesh.parent != armature]


def _own_carrier(carrier: Object, armature: Object, beside: Object) -> Object:
    """A copy of a hidden mesh and of its field, for a copy of its armature."""
    still = field.field_of(carrier)
    assert still is not None
    own, own_still = (copies.own_copy(each, beside) for each in (carrier, still))
    own.parent = own_still.parent = armature
    cage_sets.drop(cage_sets.new_node(own).helpers, [still])
    cage_sets.make_helper(own_still, cage_sets.FIELD, own)
    for modifier in own.modifiers:
        if isinstance(modifier, bpy.types.ArmatureModifier):
            modifier.object = armature
    field.pose(own, own)
    return own


def look_at(armature: Object) -> None:
    """Gives an armature that was updated hidden meshes of its own, when Blender has drawn, if it is a copy."""
    if is_puppet(armature) and _sharing(armature) and not bpy.app.timers.is_registered(complete_puppets):
        bpy.app.timers.register(complete_puppets)


def stop() -> None:
    """Leaves copies as they are."""
    if bpy.app.timers.is_registered(complete_puppets):
        bpy.app.timers.unregister(complete_puppets)
