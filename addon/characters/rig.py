"""An armature moves a cage: vertices near the joints, weights computed inside it, and an Armature modifier."""

from __future__ import annotations

import bpy
import numpy as np

from ..animation import bake
from ..animation.timeline import Timing
from ..binding import binding
from ..core import core
from ..errors import UserError
from ..generation import output
from ..generation.generate import Generation, Options, Request
from ..generation.job import Work, completed
from ..generation.rules import Places
from ..scene import filling, ownership
from ..scene.convert import Drawing
from ..scene.plane import Frame
from ..scene.selection import scene_of
from .bones import bones_of

# Least vertices of a cage without joints, and of each loop after the first, and vertices for each place near a joint.
LEAST, PER_LOOP, PER_PLACE = 32, 4, 2
# Most vertices of a cage that were not asked for.
MOST = 200
# Clearance as a fraction of the drawing's diagonal: with it, of 0.75 %, 1 %, 1.25 % and 1.5 %, the fewest bent cages
# cross themselves.
CLEARANCE_SHARE = 0.01
# Weights below this are left out.
SMALLEST_WEIGHT = 1e-4


def make(
    context: bpy.types.Context, drawing: Drawing, armature: bpy.types.Object, vertices: int
) -> Work[bpy.types.Collection]:
    """A cage around a drawing, bound, and moved by the bones of an armature. Raises: UserError.

    vertices: of the cage, 0 = as many as its loops and joints need. Of earlier cages, what the artist made stays.
    """
    bones, mesh = bones_of(armature, drawing.frame), drawing.mesh()
    joints = core.joints_of(mesh, bones)
    count = vertices or min(MOST, LEAST + PER_LOOP * (len(mesh.loops) - 1) + PER_PLACE * len(joints))
    request = Request(drawing, places=Places(joints=tuple(joints)))
    generation = Generation([request], Options(levels=(count,), clearance_share=CLEARANCE_SHARE))
    yield from generation
    scene = scene_of(context)
    (collection,), _ = output.write(scene, generation.results, Timing(show_flow=False))
    binding.forget(collection)
    if bake.is_animated(collection):
        bake.remove(scene, collection)
    context.view_layer.update()
    cage = ownership.members(collection)[-1]
    weigh(cage, armature, drawing.frame)
    completed(binding.bind(context, collection))
    return collection


def weigh(cage: bpy.types.Object, armature: bpy.types.Object, frame: Frame) -> None:
    """Gives a cage the weights of the bones of an armature, in place of earlier ones, and the modifier.

    frame: the plane of the cage, in which its own points are. Raises: UserError.
    """
    bones = bones_of(armature, frame)
    try:
        weights = core.bone_weights(filling.outline(cage), bones)
    except core.NestedCagesError as error:
        raise UserError(f"'{cage.name}': {error}") from error
    for bone, column in zip(bones, weights.T, strict=True):
        group = cage.vertex_groups.get(bone.name) or cage.vertex_groups.new(name=bone.name)
        group.remove(range(len(column)))
        for vertex in np.flatnonzero(column > SMALLEST_WEIGHT).tolist():
            group.add([vertex], float(column[vertex]), "REPLACE")
    known = [each for each in cage.modifiers if isinstance(each, bpy.types.ArmatureModifier)]
    if all(each.object != armature for each in known):
        modifier = cage.modifiers.new("Armature", "ARMATURE")
        assert isinstance(modifier, bpy.types.ArmatureModifier)
        modifier.object, modifier.use_deform_preserve_volume = armature, True
        cage.modifiers.move(len(cage.modifiers) - 1, 0)
