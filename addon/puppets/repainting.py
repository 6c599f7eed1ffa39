"""The puppet of a painting that was changed: made again with what was chosen in its armature, by names of layers."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.types import Context, Object

from .. import keys
from ..blender import mesh_data
from ..cage_sets import selection
from ..cage_sets.selection import scene_of
from ..core import blamed, core
from ..errors import FloatArray, UserError
from . import armatures, exported, imported, weights


def repaint(
    context: Context, rig: Object, painting: core.puppets.Painting, *, replace_weights: bool
) -> tuple[list[Object], tuple[str, ...]]:
    """Changes a puppet to a painting: its objects, the armature last, and what to look at. Raises: UserError.

    replace_weights: whether weights that were painted by hand may be replaced.
    """
    if keys.CANVAS not in rig.keys():  # noqa: SIM118
        raise UserError(f"'{rig.name}' is no puppet of a painting: import the painting without 'Repaint Selected'")
    selection.check_local(rig)
    drawn = exported.parts_of(rig)
    painted = ", ".join(f"'{obj.name}'" for obj in drawn if weights.were_painted(obj))
    if painted and not replace_weights:
        raise UserError(f"Weights of {painted} were painted by hand: tick 'Replace Painted Weights' to solve them anew")
    unit = rig[keys.CANVAS][2]
    place = core.puppets.Placement(*painting.size)

    def in_pixels(ends: FloatArray) -> FloatArray:
        return np.asarray(ends[:, :2] / unit)

    with blamed(f"'{rig.name}'"):
        parts = core.puppets.puppet_parts_of(painting.parts, place)
        choices = armatures.choices_in(rig, parts, {str(obj[keys.MADE]): obj for obj in drawn}, in_pixels)
        puppet = core.puppets.game_puppet(painting.parts, painting.size, name=rig.data.name, choices=choices)
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    names = {mesh.name for mesh in puppet.meshes}
    gone = [obj for obj in drawn if obj[keys.MADE] not in names]
    kept = [obj for obj in drawn if obj not in gone]
    bpy.data.batch_remove([block for obj in gone for block in (obj, obj.data)])
    keyed = [obj for obj in kept if mesh_data.mesh_of(obj).shape_keys is not None]
    made = imported.stage(context, selection.home_of(scene_of(context), rig), rig, puppet, unit)
    redrawn = [obj.name for obj in keyed if mesh_data.mesh_of(obj).shape_keys is None]
    told = [f"The shape keys of '{name}' are gone: its outline is another one." for name in redrawn]
    return made, (*puppet.notes, *told)
