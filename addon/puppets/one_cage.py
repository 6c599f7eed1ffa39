"""Characters: drawings as one outline with edges short enough to bend, armatures as bones of the core and back, and a
cage that an armature moves: vertices near the joints, weights computed inside it, and a modifier.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from bpy.types import Collection, Context, Object
from mathutils import Matrix, Vector

from ..animation.timeline import Timing
from ..bind import bind, field
from ..blender import mesh_data
from ..blender.jobs import Work
from ..cage_sets import CageSet
from ..cage_sets.selection import scene_of, select
from ..core import blamed, certify, core
from ..drawing import placement
from ..drawing.planar import Drawing
from ..drawing.plane import Frame, divided, float32_loop, size, transform, united_loops, world_matrix
from ..errors import FloatArray, UserError
from ..files import silhouettes
from ..generate.options import Options
from ..generate.run import STORED, Generation, Request, Result
from ..generate.write import write

# Longest edge of the outline as a fraction of its size: straight limbs bend, and few corners don't limit the cage.
LONGEST_EDGE = 0.01
# Bones seen shorter than this fraction of their length point out of the plane and are left out.
SHORTEST = 1e-3
# Vertices of a cage before those at joints: of its first loop, of each other one, and at most.
FIRST_LOOP, PER_LOOP, MOST = 40, 4, 200
# Clearance as a fraction of the drawing's diagonal: with less, more of a bent drawing leaves the cage; with more, limbs
# that pass each other have cages that meet.
CLEARANCE_SHARE = 0.01
# At most this part of the room between loops and inside holes, whose bound is the largest clearance of any cage.
ROOM_PART = 0.5
# Weights below this are left out.
SMALLEST_WEIGHT = 1e-4


def united_drawing(context: Context, objects: Sequence[Object], gap: float) -> Work[tuple[Drawing, list[UserError]]]:
    """All that objects paint as one drawing of the one that their cage is named after, or else of the largest, and why
    some were left out. Raises: UserError.

    gap: parts closer than this length of the scene are joined.
    """
    first = max(sorted(objects, key=lambda obj: obj.name), key=lambda obj: float(obj.dimensions.length))
    earlier = set_of(objects)
    if earlier is not None and earlier.source in objects:
        first = next(obj for obj in objects if obj == earlier.source)
    ordered = [first, *(obj for obj in objects if obj != first)]
    frame = silhouettes.plane_of(context, first)
    loops, problems = yield from silhouettes.painted_loops(context, ordered, frame, gap=gap, closed=True)
    longest = LONGEST_EDGE * size(np.concatenate(loops))
    # United again where rounding has closed a gap between new points.
    shorter = united_loops(first.name, [float32_loop(divided(loop, longest)) for loop in loops], evenodd=True)
    others = tuple(Drawing(obj.name, frame, (), obj.session_uid) for obj in ordered[1:])
    return Drawing(first.name, frame, shorter, first.session_uid, others, united=True), problems


def set_of(objects: Sequence[Object]) -> CageSet | None:
    """The set that the most of some objects follow."""
    cages = [field.followed(obj) for obj in objects]
    sets = [CageSet.of(cage) for cage in cages if cage is not None]
    common = Counter(each for each in sets if each is not None).most_common(1)
    return common[0][0] if common else None


def bones_of(armature: Object, frame: Frame) -> tuple[core.Bone, ...]:
    """The deforming bones of an armature at rest, seen in a drawing's frame, parents first. Raises: UserError."""
    matrix = world_matrix(armature)
    bones: list[core.Bone] = []
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
        numbers[bone.name] = len(bones)
        bones.append(core.Bone((head[0], head[1]), (tail[0], tail[1]), above, bone.name))
    if not bones:
        raise UserError(f"'{armature.name}' has no bone with 'Deform' that lies in the plane of the drawing")
    return tuple(bones)


def add_bones(
    context: Context, home: Collection | None, frame: Frame, bones: Sequence[core.Bone], *, name: str
) -> Object:
    """A new armature in the plane of a drawing, in a collection or that of the context; selected and active."""
    armature = bpy.data.armatures.new(name)
    made = bpy.data.objects.new(name, armature)
    (home or context.collection).objects.link(made)
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


def add_skeleton(context: Context, drawing: Drawing) -> tuple[Object, int]:
    """A new armature along the limbs of a drawing, and the number of its bones. Raises: UserError."""
    bones = core.suggest_bones(drawing.mesh())
    if not bones:
        raise UserError(f"'{drawing.name}' has no limbs: it is round; draw a bone yourself")
    made = add_bones(context, None, drawing.frame, bones, name=f"{drawing.name} Bones")
    return made, len(bones)


def make(context: Context, drawing: Drawing, armature: Object, vertices: int) -> Work[CageSet]:
    """A cage around a drawing, bound, and moved by the bones of an armature. Raises: UserError.

    vertices: of the cage before those at joints, 0 = as many as its loops need. Of earlier cages, what the artist made
    stays.
    """
    bones = bones_of(armature, drawing.frame)
    fine = drawing.mesh()
    count = vertices or min(MOST, FIRST_LOOP + PER_LOOP * (len(fine.loops) - 1))
    room = core.levels.tightest_place(fine)
    share = CLEARANCE_SHARE if room is None else min(CLEARANCE_SHARE, ROOM_PART * room.clearance / fine.diagonal)
    generation = Generation([Request(drawing)], Options(levels=(count,), clearance_share=share))
    yield from generation
    scene, results = scene_of(context), [_jointed(result, bones) for result in generation.results]
    (cage_set,) = write(scene, results, Timing(show_flow=False), still=True, bound=False)
    context.view_layer.update()
    cage = cage_set.cages[-1]
    _weigh(cage, armature, bones)
    bind.bind(context, cage_set)
    for part in cage_set.originals:
        placement.attach(part, armature)
    return cage_set


def _jointed(result: Result, bones: Sequence[core.Bone]) -> Result:
    """A result whose cage has vertices at the joints, and stands still. Raises: UserError."""
    (level,) = result.levels
    with blamed(f"'{result.drawing.name}'"):
        cage = core.with_joints(level.cage, bones)
        cage = cage.moved(cage.vertices.astype(STORED).astype(np.float64))
        # vertices on edges are rounded, and so is what they keep of the clearance
        wanted = min(level.report.wanted_clearance, core.verify(cage, level.fine).clearance)
        return replace(result, levels=(certify.standing(level.fine, cage, level.report, wanted),))


def _weigh(cage: Object, armature: Object, bones: Sequence[core.Bone]) -> None:
    """Lets bones in its plane move a cage. Raises: UserError."""
    with blamed(f"'{cage.name}'"):
        weights = core.bone_weights(mesh_data.shape_of(cage), bones)
    skin(cage, armature, bones, np.where(weights > SMALLEST_WEIGHT, weights, 0.0))


def skin(
    obj: Object, armature: Object, bones: Sequence[core.Bone], weights: FloatArray, *, keeps_volume: bool = True
) -> None:
    """Gives a mesh the weights (n, B) of bones, in place of earlier ones, and a modifier of the armature."""
    for bone, column in zip(bones, weights.T, strict=True):
        group, moved = obj.vertex_groups.get(bone.name), np.flatnonzero(column).tolist()
        if group is not None:
            group.remove(range(len(column)))
        elif moved:
            group = obj.vertex_groups.new(name=bone.name)
        for vertex in moved:
            group.add([vertex], float(column[vertex]), "REPLACE")
    known = [each for each in obj.modifiers if isinstance(each, bpy.types.ArmatureModifier)]
    if all(each.object != armature for each in known):
        modifier: Any = obj.modifiers.new("Armature", "ARMATURE")
        modifier.object, modifier.use_deform_preserve_volume = armature, keeps_volume
        obj.modifiers.move(len(obj.modifiers) - 1, 0)
