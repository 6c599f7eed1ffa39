"""Steps as shape keys and keyframes, written with Blender's bulk calls.

Relative shape keys over a Basis that is the result: each step is a key whose value goes 0 → 1 → 0 with linear
interpolation, so the evaluated mesh is the step on its frame and the linear blend of two steps between their frames.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

import bpy
import numpy as np
from bpy.types import Mesh, Object
from numpy.typing import NDArray

from ..errors import FloatArray
from .mesh_data import stored

# Names of the shape keys that `add_steps` makes; other keys are the artist's.
STEP = re.compile(r"Level \d+ Step \d+(\.\d+)?")
# Blender's numbers for the interpolation of a keyframe.
CONSTANT, LINEAR = 0, 1


def new_action(name: str) -> bpy.types.Action | None:
    """An action for several data-blocks; None before Blender 4.4, where each needs its own."""
    return bpy.data.actions.new(name) if "slots" in bpy.types.Action.bl_rna.properties else None


def add_basis(obj: Object) -> None:
    """Makes the current mesh the Basis of the shape keys to be added."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis", from_mix=False)


def add_steps(
    obj: Object,
    steps: NDArray[np.float32],
    frames: FloatArray,
    name: str,
    *,
    from_rest: bool = False,
    held: bool = False,
    action: bpy.types.Action | None = None,
) -> None:
    """Adds and animates one shape key per step (S, n, 2) that differs from the object's mesh, at frames (S,).

    Consecutive equal steps share a key, which is held. The first step holds before the first frame, the last one after
    the last; `from_rest`: the mesh itself shows until one frame before the first; `held`: no step moves to the next.
    """
    basis = stored(obj.data.vertices, "co", 3)
    coordinates = basis.copy()
    runs = _runs_of_equal(steps)
    at_rest = (steps == basis[:, :2]).all(axis=(1, 2))
    fcurves: list[tuple[str, list[float]]] = []
    add_basis(obj)
    for index, (first, last) in enumerate(runs):
        if at_rest[first]:
            continue
        coordinates[:, :2] = steps[first]
        key = obj.shape_key_add(name=f"{name} Step {first}", from_mix=False)  # see STEP
        key.points.foreach_set("co", coordinates.ravel())
        points = _rise_and_fall(frames, first, last, len(steps))
        if index == 0 and from_rest:
            points.insert(0, (frames[0] - 1.0, 0.0))
        path = f'key_blocks["{bpy.utils.escape_identifier(key.name)}"].value'
        fcurves.append((path, [number for point in points for number in point]))
    animate(obj.data.shape_keys, fcurves, CONSTANT if held else LINEAR, f"{obj.name} Steps", action)


def is_step(path: str) -> bool:
    """Whether a data path belongs to a step from `add_steps`."""
    found = STEP.search(path)
    return found is not None and path.startswith(f'key_blocks["{found[0]}"]')


def is_step_shown(obj: Object) -> bool:
    """Whether the object shows a step instead of its own shape on this frame."""
    shapes = obj.data.shape_keys
    return shapes is not None and any(key.value != 0.0 for key in shapes.key_blocks if STEP.fullmatch(key.name))


def remove_steps(obj: Object) -> None:
    """Removes the steps from `add_steps` and their keyframes; the artist's keys stay, with the Basis."""
    shapes = obj.data.shape_keys
    if shapes is None:
        return
    action, curves = action_of(shapes), curves_of(shapes)
    if action is not None and all(is_step(curve.data_path) for curve in curves):
        shapes.animation_data.action = None
        discard((), (), [action])
    elif action is not None:
        if is_shared(shapes):
            own_action(shapes, action.name)
            curves = curves_of(shapes)
        for curve in [curve for curve in curves if is_step(curve.data_path)]:
            curves.remove(curve)
    steps = [key for key in shapes.key_blocks if STEP.fullmatch(key.name)]
    if len(steps) + 1 < len(shapes.key_blocks):
        for key in steps:
            obj.shape_key_remove(key)
    else:
        remove_animation(shapes)
        home = stored(shapes.reference_key.points, "co", 3)
        obj.shape_key_clear()
        obj.data.vertices.foreach_set("co", home.ravel())
    obj.data.update()


def copy_steps(mesh: Mesh, obj: Object) -> None:
    """Copies the steps in a mesh, and what plays them, to an object with as many vertices."""
    shapes = mesh.shape_keys
    steps = [key for key in shapes.key_blocks if STEP.fullmatch(key.name)] if shapes is not None else []
    if shapes is None or not steps:
        return
    add_basis(obj)
    for key in steps:
        made = obj.shape_key_add(name=key.name, from_mix=False)
        made.points.foreach_set("co", stored(key.points, "co", 3).ravel())
    curves = [curve for curve in curves_of(shapes) if is_step(curve.data_path)]
    keyframes = [(curve.data_path, stored(curve.keyframe_points, "co", 2).ravel()) for curve in curves]
    moving = any(point.interpolation == "LINEAR" for curve in curves[:1] for point in curve.keyframe_points)
    action = action_of(shapes) if hasattr(shapes.animation_data, "action_slot") else None
    animate(obj.data.shape_keys, keyframes, LINEAR if moving else CONSTANT, f"{obj.name} Steps", action)


def _rise_and_fall(frames: FloatArray, first: int, last: int, count: int) -> list[tuple[float, float]]:
    """Frames and values of the key that shows from one step to another, both included."""
    points = [(float(frames[first - 1]), 0.0)] if first > 0 else []
    points.append((float(frames[first]), 1.0))
    if last > first:
        points.append((float(frames[last]), 1.0))
    if last + 1 < count:
        points.append((float(frames[last + 1]), 0.0))
    return points


def animate(
    owner: Any,
    fcurves: Sequence[tuple[str, Sequence[float] | NDArray[np.float32]]],
    interpolation: int,
    name: str,
    action: bpy.types.Action | None = None,
) -> None:
    """Animates properties of a data-block: pairs of a data path and its keyframes as frame, value, frame, value …

    In the action that it has, or else in a new slot of `action`, or else in one of its own.
    """
    if not fcurves:
        return
    animation = owner.animation_data or owner.animation_data_create()
    if animation.action is None:
        animation.action = action or bpy.data.actions.new(name)
        if action is not None:
            animation.action_slot = action.slots.new(owner.id_type, name)
    action = animation.action
    for path, keyframes in fcurves:
        fcurve = curve_for(owner, path)
        count = len(keyframes) // 2
        fcurve.keyframe_points.add(count)
        fcurve.keyframe_points.foreach_set("co", keyframes)
        fcurve.keyframe_points.foreach_set("interpolation", [interpolation] * count)
        fcurve.update()


def curve_for(owner: Any, path: str, index: int = 0) -> Any:
    """The F-curve of a property in a data-block's action, which is made if there is none."""
    action = owner.animation_data.action
    # Blender 4.4 introduced slots in actions, and 5.0 removed the older interface.
    if hasattr(action, "fcurve_ensure_for_datablock"):
        return action.fcurve_ensure_for_datablock(owner, path, index=index)
    return action.fcurves.find(path, index=index) or action.fcurves.new(path, index=index)


def action_of(owner: Any) -> bpy.types.Action | None:
    """The action that animates a data-block; None if there is neither."""
    animation = owner.animation_data if owner is not None else None
    return animation.action if animation is not None else None


def curves_of(owner: Any) -> Any:
    """The F-curves of a data-block, as a collection that can remove one; empty if there is no action."""
    action: Any = action_of(owner)
    if action is None:
        return ()
    if not hasattr(action, "slots"):
        return action.fcurves
    slot = owner.animation_data.action_slot
    bags = (strip.channelbag(slot) for layer in action.layers for strip in layer.strips)
    return next((bag.fcurves for bag in bags if bag is not None), ())


def own_action(owner: Any, name: str) -> None:
    """Gives a data-block its own copy of its action, without what is in other slots."""
    animation = owner.animation_data
    slot, action = getattr(animation, "action_slot", None), animation.action.copy()
    animation.action, action.name = action, name
    if slot is not None:
        animation.action_slot = action.slots[slot.identifier]
        for other in [each for each in action.slots if each.identifier != slot.identifier]:
            action.slots.remove(other)


def own_actions(owners: Iterable[Any]) -> None:
    """Gives data-blocks their own copies of actions that animate others too."""
    for owner in owners:
        if is_shared(owner):
            own_action(owner, owner.animation_data.action.name)


def is_shared(owner: Any) -> bool:
    """Whether what animates a data-block animates another one too."""
    action = action_of(owner)
    if action is None or action.users < 2:
        return False
    slot = getattr(owner.animation_data, "action_slot", None)
    return slot is None or len(slot.users()) > 1


def remove_animation(owner: Any) -> None:
    """Removes a data-block's animation, and its action if nothing else uses it."""
    if owner is None or owner.animation_data is None:
        return
    action = owner.animation_data.action
    owner.animation_data_clear()
    if action is not None and action.users == 0:
        bpy.data.actions.remove(action)


def remove_mesh(mesh: Mesh) -> None:
    """Removes a mesh that nothing uses any more, with the actions of its shape keys."""
    if mesh.users == 0:
        remove_animation(mesh.shape_keys)
        bpy.data.meshes.remove(mesh, do_unlink=False)  # nothing to unlink, which takes a pass over the file


def discard(
    objects: Iterable[bpy.types.Object], meshes: Iterable[bpy.types.Mesh], actions: Iterable[bpy.types.Action | None]
) -> None:
    """Removes objects, and then the meshes and actions that nothing uses any more, also those of their animation.

    Objects in one pass over the file; what nothing uses takes none.
    """
    gone = list(objects)
    played = {*actions, *map(action_of, gone)}
    if gone:
        bpy.data.batch_remove(gone)
    unused = _unused(meshes)
    played |= {action_of(owner) for mesh in unused for owner in (mesh, mesh.shape_keys)}
    for mesh in unused:
        bpy.data.meshes.remove(mesh, do_unlink=False)
    for action in _unused(played):
        bpy.data.actions.remove(action, do_unlink=False)


def _unused(blocks: Iterable[Any]) -> list[Any]:
    """Those without users."""
    return [block for block in set(blocks) - {None} if not block.users]


def _runs_of_equal(steps: NDArray[np.float32]) -> list[tuple[int, int]]:
    """First and last index of each run of equal steps (S, n, 2)."""
    changes = np.flatnonzero((steps[1:] != steps[:-1]).any(axis=(1, 2))) + 1
    firsts = [0, *changes.tolist()]
    return list(zip(firsts, [*(first - 1 for first in firsts[1:]), len(steps) - 1], strict=True))
