"""A rigged drawing for game engines: bones, cage, triangles and weights at rest, as JSON."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..core import blamed, core, triangulation
from ..errors import UserError
from ..generation.checking import same_frame
from ..scene import filling, ownership
from ..scene.plane import Frame, scale_of, world_matrix
from ..scene.selection import scene_of
from .rig import bones_of


def json_of(context: bpy.types.Context, collection: bpy.types.Collection, *, flip_y: bool, frames: bool) -> str:
    """The JSON of a rigged drawing, with all frames of the scene on request. Raises: UserError."""
    fine, cage = ownership.members(collection)[0], ownership.members(collection)[-1]
    armature = next((each.object for each in cage.modifiers if isinstance(each, bpy.types.ArmatureModifier)), None)
    if armature is None:
        raise UserError(f"'{cage.name}' follows no armature: press Rig with Armature first")
    height = float(filling.points_of(filling.mesh_of(cage))[0, 2])
    bones = bones_of(armature, Frame(world_matrix(cage), height, scale_of(cage), own=True))
    painted = np.nan_to_num(filling.weights_of(filling.mesh_of(cage), len(cage.vertex_groups)))
    weights = np.zeros((len(cage.data.vertices), len(bones)))
    for column, bone in zip(weights.T, bones, strict=True):
        if bone.name in cage.vertex_groups:
            column[:] = painted[cage.vertex_groups[bone.name].index]
    lost = np.flatnonzero(weights.sum(axis=1) <= 0.0)
    if len(lost):
        raise UserError(f"Vertex {lost[0]} of '{cage.name}' follows no bone of '{armature.name}': paint weights there")
    shape, around = filling.outline(fine), filling.outline(cage)
    with blamed(f"'{fine.name}'"):
        found = core.cage_coordinates(shape, around)
    triangles = triangulation.triangulate(shape).triangles
    weights /= weights.sum(axis=1, keepdims=True)
    poses = tuple(_poses(context, fine, cage)) if frames else ()
    character = core.character.Character(shape, around, bones, weights, found, triangles, poses)
    text: str = core.exchange.character_to_engine_json(character, flip_y=0.0 if flip_y else None)
    return text


def _poses(context: bpy.types.Context, fine: bpy.types.Object, cage: bpy.types.Object) -> Iterator[core.character.Pose]:
    """Drawing and cage on each frame of the scene, in the plane of the cage at rest."""
    scene = scene_of(context)
    seconds = scene.render.fps_base / scene.render.fps
    with same_frame(scene):
        for frame in range(scene.frame_start, scene.frame_end + 1):
            scene.frame_set(frame)
            depsgraph = context.evaluated_depsgraph_get()
            shape, around = (filling.points_of(filling.mesh_of(obj.evaluated_get(depsgraph))) for obj in (fine, cage))
            yield core.character.Pose((frame - scene.frame_start) * seconds, shape[:, :2], around[:, :2])
