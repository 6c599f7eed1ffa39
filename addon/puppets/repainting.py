"""The puppet of a painting that was changed: its armature, its objects and what was painted on them go on."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from bpy.types import Context, Object

from .. import keys
from ..blender import mesh_data
from ..cage_sets import selection
from ..cage_sets.selection import scene_of
from ..core import blamed, game
from ..errors import FloatArray, UserError
from . import armatures, exported, imported

# Weights that differ by less than this from those that were solved were not painted by hand.
BY_HAND = 1e-3


def repaint(context: Context, rig: Object, painting: game.Painting) -> tuple[list[Object], tuple[str, ...]]:
    """Changes a puppet to a painting: its objects, the armature last, and what changed. Raises: UserError."""
    if keys.KEPT not in rig.keys():  # noqa: SIM118
        raise UserError(f"'{rig.name}' is no puppet of a painting: import the painting without 'Repaint Selected'")
    selection.check_local(rig)
    old = _old(rig)
    with blamed(f"'{rig.name}'"):
        puppet, changes = game.repainted(old, painting.parts, painting.size)
    painted = {obj.vertex_groups[member.group].name for obj in exported.parts_of(rig)
               for vertex in mesh_data.mesh_of(obj).vertices for member in vertex.groups
               if member.weight > 0.0}  # fmt: skip
    other = sorted(painted - {bone.name for bone in old.bones})
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    names = {mesh.name for mesh in puppet.meshes}
    gone = [obj for obj in exported.parts_of(rig) if obj[keys.MADE] not in names]
    bpy.data.batch_remove([block for obj in gone for block in (obj, obj.data)])
    home = selection.home_of(scene_of(context), rig)
    told = [f"The weights of '{name}' are gone: it is no bone of the puppet." for name in other]
    keyed = [obj for obj in exported.parts_of(rig) if mesh_data.mesh_of(obj).shape_keys is not None]
    made = imported.stage(context, home, rig, puppet, rig[keys.CANVAS][2])
    redrawn = [obj.name for obj in keyed if mesh_data.mesh_of(obj).shape_keys is None]
    told += [f"The shape keys of '{name}' are gone: its outline is another one." for name in redrawn]
    return made, (*changes.sentences, *puppet.notes, *told)


def _old(rig: Object) -> game.GamePuppet:
    """The puppet as it was made, with the bones as they are in the scene, and with weights painted by hand."""
    kept, scene = game.from_puppet_json(str(rig[keys.KEPT])), exported.as_it_stands(rig)
    chains, head = armatures.chains_of(rig.data.bones), {bone.name: bone.head for bone in scene.bones}
    parts = []
    for part in kept.parts:
        names = [bone.name for bone in chains.get(part.name, ())]
        parts.append(replace(part, bones=names, joint=head[names[0]] if names else part.joint))
    now = {
        was: name
        for old, new in zip(kept.parts, parts, strict=True)
        for was, name in zip(old.bones, new.bones, strict=False)
    }
    column = {bone.name: k for k, bone in enumerate(scene.bones)}
    before, hand = {mesh.name: mesh for mesh in kept.meshes}, dict[str, FloatArray]()
    meshes = [
        replace(mesh, name=str(obj[keys.MADE])) for obj, mesh in zip(exported.parts_of(rig), scene.meshes, strict=True)
    ]
    for mesh in meshes:
        if mesh.name in before:
            old = before[mesh.name]
            solved = game.values_at(old, old.weights - kept.hand.get(mesh.name, 0.0), mesh.points)
            painted = np.array(mesh.weights)
            for bone, values in zip(kept.bones, solved.T, strict=True):
                if now.get(bone.name) in column:
                    painted[:, column[now[bone.name]]] -= values
            if np.abs(painted).max() > BY_HAND:
                hand[mesh.name] = painted
    return replace(scene, name=kept.name, meshes=tuple(meshes), parts=tuple(parts), hand=hand)
