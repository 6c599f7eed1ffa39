"""Vector drawings of a puppet as pictures: what they paint in which colour, and which bones move them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Color

from ..blender import mesh_data
from ..core import core
from ..drawing.painted import areas_of
from ..drawing.plane import Frame, transform, united, world_matrix
from ..errors import FloatArray, UserError
from ..files.pictures import image_on, is_gradient, pictures_in
from .imported import pixels_of
from .moving import Drawn

# An area, y pointing down, and its colour: red, green, blue and opacity, or these by their places.
Paint: TypeAlias = "tuple[core.Mesh, tuple[float, ...] | core.formats.Shades]"
# Colour of what has no material.
GREY = (0.8, 0.8, 0.8, 1.0)


def paints_of(context: Context, obj: Object, frame: Frame) -> list[Paint]:
    """What an object paints, material by material. Raises: UserError, also for a picture."""
    if image_on(obj) is not None:
        raise UserError(f"'{obj.name}' shows a picture: import the picture's layers as a painting, which has bones too")
    areas = areas_of(context, obj, frame, closed=True)
    materials = [slot.material for slot in obj.material_slots] or [None]
    slots = np.zeros(len(areas), int)
    if obj.type == "MESH" and len(materials) > 1:
        with mesh_data.evaluated_mesh(obj.evaluated_get(context.evaluated_depsgraph_get())) as mesh:
            if mesh is not None:
                mesh.calc_loop_triangles()
                numbers = mesh_data.stored(mesh.loop_triangles, "material_index", 1, np.int32).ravel()
                slots[: len(numbers)] = numbers
    found = []
    for slot, material in enumerate(materials):
        own = [area for area, number in zip(areas, slots.tolist(), strict=True) if number == slot]
        if own:
            loops = [loop * (1.0, -1.0) for loop in united(obj.name, own)]
            shades = _gradient(obj, slot, material, frame)
            found.append((core.Mesh.from_loops(loops), shades or _colour(material)))
    return found


def pictures_of(
    given: Drawn, shapes: Sequence[Sequence[Paint]], low: FloatArray, scale: float
) -> list[core.puppets.PicturePart]:
    """The picture of each part, from what it paints. low, scale: of `picture_of`."""
    found = []
    for part, paints in zip(given.parts, shapes, strict=True):
        pictures = [core.puppets.picture_of(part.name, (part.name,), [paint], low, scale) for paint in paints]
        found.append(core.puppets.painted_as_one([each for each in pictures if each is not None]))
    return found


def _gradient(obj: Object, slot: int, material: bpy.types.Material | None, frame: Frame) -> core.formats.Shades | None:
    """The colours of a gradient on the faces of a mesh with a material, as seen in a frame; None for one colour."""
    from scipy import ndimage

    image = next((node.image for node in pictures_in(material) if is_gradient(node.image)), None)
    if image is None or obj.type != "MESH":
        return None
    data = mesh_data.mesh_of(obj)
    uv = mesh_data.texture_places(data)
    if uv is None:
        return None
    faces = mesh_data.stored(data.polygons, "material_index", 1, np.int32).ravel()
    own = np.repeat(faces == slot, mesh_data.stored(data.polygons, "loop_total", 1, np.int32).ravel())
    corners = mesh_data.corner_vertices(data)[own]
    places = frame.from_world(transform(world_matrix(obj), mesh_data.points_of(data)))[0][corners] * (1.0, -1.0)
    affine = np.linalg.lstsq(np.column_stack([places, np.ones(len(places))]), uv[own])[0]
    pixels = pixels_of(image)[::-1] / 255.0
    size = np.array(pixels.shape[1::-1])

    def shades(points: FloatArray) -> FloatArray:
        there = ((points @ affine[:2] + affine[2]) * size - 0.5)[:, ::-1].T
        return np.stack([ndimage.map_coordinates(pixels[..., k], there, order=1, mode="nearest") for k in range(4)], 1)

    return shades


def _colour(material: bpy.types.Material | None) -> tuple[float, ...]:
    """The colour of a material in the view, in sRGB."""
    *shade, opacity = material.diffuse_color if material is not None else GREY
    return (*Color(shade).from_scene_linear_to_srgb()[:], float(opacity))
