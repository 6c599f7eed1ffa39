"""A puppet in the scene as files of a game engine: meshes, textures, bones, weights and actions as they are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from .. import keys
from ..blender import mesh_data
from ..blender.jobs import drain
from ..cage_sets.selection import scene_of
from ..core import blamed, core
from ..errors import FloatArray, UserError
from ..files.pictures import image_on
from . import armatures, drawings, moving
from .imported import pixels_of

Whole = NDArray[np.int64]

# How far texture coordinates may be off the places of vertices, in pixels.
OFF_PLACE = 0.5
# Shifts of bones below this, in pixels, and turns below this, in degrees, are none.
NO_SHIFT, NO_TURN = 1e-3, 1e-3


def parts_of(rig: Object) -> list[Object]:
    """The textured layers of a puppet, the lowest first."""
    found = [obj for obj in rig.children if obj.type == "MESH" and keys.LAYER in obj.keys()]  # noqa: SIM118
    return sorted(found, key=lambda obj: (_in_rig(obj)[2, 3], obj.name))


def write(context: Context, rig: Object, path: Path, engine: str) -> tuple[list[Path], tuple[str, ...]]:
    """Writes a puppet for an engine of the core; returns the files and what is to be told. Raises: UserError."""
    return put(path, engine, *(puppet_in_scene(context, rig) if parts_of(rig) else pictured(context, rig)))


def put(
    path: Path, engine: str, puppet: core.puppets.GamePuppet, notes: tuple[str, ...]
) -> tuple[list[Path], tuple[str, ...]]:
    """Writes the files of a puppet; returns them, and what is to be told. Raises: UserError."""
    with blamed(f"'{path.name}' cannot be written"):
        files = core.puppets.write_puppet(path, puppet, engine)
        return files, (*notes, *core.puppets.undrawn(puppet, engine))


def puppet_in_scene(context: Context, rig: Object) -> tuple[core.puppets.GamePuppet, tuple[str, ...]]:
    """The puppet of an armature as it is at rest, with what is proved of it and its actions. Raises: UserError."""
    puppet, notes = as_it_stands(rig), list[str]()
    for mesh in puppet.meshes:
        with blamed(f"'{mesh.name}'"):
            loop = puppet.place.down(mesh.points[: mesh.hull])
            try:
                core.puppets.certify(loop, mesh.pixels, mesh.left, mesh.top)
            except core.NestedCagesError as error:
                notes.append(f"'{mesh.name}': {error}")
    with blamed(f"'{rig.name}'"):
        ranges = core.puppets.proved_ranges(puppet.bones, puppet.meshes)
        animations = baked(context, rig, puppet.bones, rig[keys.CANVAS][2])
    return replace(puppet, ranges=ranges, animations=animations), tuple(notes)


def as_it_stands(rig: Object) -> core.puppets.GamePuppet:
    """Bones and layers of a painting's puppet as they are at rest, the lowest first. Raises: UserError."""
    width, height, unit = rig[keys.CANVAS]
    place, bones = core.puppets.Placement(int(width), int(height)), _bones_of(rig, unit)
    number, meshes = {bone.name: k for k, bone in enumerate(bones)}, list[core.puppets.PartMesh]()
    for obj in parts_of(rig):
        there = _in_rig(obj)
        points = (mesh_data.points_of(mesh_data.mesh_of(obj)) @ there[:3, :3].T + there[:3, 3])[:, :2] / unit
        weights = group_weights(obj, number)
        if not (weights.sum(axis=1) > 0.0).all():
            raise UserError(f"'{obj.name}' has vertices without weights of bones: paint some, or remove them")
        meshes.append(part_mesh(obj, points, weights, place))
    name = bpy.path.clean_name(rig.data.name)
    return core.puppets.GamePuppet(name, place, bones, tuple(meshes), (core.puppets.JointRange(),) * len(bones))


def pictured(context: Context, rig: Object) -> tuple[core.puppets.GamePuppet, tuple[str, ...]]:
    """The puppet of an armature that moves drawings as one of pictures, with its actions, and notes: its bones, with
    weights that are solved again as engines blend. Raises: UserError."""
    objects = armatures.drawings_of(rig)
    with moving.at_rest(context, objects, rig):
        given = drain(moving.drawn(context, objects, rig))
        paints = [[each for obj in own for each in drawings.paints_of(context, obj, given.frame)]
                  for own in given.objects]  # fmt: skip
    corners = np.concatenate([part.outline.vertices for part in given.parts])
    low, high = corners.min(axis=0), corners.max(axis=0)
    pixel = float((high - low).max()) / core.puppets.LONGER_SIDE
    width, height = np.maximum(np.ceil((high - low) / pixel), 1.0).astype(int).tolist()

    def there(end: tuple[float, float]) -> tuple[float, float]:
        return (end[0] - low[0]) / pixel - 0.5 * width, (end[1] - low[1]) / pixel

    with blamed(f"'{rig.name}'"):
        found = armatures.choices_in(rig, given.parts, given.lowest, given.places_in(rig))
        choices = {
            name: replace(
                choice,
                joint=there(choice.joint) if choice.joint else None,
                chain=tuple(map(there, choice.chain)) if choice.chain else None,
            )
            for name, choice in found.items()
        }
        parts = drawings.pictures_of(given, paints, np.array((low[0], -high[1])), 1.0 / pixel)
        name = bpy.path.clean_name(rig.data.name)
        puppet = core.puppets.game_puppet(parts, (width, height), name=name, choices=choices)
        animations = baked(context, rig, _bones_of(rig, pixel), pixel)
    names = [bone.name for bone in puppet.bones]
    for k, chain in enumerate(map(puppet.puppet.draft.chain, range(len(parts)))):
        for bone, own in zip(chain, armatures.chains_of(rig.data.bones).get(given.parts[k].name, ()), strict=False):
            names[bone] = own.name
    bones = tuple(replace(bone, name=name) for bone, name in zip(puppet.bones, names, strict=True))
    return replace(puppet, bones=bones, animations=animations), (*map(str, given.problems), *puppet.notes)


def _bones_of(rig: Object, unit: float) -> tuple[core.Bone, ...]:
    """The bones of a puppet at rest, in units of a length."""
    return armatures.bones_at_rest(filter(armatures.part_of, rig.data.bones), unit)


def _in_rig(obj: Object) -> FloatArray:
    """(4, 4) the place of a part in its armature, which Blender does not keep up to date for hidden objects."""
    return np.array(obj.matrix_parent_inverse @ obj.matrix_basis)


def group_weights(obj: Object, number: dict[str, int]) -> FloatArray:
    """(n, B) weights of the vertices of a mesh in its groups that are named after numbered bones."""
    data = mesh_data.mesh_of(obj)
    weights, names = np.zeros((len(data.vertices), len(number))), [group.name for group in obj.vertex_groups]
    for vertex in data.vertices:
        for member in vertex.groups:
            if names[member.group] in number:
                weights[vertex.index, number[names[member.group]]] = member.weight
    return weights


def part_mesh(
    obj: Object, places: FloatArray, weights: FloatArray, place: core.puppets.Placement
) -> core.puppets.PartMesh:
    """The mesh of a picture with vertices at places (n, 2) in pixels and weights (n, B), its hull first. Raises:
    UserError.
    """
    data = mesh_data.mesh_of(obj)
    data.calc_loop_triangles()
    points = core.puppets.stored(places)
    triangles = mesh_data.stored(data.loop_triangles, "vertices", 3, np.int32).astype(np.int64)
    order = _hull_first(obj, triangles, len(points))
    corners = points[triangles]
    edges, others = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    turned = edges[:, 0] * others[:, 1] < edges[:, 1] * others[:, 0]
    triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    pixels, left, top = _texture(obj, place.down(points))
    ring = int((np.bincount(_rim(triangles).ravel(), minlength=len(points)) > 0).sum())
    return core.puppets.PartMesh(
        obj.name,
        str(obj.get(keys.LAYER, obj.name)),
        points[order],
        ring,
        back[triangles],
        core.puppets.engine_weights(weights)[order],
        left,
        top,
        pixels,
        str(obj.get(keys.BLEND, "normal")),
        not obj.hide_render,
    )


def _rim(triangles: Whole) -> Whole:
    """(n, 2) sides that belong to one triangle, in the triangle's direction."""
    sides = np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2)
    _, first, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    return np.asarray(sides[first[count == 1]])


def _hull_first(obj: Object, triangles: Whole, count: int) -> Whole:
    """The vertices, those of the outline first and in order. Raises: UserError."""
    following = dict(_rim(triangles).tolist())
    hull = [next(iter(following), 0)]
    while (after := following.get(hull[-1])) is not None and after != hull[0] and len(hull) <= count:
        hull.append(after)
    if len(hull) != len(following) or len(hull) < 3:
        raise UserError(f"'{obj.name}' is not one area without holes: engines need an outline of one loop")
    inside = [vertex for vertex in range(count) if vertex not in following]
    return np.array([*hull, *inside])


def _texture(obj: Object, places: FloatArray) -> tuple[Any, int, int]:
    """The pixels of a layer, and their left and top on the canvas. Raises: UserError."""
    image = image_on(obj)
    if image is None:
        raise _untextured(obj)
    pixels, uv = pixels_of(image), texture_places(obj)
    shown = np.stack((uv[:, 0], 1.0 - uv[:, 1]), axis=1) * (pixels.shape[1], pixels.shape[0])
    corner = places[mesh_data.corner_vertices(mesh_data.mesh_of(obj))] - shown
    left, top = np.round(corner.mean(axis=0)).astype(int).tolist()
    if np.abs(corner - (left, top)).max() > OFF_PLACE:
        raise UserError(f"'{obj.name}' does not show its picture where it was painted: undo changes of its coordinates")
    return pixels, left, top


def texture_places(obj: Object) -> NDArray[np.float32]:
    """Places (L, 2) of the corners of the faces of a picture, from 0 to 1. Raises: UserError."""
    uv = mesh_data.texture_places(mesh_data.mesh_of(obj))
    if uv is None:
        raise _untextured(obj)
    return uv


def _untextured(obj: Object) -> UserError:
    return UserError(f"'{obj.name}' has no texture: give it the material with its picture again")


def baked(context: Context, rig: Object, bones: Sequence[core.Bone], unit: float) -> tuple[core.puppets.Animation, ...]:
    """The actions of an armature, as seen: with constraints and IK, a key on each frame."""
    scene = scene_of(context)
    rate = scene.render.fps / scene.render.fps_base
    found = []
    with _kept(scene, rig):
        for action in _actions(rig):
            rig.animation_data.action = action
            if hasattr(rig.animation_data, "action_suitable_slots") and rig.animation_data.action_slot is None:
                rig.animation_data.action_slot = next(iter(rig.animation_data.action_suitable_slots), None)
            first, last = round(action.frame_range[0]), round(action.frame_range[1])
            frames = range(first, max(last, first + 1) + 1)
            moved = np.array([_matrices(context, rig, bones, frame) for frame in frames])
            found.append(_keys_of(action.name, moved, bones, unit, (np.array(frames) - first) / rate))
    return tuple(found)


def _actions(rig: Object) -> list[bpy.types.Action]:
    """The action of an armature, and those of its tracks."""
    animation = rig.animation_data
    if animation is None:
        return []
    strips = [strip.action for track in animation.nla_tracks for strip in track.strips]
    return list(dict.fromkeys(action for action in (animation.action, *strips) if action is not None))


@contextmanager
def _kept(scene: bpy.types.Scene, rig: Object) -> Iterator[None]:
    """Puts back the frame and the action of an armature."""
    animation = rig.animation_data
    if animation is None:
        yield
        return
    frame, action, layered = scene.frame_current, animation.action, animation.use_nla
    slot = getattr(animation, "action_slot", None)
    animation.use_nla = False
    try:
        yield
    finally:
        animation.action, animation.use_nla = action, layered
        if slot is not None:
            animation.action_slot = slot
        scene.frame_set(frame)


def _matrices(context: Context, rig: Object, bones: Sequence[core.Bone], frame: int) -> list[list[list[float]]]:
    """Of each bone on a frame, from its place at rest to where it is."""
    scene_of(context).frame_set(frame)
    posed: Any = rig.evaluated_get(context.evaluated_depsgraph_get())
    at_rest = (rig.data.bones[bone.name] for bone in bones)
    return [
        [list(row) for row in posed.pose.bones[bone.name].matrix @ bone.matrix_local.inverted_safe()]
        for bone in at_rest
    ]


def _keys_of(
    name: str, moved: FloatArray, bones: Sequence[core.Bone], unit: float, times: FloatArray
) -> core.puppets.Animation:
    """Keys from how bones move (K, B, 4, 4) from rest."""
    angle = np.unwrap(np.arctan2(moved[:, :, 1, 0], moved[:, :, 0, 0]), axis=0)
    turned, shifted = {}, {}
    for k, bone in enumerate(bones):
        head = np.array(bone.head)
        above = np.tile(np.eye(4), (len(times), 1, 1)) if bone.parent is None else moved[:, bone.parent]
        own = angle[:, k] - (0.0 if bone.parent is None else angle[:, bone.parent])
        turned[bone.name] = np.rad2deg(own - 2.0 * np.pi * np.round(own[0] / (2.0 * np.pi)))
        there = moved[:, k, :2, :2] @ head + moved[:, k, :2, 3] / unit
        local = np.linalg.solve(above[:, :2, :2], (there - above[:, :2, 3] / unit)[..., None])[..., 0] - head
        if np.abs(local).max() > NO_SHIFT:
            shifted[bone.name] = local
    turned = {name: keys_ for name, keys_ in turned.items() if np.abs(keys_).max() > NO_TURN}
    return core.puppets.Animation(name, times, turned, shifted)
