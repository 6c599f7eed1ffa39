"""An armature moves a cage: vertices near the joints, weights computed inside it, and an Armature modifier."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
import numpy as np

from ..animation import bake
from ..animation.timeline import Timing
from ..binding import binding
from ..core import core
from ..errors import UserError
from ..generation import output
from ..generation.generate import Generation, Options, Request, Result
from ..generation.job import Work, completed
from ..scene import filling, ownership, placement
from ..scene.convert import Drawing
from ..scene.plane import Frame
from ..scene.selection import scene_of
from .bones import bones_of
from .drawing import set_of

# Vertices of a cage before those at joints: of its first loop, of each other one, and at most.
FIRST_LOOP, PER_LOOP, MOST = 40, 4, 200
# Clearance as a fraction of the drawing's diagonal: with less, more of a bent drawing leaves the cage; with more, limbs
# that pass each other have cages that meet.
CLEARANCE_SHARE = 0.01
# At most this part of the room between loops and inside holes, whose bound is the largest clearance of any cage.
ROOM_PART = 0.5
# Weights below this are left out.
SMALLEST_WEIGHT = 1e-4


def make(
    context: bpy.types.Context, drawing: Drawing, armature: bpy.types.Object, vertices: int
) -> Work[bpy.types.Collection]:
    """A cage around a drawing, bound, and moved by the bones of an armature. Raises: UserError.

    vertices: of the cage before those at joints, 0 = as many as its loops need. Of earlier cages, what the artist made
    stays.
    """
    bones = bones_of(armature, drawing.frame)
    fine = drawing.mesh()
    count = vertices or min(MOST, FIRST_LOOP + PER_LOOP * (len(fine.loops) - 1))
    room = core.hierarchy.tightest_place(fine)
    share = CLEARANCE_SHARE if room is None else min(CLEARANCE_SHARE, ROOM_PART * room.clearance / fine.diagonal)
    generation = Generation([Request(drawing)], Options(levels=(count,), clearance_share=share))
    yield from generation
    earlier = set_of([obj for each in (drawing, *drawing.others) if (obj := each.source) is not None])
    if earlier is not None and drawing.source is not None and ownership.source_of(earlier) is None:
        ownership.hand_over(earlier, drawing.source)
    scene, results = scene_of(context), [_jointed(result, bones) for result in generation.results]
    (collection,), _ = output.write(scene, results, Timing(show_flow=False))
    binding.forget(collection)
    if bake.is_animated(collection):
        bake.remove(scene, collection)
    context.view_layer.update()
    cage = ownership.members(collection)[-1]
    weigh(cage, armature, drawing.frame)
    completed(binding.bind(context, collection))
    for part in ownership.originals(collection):
        placement.attach(part, armature)
    return collection


def _jointed(result: Result, bones: Sequence[core.Bone]) -> Result:
    """A result whose cage has vertices at the joints, and stands still."""
    (level,) = result.levels
    cage = core.with_joints(level.cage, bones)
    steps = np.broadcast_to(cage.vertices, (len(level.reinflation.cage_steps), *cage.vertices.shape))
    still = replace(level.reinflation, cage_steps=steps)
    return replace(result, levels=(replace(level, coarse=cage, cage=cage, reinflation=still),))


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
