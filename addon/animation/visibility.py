"""The animation of how cages form: objects that are hidden until a frame, by keyframes that can be removed again; the
marker of the result, and the scene's range.

While it plays, a moving copy of the drawing, which follows the fine mesh and has its material, replaces the originals.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import bpy
from bpy.types import Mesh, Object, Scene

from .. import cage_sets
from ..blender import display, shape_keys
from ..blender.display import add_nodes_modifier
from ..cage_sets import CageSet
from ..cage_sets.selection import check_free
from ..errors import UserError

# Name and frame of a marker.
Mark = tuple[str, int]
# The properties that hide an object.
VISIBILITY = ("hide_viewport", "hide_render")


def hide_until(obj: Object, frame: int, action: bpy.types.Action | None = None) -> None:
    """Hides the object, in the viewport and in renders, on all frames before `frame`.

    action: see `shape_keys.animate`.
    """
    switch(obj, [(frame - 1, True), (frame, False)], action)


def switch(obj: Object, frames: Sequence[tuple[int, bool]], action: bpy.types.Action | None = None) -> None:
    """Hides or shows the object, in the viewport and in renders, from each of some frames on."""
    keyframes = [float(number) for pair in frames for number in pair]
    shape_keys.animate(obj, [(path, keyframes) for path in VISIBILITY], shape_keys.CONSTANT, obj.name, action)
    obj.update_tag(refresh={"TIME"})  # takes effect now, not on the next frame change


def is_free(obj: Object) -> bool:
    """Whether an object is visible without any animation of the user's that controls it."""
    if not obj.is_editable or obj.hide_viewport or obj.hide_render:
        return False
    data = obj.animation_data
    return data is None or all(
        curve.data_path not in VISIBILITY for curve in (*shape_keys.curves_of(obj), *data.drivers)
    )


def mute(obj: Object, muted: bool) -> None:
    """Mutes or unmutes the keyframes that hide the object."""
    for curve in shape_keys.curves_of(obj):
        if curve.data_path in VISIBILITY:
            curve.mute = muted


def detach(obj: Object) -> bpy.types.Action | None:
    """Undoes `hide_until`. Returns the action that has left the object; with other animation in it, it stays."""
    data, action = obj.animation_data, shape_keys.action_of(obj)
    for name in VISIBILITY:
        if getattr(obj, name):  # setting it makes Blender go through all objects
            setattr(obj, name, False)
    if action is None:
        return None
    curves = shape_keys.curves_of(obj)
    ours = [curve for curve in curves if curve.data_path in VISIBILITY]
    if len(ours) < len(curves):
        for curve in ours:
            curves.remove(curve)
        if ours and action.users > 1 and hasattr(data, "action_slot"):
            shape_keys.own_action(obj, obj.name)
        return None
    data.action = None
    if not len(data.drivers) and not len(data.nla_tracks):
        obj.animation_data_clear()
    return action


def always_show(obj: Object) -> None:
    """Undoes `hide_until` permanently."""
    action = detach(obj)
    if action is not None and action.users == 0:
        bpy.data.actions.remove(action)


def enter(cage_set: CageSet) -> None:
    """Hides the originals of an output before and after its result, and shows the moving copy instead.

    Around inner cages the drawing does not move; in another scene without the cages it stays as it is.
    """
    if cage_set.record.playing:
        leave(cage_set)
    frames, fine = frames_of(cage_set), cage_set.fine
    if frames is None or fine is None or cage_set.bound or cage_set.inside:
        return
    first, result, _ = frames
    playing = [(first - 1, False), (first, True), (result, False)]
    source = cage_set.source
    if source is not None and _is_elsewhere(source, fine):
        return
    cage_set.record.playing = True
    action = shape_keys.new_action(source.name if source is not None else fine.name)
    for part in cage_set.references:
        if cage_sets.exists(part.object) and is_free(part.object):
            part.hidden = True
            switch(part.object, playing, action)
    copy = make_copy(fine, source)
    switch(copy, [(frame, not hidden) for frame, hidden in playing], action)


def _is_elsewhere(source: Object, fine: Object) -> bool:
    """Whether a drawing is in a scene that its cages are not in, where it would be hidden, and its copy a ghost."""
    return any(s.objects.get(source.name) == source and s.objects.get(fine.name) != fine for s in bpy.data.scenes)


def leave(*sets: CageSet) -> None:
    """Shows the originals of outputs again and removes the moving copies."""
    actions: list[bpy.types.Action | None] = []
    copies: list[Object] = []
    for cage_set in sets:
        for part in cage_set.references:
            if part.hidden and cage_sets.exists(part.object):
                actions.append(detach(part.object))
            part.hidden = False
        if cage_set.record.playing:
            cage_set.record.playing = False
        copies += [obj for fine in cage_set.members[:1] for obj in cage_sets.helpers_of(fine, cage_sets.FILL)]
    for copy in copies:
        for modifier in list(copy.modifiers):
            display.remove_modifier(copy, modifier)
    meshes = [copy.data for copy in copies if isinstance(copy.data, Mesh)]
    shape_keys.discard(copies, meshes, actions)


def make_copy(fine: Object, source: Object | None) -> Object:
    """A new object that fills the outline of `fine`, next to the drawing that it stands for."""
    name = f"{source.name if source is not None else fine.name} Moving"
    mesh = bpy.data.meshes.new(name)
    copy = bpy.data.objects.new(name, mesh)
    cage_sets.make_helper(copy, cage_sets.FILL, fine)
    copy.parent = fine
    copy.location.z = fine.data.vertices[0].co.z  # the filled area is flat, at height 0
    copy.hide_select = True
    if source is not None:
        copy.color = source.color
    for home in (source.users_collection if source is not None else ()) or fine.users_collection:
        home.objects.link(copy)
    material = main_material(source) if source is not None else None
    add_nodes_modifier(copy, display.FILL, display.group(display.FILL), {"Object": fine, "Material": material})
    return copy


def main_material(source: Object) -> bpy.types.Material | None:
    """The material of most faces of an object; the active one if there are no faces."""
    slots = [slot.material for slot in source.material_slots]
    if source.type == "MESH" and len(source.data.polygons) and len(slots) > 1:
        counts = [0] * len(slots)
        for polygon in source.data.polygons:
            counts[min(polygon.material_index, len(slots) - 1)] += 1
        return slots[counts.index(max(counts))]
    own = source.active_material or next((material for material in slots if material is not None), None)
    return _of_strokes(own) if own is not None and getattr(own, "is_grease_pencil", False) else own


def _of_strokes(material: bpy.types.Material) -> bpy.types.Material:
    """A material for faces in the colour of a Grease Pencil material, which faces cannot have; one per file."""
    name = f"{material.name} Fill"
    fill = bpy.data.materials.get(name)
    if fill is None:
        fill = bpy.data.materials.new(name)
        style: Any = material.grease_pencil
        fill.diffuse_color = style.fill_color if style.show_fill else style.color
        if fill.node_tree is None:  # always there since Blender 5.0
            fill.use_nodes = True
        shader = next((node for node in fill.node_tree.nodes if "Base Color" in node.inputs), None)
        if shader is not None:
            shader.inputs["Base Color"].default_value = fill.diffuse_color
    return fill


def play_in(cage_set: CageSet, marker: Mark) -> None:
    """Notes that an output plays, and its marker, which several may share."""
    noted = cage_set.record
    noted.animated, (noted.marker, noted.marker_frame) = True, marker


def settle(scene: Scene, dropped: Iterable[Mark], added: Iterable[Mark] = ()) -> None:
    """Removes markers that no output needs any more, adds new ones, and fits the scene's range to what plays."""
    sets = CageSet.everywhere()
    for name, frame in set(dropped) - {marker_of(each) for each in sets}:
        marker = next((m for m in scene.timeline_markers if (m.name, m.frame) == (name, frame)), None)
        if marker is not None:
            scene.timeline_markers.remove(marker)
    there = {(marker.name, marker.frame) for marker in scene.timeline_markers}
    for name, frame in set(added) - there:
        scene.timeline_markers.new(name, frame=frame)
    _fit_range(scene, sets)


def marker_of(cage_set: CageSet) -> Mark:
    """The marker of an output's animation; one without a name if there is none."""
    noted = cage_set.record
    return str(noted.marker), int(noted.marker_frame)


def stop_playing(cage_set: CageSet) -> Mark:
    """Notes that an output does not play any more; returns its marker."""
    dropped, noted = marker_of(cage_set), cage_set.record
    noted.marker, noted.animated = "", False
    return dropped


def frames_of(cage_set: CageSet) -> tuple[int, int, int] | None:
    """First frame of an output's animation, frame of its result, and last frame; None if it has no animation."""
    noted = cage_set.record
    return tuple(noted.frames) if noted.animated else None


def _fit_range(scene: Scene, sets: Iterable[CageSet]) -> None:
    """Fits the scene's range to the animations in it; ends that the user has changed since are kept."""
    now = (scene.frame_start, scene.frame_end)
    stored = cage_sets.range_of(scene) or (*now, *now)
    start, end = (before if at == ours else at for before, ours, at in zip(stored[:2], stored[2:], now, strict=True))
    playing = [(each, frames_of(each)) for each in sets]
    played = [frames for each, frames in playing if frames is not None and is_in(scene, each)]
    first = min([start, *(max(frames[0], 0) for frames in played)])
    last = max([end, *(frames[2] for frames in played)])
    if (first, last) != now:
        scene.frame_start, scene.frame_end = first, last
    if not played:
        cage_sets.set_range(scene, None)
    elif (first, last) != (start, end):
        cage_sets.set_range(scene, (start, end, first, last))


def is_in(scene: Scene, cage_set: CageSet) -> bool:
    """Whether objects of an output are in the scene."""
    return any(scene.objects.get(obj.name) == obj for obj in cage_set.members)


def is_animated(cage_set: CageSet) -> bool:
    """Whether the steps of a set play."""
    meshes = [obj.data for obj in cage_set.members if obj.type == "MESH"]
    return any(shape_keys.action_of(mesh.shape_keys) is not None for mesh in meshes)


def remove(scene: Scene, cage_set: CageSet) -> None:
    """Removes the steps, their keyframes and markers; the fine mesh, the cages, other keys and animation stay.

    Raises: UserError.
    """
    if cage_set.bound:
        raise UserError(f"'{cage_set.name}' is bound to its cages, which turns off the animation: unbind it first")
    check_free(cage_set.members)
    if not is_animated(cage_set):
        raise UserError(f"'{cage_set.name}' has no animation")
    end(scene, cage_set)
    cage_set.record.moving = False


def end(scene: Scene, cage_set: CageSet) -> None:
    """Removes what plays of an output, and what its objects say about it."""
    leave(cage_set)
    settle(scene, [stop_playing(cage_set)])
    for obj in cage_set.members:
        shape_keys.remove_steps(obj)
        always_show(obj)
        cage_sets.node_of(obj).property_unset("frames")
