"""A layered painting from a file as a puppet in the scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from .. import keys
from ..blender import display, mesh_data
from ..core import blamed, core
from ..drawing.plane import Frame, size
from ..errors import FloatArray
from ..files.importers import PIXEL
from ..files.pictures import image_of_pixels, pictures_in
from . import armatures, controls, weights
from .one_cage import skin

# Distance between two layers, as a fraction of the painting's size.
DEPTH = 1e-3
# Files that hold layers, those of the core's readers.
ENDINGS = (".psd", ".psb", ".ora", ".kra")


def painting_in(path: Path, names: Sequence[str] | None, *, hidden: bool) -> core.puppets.Painting:
    """The parts of a layered painting, and notes on what was left out. Raises: UserError.

    names: of the pictures of a folder that are read; all if None.
    """
    with blamed(f"'{path.name}' cannot be read"):
        return core.puppets.read_painting(path, names, hidden=hidden)


def jointed(path: Path, painting: core.puppets.Painting) -> core.puppets.GamePuppet:
    """The puppet of a painting. Raises: UserError."""
    with blamed(f"'{path.name}' cannot be read"):
        return core.puppets.game_puppet(painting.parts, painting.size, name=path.stem)


def pixels_of(image: bpy.types.Image) -> NDArray[np.uint8]:
    """(h, w, 4) pixels of an image, the top row first."""
    width, height = image.size
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)  # type: ignore[attr-defined]  # a number in the stubs
    found = np.round(255.0 * values.reshape(height, width, image.channels)[::-1]).astype(np.uint8)
    if image.channels == 4:
        return found
    whole = np.full((height, width, 4), 255, np.uint8)
    whole[..., : image.channels] = found
    return whole


def place(context: Context, puppet: core.puppets.GamePuppet, *, scale: float) -> list[Object]:
    """New objects on the floor, in a collection of their own, the armature last. Bones blend as in engines: without
    Preserve Volume.

    scale: metres per pixel, 0 for the default.
    """
    unit = scale or PIXEL
    home = bpy.data.collections.new(puppet.name)
    context.collection.children.link(home)
    rig = armatures.add_armature(context, home, Frame(np.eye(4), 0.0, 1.0, own=True), puppet.name)
    made = stage(context, home, rig, puppet, unit)
    points = np.concatenate([mesh.points for mesh in puppet.meshes]) * unit
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    rig.location = (-middle[0], -middle[1], 0.0)
    return made


def stage(
    context: Context, home: bpy.types.Collection, rig: Object, puppet: core.puppets.GamePuppet, unit: float
) -> list[Object]:
    """Draws the bones of a puppet into its armature, and gives it a mesh for each layer, each above the one before:
    what is there already goes on. Returns the meshes and the armature.

    unit: metres per pixel.
    """
    whole = puppet.puppet.scaled(unit)
    drawn = armatures.draw_bones(context, rig, Frame(np.eye(4), 0.0, 1.0, own=True), whole, whole.ranges)
    controls.add_controls(context, rig, drawn.figure, 0.0)
    named = zip(puppet.bones, drawn.bones, strict=True)
    puppet = replace(puppet, bones=tuple(replace(bone, name=there.name) for bone, there in named))
    there = {str(obj.get(keys.MADE, "")): obj for obj in rig.children}
    step = DEPTH * size(np.concatenate([mesh.points for mesh in puppet.meshes]) * unit)
    made = []
    for number, mesh in enumerate(puppet.meshes):
        obj = there.get(mesh.name)
        if obj is None:
            obj = bpy.data.objects.new(mesh.name, bpy.data.meshes.new(mesh.name))
            home.objects.link(obj)
            obj.parent = rig
            obj.hide_render = obj.hide_viewport = not mesh.is_visible
        obj.location.z = step * number
        _fill(obj, rig, puppet, mesh, unit)
        made.append(obj)
    keys.store(rig, {keys.CANVAS: [puppet.place.width, puppet.place.height, unit]})
    return [*made, rig]


def _fill(obj: Object, rig: Object, puppet: core.puppets.GamePuppet, mesh: core.puppets.PartMesh, unit: float) -> None:
    """Gives an object a mesh with its texture, and the weights of its bones. A mesh of that shape goes on."""
    texture, left, top = core.puppets.texture_of(mesh, puppet.place)
    old: Any = obj.data
    name, points = old.name, unit * mesh.points
    same = _has_shape(old, points, mesh.triangles)
    data = old if same else mesh_data.new_mesh(name, points, faces=mesh.triangles)
    places = (puppet.place.down(mesh.points) - (left, top)) / (texture.shape[1], texture.shape[0])
    _paint(data, mesh.name, texture, places * (1.0, -1.0) + (0.0, 1.0), next(iter(old.materials), None))
    if not same:
        obj.data = data
        bpy.data.meshes.remove(old)
        data.name = name
    obj.vertex_groups.clear()
    skin(obj, rig, puppet.bones, mesh.weights, keeps_volume=False)
    layer = {keys.LAYER: mesh.part, keys.BLEND: mesh.blend, keys.MADE: mesh.name}
    keys.store(obj, layer)
    weights.note_digest(obj)


def _has_shape(data: bpy.types.Mesh, points: FloatArray, triangles: NDArray[np.int64]) -> bool:
    """Whether a mesh has these points (n, 2), apart from its shape keys, and triangles (t, 3)."""
    if len(data.vertices) != len(points) or [tuple(face.vertices) for face in data.polygons] != list(
        map(tuple, triangles.tolist())
    ):
        return False
    blocks: Any = data.shape_keys.reference_key.data if data.shape_keys is not None else data.vertices
    return np.array_equal(mesh_data.stored(blocks, "co", 3)[:, :2], points.astype(np.float32))


def _paint(
    data: bpy.types.Mesh,
    name: str,
    texture: NDArray[np.uint8],
    places: FloatArray,
    material: bpy.types.Material | None,
) -> None:
    """Shows a texture on a mesh, without lighting, in a new material or in place of the texture of one.

    places: (n, 2) of its vertices, from 0 to 1.
    """
    image = image_of_pixels(name, texture[::-1] / np.float32(255.0))
    mesh_data.place_texture(data, places)
    shown = material or display.material(display.CUTOUT, name)
    for picture in pictures_in(shown):
        old, picture.image = picture.image, image
        if material is not None and old is not None and not old.users:
            bpy.data.images.remove(old)
            image.name = name
    if material is None or material not in data.materials[:]:
        data.materials.append(shown)
