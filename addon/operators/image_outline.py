"""Outline of Image: a collision outline around the opaque pixels of an image."""

from __future__ import annotations

from typing import Any

import bpy

from ..errors import UserError
from ..generation.job import Work
from ..io import image_outline
from ..keys import found_object
from ..properties import picture
from ..properties.kinds import text, whole
from ..properties.picture import PictureProperties
from ..scene.selection import select
from .base import DialogJobOperator


class OBJECT_OT_nested_cages_from_image(DialogJobOperator, PictureProperties, bpy.types.Operator):
    """Make a collision outline of few vertices around all opaque pixels of an image"""

    bl_label = "Outline of Image"

    image: text("Image", "Image with an alpha channel; empty takes that of the active image empty")
    vertices: whole("Vertices", "Vertex count of the outline", default=16, min=3, soft_max=256)

    @classmethod
    def unavailable(cls, _context: bpy.types.Context) -> str:
        return "" if bpy.data.images else "Load an image with an alpha channel, or drag one into the 3D view"

    def ask(self, context: bpy.types.Context, _event: bpy.types.Event) -> Any:
        found = image_outline.image_of(context)
        if not self.image and found is not None:
            self.image = found.name
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        self.layout.prop_search(self, "image", bpy.data, "images")
        for name in ("vertices", *picture.NAMES):
            self.layout.prop(self, name)

    def work(self, context: bpy.types.Context) -> Work[None]:
        image = bpy.data.images.get(self.image) if self.image else image_outline.image_of(context)
        if image is None:
            raise UserError("Choose an image: none is named, and the active object is no image empty")
        active = context.view_layer.objects.active
        shows_it = active is not None and active.type == "EMPTY" and active.data == image
        shown, target = image_outline.Picture.of(image), active.session_uid if shows_it else None
        mesh = yield from shown.outline(self.vertices, **picture.values(self))
        obj = image_outline.place(context, shown, mesh, found_object(target))
        select(context, obj)
        self.report({"INFO"}, f"{len(mesh.vertices)} vertices around all opaque pixels of '{shown.name}'")
