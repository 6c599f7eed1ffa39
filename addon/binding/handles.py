"""Handles: one bone, or one empty with a hook, per corner of a cage; each moves its corner alone."""

from __future__ import annotations

from typing import Final

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .. import keys
from ..scene import filling, placement
from ..scene.filling import Points
from ..scene.plane import size
from ..scene.selection import select

BONES: Final = "BONES"
EMPTIES: Final = "EMPTIES"
# Length of a bone and size of an empty as a fraction of the cage's size.
LENGTH = 0.05


def handles_of(cage: bpy.types.Object) -> list[bpy.types.Object]:
    """The armature, or the empties, that move the corners of a cage."""
    return [obj for obj in bpy.data.objects if obj.get(keys.HANDLES_OF) == cage and obj.users_scene]


def add(context: bpy.types.Context, cage: bpy.types.Object, kind: str) -> list[bpy.types.Object]:
    """Adds handles of a kind to a cage in Object Mode, each with full weight on its corner; returns the new objects."""
    corners = filling.points_of(filling.mesh_of(cage))
    outward = _outward(cage)
    made = (_bones if kind == BONES else _empties)(context, cage, corners, outward)
    for obj in made:
        obj[keys.HANDLES_OF] = cage
        obj.show_in_front = True
    return made


def names(cage: bpy.types.Object) -> list[str]:
    """A name for the handle of each corner: the cage's, and the corner's number from 1."""
    count = len(cage.data.vertices)
    return [f"{cage.name} Corner {number:0{len(str(count))}d}" for number in range(1, count + 1)]


def _outward(cage: bpy.types.Object) -> Points:
    """Directions (n, 2) out of the cage at its corners."""
    outline = filling.outline(cage)
    points, after = outline.vertices, np.asarray(outline.successor)
    along = points[after] - points
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    tangent = along / np.linalg.norm(along, axis=1)[:, None]
    tangent = tangent + tangent[before]
    length = np.maximum(np.linalg.norm(tangent, axis=1), np.finfo(np.float32).eps)
    outward: Points = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / length[:, None]
    return outward


def _bones(
    context: bpy.types.Context, cage: bpy.types.Object, corners: Points, outward: Points
) -> list[bpy.types.Object]:
    """An armature with a bone per corner, in a bone collection named after the cage, and its modifier on the cage."""
    armature = bpy.data.armatures.new(f"{cage.name} Handles")
    rig = bpy.data.objects.new(armature.name, armature)
    for collection in cage.users_collection:
        collection.objects.link(rig)
    placement.accompany(rig, cage)
    armature.display_type = "STICK"
    group, length = armature.collections.new(cage.name), LENGTH * size(corners)
    select(context, rig)
    bpy.ops.object.mode_set(mode="EDIT")
    for name, corner, direction in zip(names(cage), corners, outward, strict=True):
        bone = armature.edit_bones.new(name)
        bone.head = Vector(corner)
        bone.tail = bone.head + length * Vector((*direction, 0.0))
        bone.use_deform = True
        group.assign(bone)
    bpy.ops.object.mode_set(mode="OBJECT")
    for index, name in enumerate(names(cage)):
        _weigh(cage, name, index)
    modifier = cage.modifiers.new("Nested Cages Handles", "ARMATURE")
    assert isinstance(modifier, bpy.types.ArmatureModifier)
    modifier.object = rig
    return [rig]


def _empties(
    _context: bpy.types.Context, cage: bpy.types.Object, corners: Points, _outward: Points
) -> list[bpy.types.Object]:
    """An empty per corner, with a Hook modifier of the cage."""
    made = []
    for index, (name, corner) in enumerate(zip(names(cage), corners, strict=True)):
        empty = bpy.data.objects.new(name, None)
        for collection in cage.users_collection:
            collection.objects.link(empty)
        empty.empty_display_type, empty.empty_display_size = "SPHERE", 0.5 * LENGTH * size(corners)
        placement.accompany(empty, cage, Matrix.Translation(corner))
        _weigh(cage, name, index)
        hook = cage.modifiers.new(name, "HOOK")
        assert isinstance(hook, bpy.types.HookModifier)
        hook.object, hook.vertex_group = empty, name
        hook.center = Vector(corner)
        made.append(empty)
    bpy.context.view_layer.update()
    for empty in made:
        hook = cage.modifiers[empty.name]
        assert isinstance(hook, bpy.types.HookModifier)
        hook.matrix_inverse = empty.matrix_world.inverted_safe() @ cage.matrix_world
    return made


def _weigh(cage: bpy.types.Object, name: str, index: int) -> None:
    """A vertex group of one corner."""
    group = cage.vertex_groups.get(name) or cage.vertex_groups.new(name=name)
    group.add([index], 1.0, "REPLACE")
