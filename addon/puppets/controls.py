"""Controls of a puppet: a bone at the root that moves all of it, and bones that its legs and arms reach for, by
constraints that plain Blender solves, within the ranges of the bones.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Any

import bpy
from bpy.types import Object
from mathutils import Matrix, Vector

from .. import keys
from ..blender.shape_keys import curves_of
from ..cage_sets.selection import select
from ..core import core
from .armatures import part_of

# Name of the control at the root; of the constraints, and of what is added to a bone's name for its control.
ROOT, REACH = "Root", "IK"
# Bone collection and colour of all controls.
CONTROLS, COLOUR = "Controls", "THEME09"
# Length of the control at the root in heights of the puppet, and of others in lengths of the last bone that reaches.
ROOT_LENGTH, LENGTH = 0.1, 0.5
# Least number of bones that reach.
LEAST = 2


def add_controls(context: bpy.types.Context, armature: Object, figure: core.puppets.Figure, reach: float) -> None:
    """Adds the controls to the armature of a puppet, or puts them where they belong now.

    reach: how much limbs follow new controls, from 0 to 1.
    """
    chains = _reaching(armature, figure)
    for posed in armature.pose.bones:
        if reach_of(posed) is not None and posed.name not in {chain[-1] for chain in chains}:
            posed.constraints.remove(reach_of(posed))
    select(context, armature)
    bpy.ops.object.mode_set(mode="EDIT")
    bones: Any = armature.data.edit_bones
    known = {str(bone[keys.CONTROL]): bone for bone in bones if keys.CONTROL in bone}
    ends = [end for bone in figure.bones for end in (bone.head[1], bone.tail[1])]
    (trunk, *_), *_ = figure.limbs.trunks
    low, body = min(ends), bones[trunk]
    height = max(max(ends) - low, body.length)  # bones may all lie flat
    root = known.pop(ROOT, None) or bones.new(ROOT)
    _set_control(root, ROOT, Vector((body.head.x, low, body.head.z)), Vector((0.0, ROOT_LENGTH * height, 0.0)))
    for bone in bones:
        if bone.parent is None and part_of(bone):
            bone.parent = root
    targets = {}
    for chain in chains:
        last = bones[chain[-1]]
        there, old = part_of(last), known.pop(part_of(last), None)
        control = old or bones.new(_control_name(last.name))
        _set_control(control, there, last.tail, LENGTH * (last.tail - last.head))
        control.parent = control.parent if old else root
        targets[chain] = control.name
    for gone in known.values():
        bones.remove(gone)
    controls = [bone.name for bone in bones if keys.CONTROL in bone]
    bpy.ops.object.mode_set(mode="OBJECT")
    shown = armature.data.collections.get(CONTROLS) or armature.data.collections.new(CONTROLS)
    for name in controls:
        bone, posed = armature.data.bones[name], armature.pose.bones[name]
        if not bone.collections:
            shown.assign(bone)
            bone.color.palette, posed.rotation_mode = COLOUR, "XYZ"
    for chain, target in targets.items():
        _reach(armature, chain, target, reach)


def reach_of(posed: Any) -> Any:
    """The constraint by which a bone reaches for its control; None without one."""
    return posed.constraints.get(REACH)


def limbs_of(armature: Object) -> dict[str, list[Any]]:
    """The bones of each limb that reaches, from its end to its joint, by name of its control."""
    found = ((posed, reach_of(posed)) for posed in armature.pose.bones)
    return {to.subtarget: [end, *end.parent_recursive[: to.chain_count - 1]] for end, to in found if to is not None}


def snap(armature: Object, control: str, keyed: bool) -> None:
    """Lets a limb that turns by its bones follow its control, else turn by its bones, in the pose that it shows.

    keyed: whether to key what changes; what has keys is keyed anyway.
    """
    chain, target = limbs_of(armature)[control], armature.pose.bones[control]
    reaches = reach_of(chain[0])
    shown = [armature.convert_space(pose_bone=posed, matrix=posed.matrix, from_space="POSE", to_space="LOCAL")
             for posed in chain]  # fmt: skip
    target.matrix = Matrix.Translation(chain[0].tail - target.head) @ target.matrix
    for posed, local in zip(chain, shown, strict=True):  # IK starts from them too
        posed.matrix_basis = local
    reaches.influence = float(reaches.influence == 0.0)
    known = {curve.data_path for curve in curves_of(armature)}
    for owner, path in ((target, "location"), (reaches, "influence"), *((posed, _turn_of(posed)) for posed in chain)):
        if keyed or f"{owner.path_from_id()}.{path}" in known:
            owner.keyframe_insert(path)


def _turn_of(posed: Any) -> str:
    """The property by which a bone is turned."""
    own = {"QUATERNION": "rotation_quaternion", "AXIS_ANGLE": "rotation_axis_angle"}
    return own.get(posed.rotation_mode, "rotation_euler")


def _set_control(control: Any, purpose: str, head: Vector, along: Vector) -> None:
    """Puts a control into its place; it moves no vertices."""
    control.head, control.tail = head, head + along
    control.use_deform = False
    control[keys.CONTROL], control[keys.PART] = purpose, ""


def _control_name(bone: str) -> str:
    """The name of the control of a bone, which ends as the bone's if that is left or right."""
    stem, dot, side = bone.rpartition(".")
    return f"{stem} {REACH}.{side}" if dot and side in ("L", "R") else f"{bone} {REACH}"


def _reaching(armature: Object, figure: core.puppets.Figure) -> list[tuple[str, ...]]:
    """The bones of each leg and arm that reach: without hands and feet, if enough are left."""
    found = []
    for limb in (*figure.limbs.legs, *figure.limbs.arms):
        last = part_of(armature.data.bones[limb[-1]])
        inner = tuple(name for name in limb if part_of(armature.data.bones[name]) != last)
        found.append(inner if len(inner) >= LEAST else limb)
    return [chain for chain in found if len(chain) >= LEAST]


def _reach(armature: Object, chain: Sequence[str], target: str, influence: float) -> None:
    """Lets a chain of bones reach for a control, in the plane and within their ranges."""
    for name in chain:
        posed: Any = armature.pose.bones[name]
        low, high, *_ = armature.data.bones[name][keys.PROVED]
        posed.lock_ik_x = posed.lock_ik_y = True
        posed.use_ik_limit_z = (low, high) != (-180.0, 180.0)
        posed.ik_min_z, posed.ik_max_z = radians(low), radians(high)
    last: Any = armature.pose.bones[chain[-1]]
    reaches = reach_of(last)
    if reaches is None:
        reaches = last.constraints.new("IK")
        reaches.name, reaches.influence = REACH, influence
    reaches.target, reaches.subtarget, reaches.chain_count = armature, target, len(chain)
    reaches.use_stretch = False
