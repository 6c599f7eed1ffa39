"""Outline of Image: a collision outline around the opaque pixels of an image."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty

from ..errors import UserError
from ..io import image_outline
from ..scene.selection import select

# Properties that the core takes by the same names.
OPTIONS = ("padding", "threshold", "holes")


class OBJECT_OT_nested_cages_from_image(bpy.types.Operator):
    """Wraps what is opaque in an image."""

    bl_idname = "object.nested_cages_from_image"
    bl_label = "Outline of Image"
    bl_description = "Make a collision outline of few vertices that leaves no opaque pixel of an image outside"
    bl_options = {"REGISTER", "UNDO"}

    image: StringProperty(  # type: ignore[valid-type]
        name="Image",
        description="Image with an alpha channel; empty takes that of the active image empty",
        default="",
    )
    vertices: IntProperty(  # type: ignore[valid-type]
        name="Vertices", description="Number of vertices of the outline", default=16, min=3, soft_max=256
    )
    padding: FloatProperty(  # type: ignore[valid-type]
        name="Padding",
        description="Distance in pixels that the outline keeps from opaque pixels",
        default=1.0,
        min=0.0,
        soft_max=32.0,
    )
    threshold: FloatProperty(  # type: ignore[valid-type]
        name="Threshold",
        description="Opacity above which a pixel counts as opaque",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    holes: BoolProperty(  # type: ignore[valid-type]
        name="Holes", description="Keep holes open instead of filling them", default=False
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to Object Mode")
            return False
        if not bpy.data.images:
            cls.poll_message_set("Load an image with an alpha channel, or drag one into the 3D view")
            return False
        return True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        found = image_outline.image_of(context)
        if not self.image and found is not None:
            self.image = found.name
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        self.layout.prop_search(self, "image", bpy.data, "images")
        for name in ("vertices", *OPTIONS):
            self.layout.prop(self, name)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            image = bpy.data.images.get(self.image) if self.image else image_outline.image_of(context)
            if image is None:
                raise UserError("Choose an image: none is named, and the active object is no image empty")
            mesh = image_outline.outline(image, self.vertices, **{name: getattr(self, name) for name in OPTIONS})
        except UserError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        active = context.view_layer.objects.active
        shows_it = active is not None and active.type == "EMPTY" and active.data == image
        obj = image_outline.place(context, image, mesh, active if shows_it else None)
        select(context, obj)
        self.report(
            {"INFO"},
            f"{len(mesh.vertices)} vertices around all opaque pixels of '{image.name}'",
        )
        return {"FINISHED"}


CLASSES = (OBJECT_OT_nested_cages_from_image,)
