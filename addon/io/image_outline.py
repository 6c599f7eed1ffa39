"""Collision outlines in the scene from the alpha channel of an image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core import core, memory, pictures, tasks
from ..errors import UserError
from ..generation.generate import STAGES
from ..generation.job import Progress, Work
from ..generation.memory import known
from ..scene import display, ownership, placement
from ..scene.selection import scene_of


@dataclass(frozen=True)
class Picture:
    """The opacity of an image: name and alpha (H, W), the top row first."""

    name: str
    alpha: NDArray[np.float32]

    @classmethod
    def of(cls, image: bpy.types.Image) -> Picture:
        """The opacity of a Blender image. Raises: UserError if it has none."""
        width, height = image.size
        if not width or not height:
            raise UserError(f"The image '{image.name}' has no pixels: its file may be missing")
        if image.channels not in (2, 4):
            raise UserError(f"The image '{image.name}' has no alpha channel: save it as RGBA, or choose another image")
        pixels = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)  # type: ignore[attr-defined]  # a number in the stubs
        return cls(image.name, pixels.reshape(height, width, image.channels)[::-1, :, -1])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width = self.alpha.shape
        return width, height

    def outline(self, vertices: int, *, tile: bool = False, **options: Any) -> Work[core.Mesh]:
        """A mesh around all opaque pixels, in pixels with y upwards from the bottom. Raises: UserError.

        tile: whether a picture that is opaque as a whole gets its own edge, without padding. options: padding,
        threshold and holes of ``picture_cages``.
        """
        if tile and bool((self.alpha > options["threshold"]).all()):
            width, height = self.size
            return core.Mesh.from_loops([[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]])
        key = memory.key_of("picture", self.alpha, vertices, tuple(sorted(options.items())))
        traced: core.Mesh | None = known().get(key)
        if traced is not None:
            return traced
        yield Progress(0.0, f"'{self.name}': tracing pixels")
        try:
            made = yield from tasks.mapped(
                pictures.picture_cages_run(self.alpha, [vertices], **options),
                lambda step: Progress(step.fraction, f"'{self.name}': {STAGES[step.stage]}"),
            )
            found = made.cages[0]
            traced = core.Mesh(found.vertices * (1.0, -1.0) + (0.0, self.size[1]), found.edges)
            known().put(key, traced, found.vertices.nbytes)
            return traced
        except core.NestedCagesError as error:
            raise UserError(f"'{self.name}': {error}") from error


def place(
    context: bpy.types.Context, picture: Picture, mesh: core.Mesh, target: bpy.types.Object | None = None
) -> bpy.types.Object:
    """A new object with the outline as a wire over the image, as shown by an image empty of size 1 or by `target`.

    The longer side of the picture is one unit, and its middle is the object's origin.
    """
    unit, offset = 1.0 / max(picture.size), (-0.5, -0.5)
    if target is not None:
        unit, offset = unit * target.empty_display_size, (target.empty_image_offset[0], target.empty_image_offset[1])
    points = (mesh.vertices + np.array(offset) * picture.size) * unit
    name = f"{picture.name} Outline"
    data = bpy.data.meshes.new(name)
    data.from_pydata(np.column_stack([points, np.zeros(len(points))]).tolist(), mesh.edges.tolist(), [])
    obj = bpy.data.objects.new(name, data)
    display.apply_display(obj, 1)
    (ownership.home_of(scene_of(context), target) if target is not None else context.collection).objects.link(obj)
    if target is not None:
        placement.stand_as(target, obj)
    return obj


def image_of(context: bpy.types.Context) -> bpy.types.Image | None:
    """The image of the active image empty, or of an image editor."""
    obj = context.view_layer.objects.active
    if obj is not None and obj.type == "EMPTY" and isinstance(obj.data, bpy.types.Image):
        return obj.data
    return getattr(context.space_data, "image", None)
