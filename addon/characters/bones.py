"""Armatures as the core's bones, in the plane of a drawing, and the other way round."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..core import core
from ..errors import UserError
from ..scene.plane import Frame, transform, world_matrix
from ..scene.selection import select

# Bones seen shorter than this fraction of their length point out of the plane and are left out.
SHORTEST = 1e-3


def bones_of(armature: bpy.types.Object, frame: Frame) -> tuple[core.Bone, ...]:
    """The deforming bones of an armature at rest, seen in a drawing's frame, parents first. Raises: UserError."""
    assert isinstance(armature.data, bpy.types.Armature)
    matrix = world_matrix(armature)
    found: list[core.Bone] = []
    numbers: dict[str, int] = {}
    for bone in armature.data.bones:
        # What Blender poses: children of bones nearly along -Y are beside their head_local, 2.5e-4 of a length at most.
        rest = bone.matrix_local
        ends = np.array([rest.translation, rest @ Vector((0.0, bone.length, 0.0))], dtype=np.float64)
        head, tail = frame.from_world(transform(matrix, ends))[0].tolist()
        seen = float(np.hypot(tail[0] - head[0], tail[1] - head[1])) * frame.scale
        length = float(np.linalg.norm(np.diff(transform(matrix, ends), axis=0)))
        if not bone.use_deform or not seen > SHORTEST * length:
            continue
        above = next((numbers[each.name] for each in bone.parent_recursive if each.name in numbers), None)
        numbers[bone.name] = len(found)
        found.append(core.Bone((head[0], head[1]), (tail[0], tail[1]), above, bone.name))
    if not found:
        raise UserError(f"'{armature.name}' has no bone with 'Deform' that lies in the plane of the drawing")
    return tuple(found)


def add(context: bpy.types.Context, name: str, frame: Frame, bones: Sequence[core.Bone]) -> bpy.types.Object:
    """A new armature in the plane of a drawing, selected and active."""
    armature = bpy.data.armatures.new(name)
    made = bpy.data.objects.new(name, armature)
    context.collection.objects.link(made)
    made.matrix_world = Matrix(frame.matrix.tolist())
    made.show_in_front = True
    select(context, made)
    bpy.ops.object.mode_set(mode="EDIT")
    created: list[bpy.types.EditBone] = []
    for bone in bones:
        new = armature.edit_bones.new(bone.name)
        new.head, new.tail = (*bone.head, frame.height), (*bone.tail, frame.height)
        if bone.parent is not None:
            new.parent = created[bone.parent]
            new.use_connect = bones[bone.parent].tail == bone.head
        created.append(new)
    bpy.ops.object.mode_set(mode="OBJECT")
    return made
