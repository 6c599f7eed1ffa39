"""Handles: one bone per corner of a cage, which moves that corner alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Vector

from .. import cage_sets
from ..blender import mesh_data
from ..cage_sets.selection import select
from ..drawing import placement
from ..drawing.plane import size
from ..errors import FloatArray

# Length of a bone as a fraction of the cage's size.
LENGTH = 0.05


def handles_of(cage: Object) -> list[Object]:
    """The armatures that move the corners of a cage one by one."""
    moving = {getattr(modifier, "object", None) for modifier in cage.modifiers}
    return [
        obj for obj in moving if obj is not None and cage_sets.is_helper(obj, cage_sets.HANDLES) and obj.users_scene
    ]


def names(cage: Object) -> list[str]:
    """A name for the handle of each corner: the cage's, and the corner's number from 1."""
    count = len(cage.data.vertices)
    return [f"{cage.name} Corner {number:0{len(str(count))}d}" for number in range(1, count + 1)]


def _outward(cage: Object) -> FloatArray:
    """Directions (n, 2) out of the cage at its corners."""
    outline = mesh_data.shape_of(cage)
    along = outline.edge_ends - outline.vertices
    tangent = along / np.linalg.norm(along, axis=1)[:, None]
    tangent = tangent + tangent[outline.predecessor]
    length = np.maximum(np.linalg.norm(tangent, axis=1), np.finfo(np.float32).eps)
    return np.column_stack([tangent[:, 1], -tangent[:, 0]]) / length[:, None]


def add(context: Context, cages: Sequence[Object]) -> Object:
    """Adds an armature with a bone per corner, in a bone collection for each cage, and its modifier to the cages."""
    name = f"{cages[0].name} Handles" if len(cages) == 1 else f"Handles of {len(cages)} Drawings"
    armature = bpy.data.armatures.new(name)
    rig = bpy.data.objects.new(armature.name, armature)
    cage_sets.make_helper(rig, cage_sets.HANDLES, cages[0])
    rig.show_in_front = True
    for collection in cages[0].users_collection:
        collection.objects.link(rig)
    if len(cages) == 1:
        placement.accompany(rig, cages[0])
    else:
        rig.matrix_world = cages[0].matrix_world
    armature.display_type = "STICK"
    context.view_layer.update()
    select(context, rig)
    bpy.ops.object.mode_set(mode="EDIT")
    for cage in cages:
        corners, group = mesh_data.points_of(mesh_data.mesh_of(cage)), armature.collections.new(cage.name)
        there, length = rig.matrix_world.inverted_safe() @ cage.matrix_world, LENGTH * size(corners)
        for name, corner, direction in zip(names(cage), corners, _outward(cage), strict=True):
            bone = armature.edit_bones.new(name)
            bone.head = there @ Vector(corner)
            bone.tail = there @ (Vector(corner) + length * Vector((*direction, 0.0)))
            bone.use_deform = True
            group.assign(bone)
    bpy.ops.object.mode_set(mode="OBJECT")
    for cage in cages:
        for index, name in enumerate(names(cage)):
            weights = cage.vertex_groups.get(name) or cage.vertex_groups.new(name=name)
            weights.add([index], 1.0, "REPLACE")
        modifier: Any = cage.modifiers.new("Nested Cages Handles", "ARMATURE")
        modifier.object = rig
    return rig
