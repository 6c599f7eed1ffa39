"""The alpha channel of an image to collision outlines in the scene."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core import core
from ..errors import UserError
from ..scene import display, ownership


def alpha_of(image: bpy.types.Image) -> NDArray[np.float32]:
    """Opacity (H, W) of an image, the top row first. Raises: UserError if there is none."""
    width, height = image.size
    if not width or not height:
        raise UserError(f"The image '{image.name}' has no pixels: its file may be missing")
    if image.channels not in (2, 4):
        raise UserError(f"The image '{image.name}' has no alpha channel: save it as RGBA, or choose another image")
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, image.channels)[::-1, :, -1]


def outline(image: bpy.types.Image, vertices: int, **options: Any) -> Any:
    """The core's ``Mesh`` around all opaque pixels, in pixels with y upwards from the bottom. Raises: UserError.

    options: padding, threshold and holes of ``pictures.collision_outline``.
    """
    try:
        found = core.collision_outline(alpha_of(image), vertices, **options)
        points = found.vertices * (1.0, -1.0) + (0.0, image.size[1])
        return core.Mesh(points, found.edges)
    except core.NestedCagesError as error:
        raise UserError(f"'{image.name}': {error}") from error


def place(
    context: bpy.types.Context, image: bpy.types.Image, mesh: Any, target: bpy.types.Object | None = None
) -> bpy.types.Object:
    """A new object with the outline, a wire over the image as an image empty of size 1 shows it, or as `target` does.

    The longer side of the picture is one unit, and its middle is the object's origin.
    """
    width, height = image.size
    unit, offset = 1.0 / max(width, height), (-0.5, -0.5)
    if target is not None:
        unit, offset = unit * target.empty_display_size, tuple(target.empty_image_offset)
    points = (mesh.vertices + np.array(offset) * (width, height)) * unit
    name = f"{image.name} Outline"
    data = bpy.data.meshes.new(name)
    data.from_pydata(np.column_stack([points, np.zeros(len(points))]).tolist(), mesh.edges.tolist(), [])
    obj = bpy.data.objects.new(name, data)
    display.apply_display(obj, 1)
    (target.users_collection[0] if target is not None else context.collection).objects.link(obj)
    if target is not None:
        if target.parent is None and not target.constraints:
            ownership.copy_transform(target, obj)
        else:
            obj.matrix_world = target.matrix_world
    return obj


def image_of(context: bpy.types.Context) -> bpy.types.Image | None:
    """The image that the user works with: of the active image empty, or in an image editor."""
    obj = context.view_layer.objects.active
    if obj is not None and obj.type == "EMPTY" and obj.empty_display_type == "IMAGE":
        return obj.data
    return getattr(context.space_data, "image", None)
