"""The walk of a puppet as an action: keys of its bones within what is proved of them, that repeat."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.types import Context, Object

from .. import keys
from ..blender.shape_keys import curve_for, curves_of
from ..cage_sets.selection import scene_of
from ..core import blamed, core
from ..errors import FloatArray, UserError
from . import armatures
from .controls import REACH, ROOT, reach_of

# Length of a walk in seconds, and its keys.
SECONDS, KEYS = 1.0, 8
# Blender's number for the interpolation of a keyframe by a Bézier curve, and for handles that don't overshoot.
BEZIER, CLAMPED = 2, 4


def add_walk(context: Context, armature: Object) -> bpy.types.Action:
    """A new action of a puppet, in place of the one that it plays, which stays in the file. Raises: UserError."""
    figure, scene = armatures.figure_of(armature), scene_of(context)
    step = max(1, round(SECONDS * scene.render.fps / scene.render.fps_base / KEYS))
    with blamed(f"'{armature.name}'"):
        clip = core.puppets.walk(figure, seconds=SECONDS, frames=KEYS)
    for bone in figure.bones:
        if armature.pose.bones[bone.name].rotation_mode in ("QUATERNION", "AXIS_ANGLE"):
            raise UserError(f"'{bone.name}' is turned by quaternions or an axis: set its mode to XYZ Euler")
    animation = armature.animation_data or armature.animation_data_create()
    if animation.use_tweak_mode:
        raise UserError(f"'{armature.name}' is in Tweak Mode of the NLA: leave it first")
    if animation.action is not None:
        animation.action.use_fake_user = True
    action = animation.action = bpy.data.actions.new(f"{armature.name} {clip.name.title()}")
    frames = scene.frame_start + step * np.arange(KEYS + 1.0)
    for bone in figure.bones:
        sign = 1.0 if armature.data.bones[bone.name].z_axis.z >= 0.0 else -1.0
        turned = np.deg2rad([sign * pose.get(bone.name, 0.0) for pose in clip.frames])
        _key(armature, _path(bone.name, "rotation_euler"), 2, frames, turned)
        if reach_of(armature.pose.bones[bone.name]) is not None:
            _key(armature, _path(bone.name, f'constraints["{REACH}"].influence'), 0, frames, np.zeros(KEYS))
    root = next((bone.name for bone in armature.data.bones if bone.get(keys.CONTROL) == ROOT), None)
    if root is not None:
        _key(armature, _path(root, "location"), 1, frames, np.array(clip.rise))
    action.use_frame_range, action.use_cyclic = True, True
    action.frame_start, action.frame_end = float(frames[0]), float(frames[-1])
    return action


def beyond(armature: Object) -> set[int]:
    """The frames of the action of a puppet on which it turns a bone out of the range that is proved."""
    figure, action = armatures.figure_of(armature), armature.animation_data.action
    curves = {(curve.data_path, curve.array_index): curve for curve in curves_of(armature)}
    first, last = round(action.frame_range[0]), round(action.frame_range[1])
    found = set[int]()
    for bone, proved in zip(figure.bones, figure.ranges, strict=True):
        curve = curves.get((_path(bone.name, "rotation_euler"), 2))
        turns = {} if curve is None else {k: np.rad2deg(curve.evaluate(k)) for k in range(first, last + 1)}
        found |= {frame for frame, turn in turns.items() if not proved.holds(turn)}
    return found


def _path(bone: str, name: str) -> str:
    """The data path of a property of a bone."""
    return f'pose.bones["{bpy.utils.escape_identifier(bone)}"].{name}'


def _key(armature: Object, path: str, index: int, frames: FloatArray, values: FloatArray) -> None:
    """Keys of a property that repeat, the first value again at the end; one key if they are all the same."""
    curve = curve_for(armature, path, index)
    points = np.column_stack([frames, np.append(values, values[0])])
    if not np.ptp(values):
        points = points[:1]
    else:
        curve.modifiers.new("CYCLES")
    curve.keyframe_points.add(len(points))
    curve.keyframe_points.foreach_set("co", points.ravel())
    for name, value in (("interpolation", BEZIER), ("handle_left_type", CLAMPED), ("handle_right_type", CLAMPED)):
        curve.keyframe_points.foreach_set(name, [value] * len(points))
    curve.update()
