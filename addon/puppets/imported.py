"""A layered painting from a file as a puppet in the scene."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import bpy
import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from .. import keys
from ..characters import skin
from ..core import blamed, core, game, layers
from ..errors import FloatArray
from ..scene import display, filling
from ..scene.plane import Frame, size
from . import armatures, controls

# Metres per pixel, as of other drawings.
PIXEL = 0.01
# Distance between two layers, as a fraction of the painting's size.
DEPTH = 1e-3
# Files that hold layers, those of the core's readers.
ENDINGS = (".psd", ".psb", ".ora", ".kra")


class Painted(NamedTuple):
    """The puppet of a painting, in pixels, and its textured meshes."""

    puppet: core.puppet.Puppet
    meshed: game.GamePuppet


def read(path: Path, *, hidden: bool) -> tuple[Painted, tuple[str, ...]]:
    """The puppet of a layered painting, and notes on what was left out. Raises: UserError."""
    with blamed(f"'{path.name}' cannot be read"):
        picture = layers.read_layers(path, decode=decoded)
        parts, notes = layers.parts_of(picture, hidden=hidden)
        puppet, meshed = game.painted_puppet(parts, (picture.width, picture.height), name=path.stem)
    return Painted(puppet, meshed), (*notes, *meshed.notes)


def decoded(data: bytes) -> NDArray[np.uint8]:
    """(h, w, 4) pixels of a PNG, which Blender reads."""
    image = bpy.data.images.new("Layer", 1, 1)
    try:
        image.pack(data=data, data_len=len(data))
        image.source = "FILE"
        return pixels_of(image)
    finally:
        bpy.data.images.remove(image)


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


def place(context: Context, painted: Painted, *, scale: float, is_upright: bool, is_centred: bool) -> list[Object]:
    """New objects in a collection of their own, the armature last. Bones blend as in engines: without Preserve Volume.

    scale: metres per pixel, 0 for the default.
    """
    unit, puppet = scale or PIXEL, painted.meshed
    home = bpy.data.collections.new(puppet.name)
    context.collection.children.link(home)
    floor = Frame(np.eye(4), 0.0, 1.0, own=True)
    rig = armatures.add_armature(context, home, floor, puppet.name)
    whole = replace(painted.puppet.scaled(unit), ranges=puppet.ranges)
    armatures.draw_bones(context, rig, floor, whole, whole.ranges)
    controls.add_controls(context, rig, whole.figure, 0.0)
    keys.store(rig, {keys.CANVAS: [puppet.place.width, puppet.place.height, unit]})
    points = np.concatenate([mesh.points for mesh in puppet.meshes]) * unit
    step = DEPTH * size(points)
    made = [_mesh_object(home, rig, puppet, mesh, unit, step * number) for number, mesh in enumerate(puppet.meshes)]
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0)) if is_centred else np.zeros(2)
    rig.location = (-middle[0], 0.0, -middle[1]) if is_upright else (-middle[0], -middle[1], 0.0)
    rig.rotation_euler.x = np.pi / 2.0 if is_upright else 0.0
    return [*made, rig]


def _mesh_object(
    home: bpy.types.Collection, rig: Object, puppet: game.GamePuppet, mesh: game.PartMesh, unit: float, height: float
) -> Object:
    """A mesh with its texture, and the weights of its bones."""
    texture, left, top = game.texture_of(mesh, puppet.place)
    data = filling.new_mesh(mesh.name, unit * mesh.points, faces=mesh.triangles)
    obj = bpy.data.objects.new(mesh.name, data)
    home.objects.link(obj)
    obj.location.z = height
    obj.parent = rig
    places = (puppet.place.down(mesh.points) - (left, top)) / (texture.shape[1], texture.shape[0])
    _paint(data, mesh.name, texture, places * (1.0, -1.0) + (0.0, 1.0))
    skin(obj, rig, puppet.bones, mesh.weights, keeps_volume=False)
    obj.hide_render = obj.hide_viewport = not mesh.is_visible
    keys.store(obj, {keys.LAYER: mesh.part, keys.LAYER_ID: mesh.identity, keys.BLEND: mesh.blend})
    return obj


def _paint(data: bpy.types.Mesh, name: str, texture: NDArray[np.uint8], places: FloatArray) -> None:
    """Shows a texture on a mesh, without lighting; places: (n, 2) of its vertices, from 0 to 1."""
    height, width = texture.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=True)
    image.pixels.foreach_set((texture[::-1] / np.float32(255.0)).astype(np.float32).ravel())  # type: ignore[attr-defined]
    image.update()
    image.pack()
    layer = data.uv_layers.new(name="UVMap")
    used = filling.stored(data.loops, "vertex_index", 1, np.int32).ravel()
    layer.data.foreach_set("uv", places[used].astype(np.float32).ravel())
    material = display.material(display.CUTOUT, name)
    picture: Any = material.node_tree.nodes["Image Texture"]
    picture.image = image
    data.materials.append(material)
