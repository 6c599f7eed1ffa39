"""Caps of puppets in the scene: paint of a part that stays on its parent at their joint, so that nothing opens there.

A cap is a piece of what its drawings show, with their materials and textures, directly behind them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import bpy
import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from .. import keys
from ..blender import mesh_data
from ..core import core
from ..drawing.painted import SOLID
from ..drawing.plane import Frame, middle_of_box, size, transform, world_matrix
from ..errors import FloatArray
from . import armatures

# Distance from a drawing to the next one behind it, as a fraction of the size of all, where there is none.
BEHIND = 1e-3
# Heights of a cap in that distance: of what its lowest and its highest drawing show, and of ink at its edge.
LOWEST, HIGHEST, INK = 0.5, 0.25, 0.2


class Shown(NamedTuple):
    """The triangles of an object, and what is painted on them."""

    corners: FloatArray
    """(t, 3, 2) in the frame."""
    materials: NDArray[np.int32]
    """(t,) numbers of materials."""
    texture: FloatArray
    """(t, 3, 2) its coordinates at corners."""


def with_faces(drawings: Sequence[Object]) -> list[Object]:
    """Those that caps can be cut from."""
    return [obj for obj in drawings if obj.type in SOLID]


def remove_caps(armature: Object) -> None:
    """Removes the caps of a puppet."""
    _remove([child for child in armature.children if armatures.is_cap(child)])


def remove_left_over(drawings: Sequence[Object]) -> None:
    """Removes the caps of drawings whose armature was deleted."""
    lone = [obj for obj in bpy.data.objects if obj.parent is None and armatures.is_cap(obj) and obj.animation_data]
    targets = {cap: [each.driver.variables[0].targets[0].id for each in cap.animation_data.drivers] for cap in lone}
    _remove([cap for cap, hiding in targets.items() if any(obj in drawings for obj in hiding)])


def _remove(gone: Sequence[Object]) -> None:
    bpy.data.batch_remove([block for cap in gone for block in (cap, cap.data)])


def draw_caps(
    context: Context,
    armature: Object,
    frame: Frame,
    drawings: Sequence[Sequence[Object]],
    puppet: core.puppets.Puppet,
    caps: Sequence[core.puppets.Cap],
) -> None:
    """Draws caps of a puppet at rest. Parts that show no faces get none.

    drawings: those of each part.
    """
    depth = {obj: float(frame.from_world(middle_of_box(obj)[None])[1][0]) for each in drawings
             for obj in each}  # fmt: skip
    whole = BEHIND * frame.scale * size(np.concatenate([part.outline.vertices for part in puppet.draft.parts]))
    for cap in caps:
        own = with_faces(drawings[cap.part])
        if not own:
            continue
        low, high = (end(depth[obj] for obj in own) for end in (min, max))
        gap = min((low - each for each in depth.values() if each < low), default=whole)
        rise = (LOWEST - HIGHEST) * gap / max(high - low, gap)
        own.sort(key=lambda obj: depth[obj])
        behind = [*(LOWEST * gap - rise * (depth[obj] - low) for obj in own), INK * gap]
        heights = [frame.height + (low - each) / frame.scale for each in behind]
        data = _piece_of(context, puppet.draft.parts[cap.part], own, heights, cap, frame)
        if data is not None:
            _hang(data, own[0], armature, puppet.bones[cap.bone].name)


def _hang(data: bpy.types.Mesh, drawing: Object, armature: Object, bone: str) -> None:
    """Makes a cap that a bone moves, and that keys of its drawing's visibility hide too."""
    made = bpy.data.objects.new(data.name, data)
    drawing.users_collection[0].objects.link(made)
    made.matrix_world = armature.matrix_world
    made[keys.CAP] = True
    armatures.hang(made, armature, bone)
    for path in ("hide_viewport", "hide_render"):
        driver = made.driver_add(path).driver
        driver.type = "AVERAGE"
        driver.variables.new().targets[0].id = drawing
        driver.variables[0].targets[0].data_path = path


def _piece_of(
    context: Context,
    part: core.puppets.PuppetPart,
    drawings: Sequence[Object],
    heights: Sequence[float],
    cap: core.puppets.Cap,
    frame: Frame,
) -> bpy.types.Mesh | None:
    """What drawings show in a cap, the lowest first, each at its height in the frame, and ink at the last; None if
    that is nothing."""
    points, faces, numbers, texture = list[FloatArray](), list[range](), list[int](), list[FloatArray]()
    materials: list[bpy.types.Material | None] = []

    def add(ring: FloatArray, height: float, material: int, uv: FloatArray) -> None:
        first = faces[-1].stop if faces else 0
        faces.append(range(first, first + len(ring)))
        points.append(np.column_stack([ring, np.full(len(ring), height)]))
        numbers.append(material)
        texture.append(uv)

    everything = list[Shown]()
    for obj, height in zip(drawings, heights[:-1], strict=True):
        shown = _seen_of(context, obj, frame)
        shown = shown._replace(materials=shown.materials + len(materials))
        for triangle, ring, shares in cap.pieces(shown.corners):
            add(ring, height, int(shown.materials[triangle]), shares @ shown.texture[triangle])
        materials += [slot.material for slot in obj.material_slots] or [None]
        everything.append(shown)
    if not faces:
        return None
    corners, paints, uv = (np.concatenate(each) for each in zip(*everything, strict=True))
    ink = cap.ink(part, partial(_paints_at, corners, paints))
    if ink is not None:
        there = uv[np.flatnonzero(paints == ink.paint)[0]].mean(axis=0)
        for ring in ink.rings:
            add(ring, heights[-1], ink.paint, np.tile(there, (len(ring), 1)))
    data = mesh_data.new_mesh(f"{part.name} Cap", np.concatenate(points), faces=[list(face) for face in faces])
    for material in materials:
        data.materials.append(material)
    data.polygons.foreach_set("material_index", np.array(numbers, np.int32))
    layer: Any = data.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", np.concatenate(texture).astype(np.float32).ravel())
    return data


def _seen_of(context: Context, obj: Object, frame: Frame) -> Shown:
    """The triangles that an object shows."""
    with mesh_data.evaluated_mesh(obj.evaluated_get(context.evaluated_depsgraph_get())) as mesh:
        if mesh is None:
            return Shown(np.zeros((0, 3, 2)), np.zeros(0, np.int32), np.zeros((0, 3, 2)))
        mesh.calc_loop_triangles()
        flat = frame.from_world(transform(world_matrix(obj), mesh_data.points_of(mesh)))[0]
        corners = flat[mesh_data.stored(mesh.loop_triangles, "vertices", 3, np.int32)]
        materials = mesh_data.stored(mesh.loop_triangles, "material_index", 1, np.int32).ravel()
        layer: Any = mesh.uv_layers.active
        texture = np.zeros_like(corners)
        if layer is not None:
            loops = mesh_data.stored(mesh.loop_triangles, "loops", 3, np.int32)
            texture = mesh_data.stored(layer.data, "uv", 2).astype(np.float64)[loops]
    return Shown(corners, materials.clip(0, max(len(obj.material_slots) - 1, 0)), texture)


def _paints_at(corners: FloatArray, paints: NDArray[np.int32], places: FloatArray) -> NDArray[np.int64]:
    """The paint (n,) of the last triangle (t, 3, 2) at each place (n, 2), -1 where there is none."""
    found = np.full(len(places), -1)
    near = ((corners.max(axis=1) >= places.min(axis=0)) & (corners.min(axis=1) <= places.max(axis=0))).all(axis=1)
    for (one, other, third), paint in zip(corners[near], paints[near], strict=True):
        sides = [(places - start) @ [start[1] - end[1], end[0] - start[0]]
                 for start, end in ((one, other), (other, third), (third, one))]  # fmt: skip
        found[(np.max(sides, axis=0) <= 0.0) | (np.min(sides, axis=0) >= 0.0)] = paint
    return found
