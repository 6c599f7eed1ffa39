"""Outlines of images, and silhouettes."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.types import Context

from ..errors import UserError, counted
from ..generation.job import Work
from ..io import pictures, silhouettes
from ..io.pictures import Picture
from ..keys import found_object
from ..properties.kinds import choice, flag, length, number, text, whole
from ..scene.areas import paints
from ..scene.ownership import select
from .base import DialogJobOperator, JobOperator


class PictureProperties:
    """Properties of operators on pictures: how to outline opaque pixels."""

    padding: number(
        "Padding",
        "Distance in pixels between the outline and opaque pixels; 0 if not set and all of the picture is opaque",
        default=1.0,
        min=0.0,
        soft_max=32.0,
    )
    threshold: number(
        "Threshold", "Opacity above which a pixel counts as opaque", default=0.5, min=0.0, max=1.0, subtype="FACTOR"
    )
    holes: flag("Holes", "Keep holes open instead of filling them")


# Their names, which are those of the core's options.
NAMES = tuple(PictureProperties.__annotations__)


def trace_options(owner: Any) -> dict[str, Any]:
    """The options for ``Picture.outline`` of an operator with these properties."""
    return {name: getattr(owner, name) for name in NAMES} | {"tile": not owner.properties.is_property_set("padding")}


class OBJECT_OT_nested_cages_from_image(DialogJobOperator, PictureProperties, bpy.types.Operator):
    """Make a collision outline of few vertices around all opaque pixels of an image"""

    bl_label = "Outline of Image"

    image: text("Image", "Image with an alpha channel; empty takes that of the active image empty")
    vertices: whole("Vertices", "Vertex count of the outline", default=16, min=3, soft_max=256)

    needs = staticmethod(lambda _context: bpy.data.images)
    missing = "Load an image with an alpha channel, or drag one into the 3D view"

    def prepare(self, context: Context) -> None:
        image = pictures.image_of(context)
        if not self.image and image is not None:
            self.image = image.name

    def draw(self, _context: Context) -> None:
        self.layout.use_property_split = True
        self.layout.prop_search(self, "image", bpy.data, "images")
        self.draw_options("vertices", *NAMES)

    def work(self, context: Context) -> Work[None]:
        image = bpy.data.images.get(self.image) if self.image else pictures.image_of(context)
        if image is None:
            raise UserError("Choose an image: none is named, and the active object is no image empty")
        active = context.view_layer.objects.active
        shows_it = active is not None and active.type == "EMPTY" and active.data == image
        shown, target = Picture.of(image), active.session_uid if shows_it else None
        mesh = yield from shown.trace(self.vertices, **trace_options(self))
        obj = pictures.place_outline(context, shown, mesh, found_object(target))
        select(context, obj)
        self.report({"INFO"}, f"{len(mesh.vertices)} vertices around all opaque pixels of '{shown.name}'")


PLANE_ITEMS = (
    ("ACTIVE", "Active Object", "The plane that the active object lies in"),
    ("VIEW", "View", "As the 3D view shows it"),
    ("TOP", "Top", "The x and y axes of the world"),
    ("FRONT", "Front", "The x and z axes of the world"),
    ("RIGHT", "Right", "The y and z axes of the world"),
)


class OBJECT_OT_nested_cages_silhouette(JobOperator, bpy.types.Operator):
    """Unite the selected objects, layers and strokes into one flat outline, also across overlaps and depths"""

    bl_label = "Silhouette"

    plane: choice("Plane", "Plane to project onto", PLANE_ITEMS, default="ACTIVE")
    strokes: flag(
        "Stroke Width",
        "Include the width of Grease Pencil strokes; otherwise closed strokes are areas and open ones are left out",
        default=True,
    )
    fill_holes: flag("Fill Holes", "Leave holes out")
    gap: length("Join Gaps", "Join parts that are closer than this")

    needs = staticmethod(lambda context: any(map(paints, context.selected_objects)))
    missing = "Select meshes, curves, texts or Grease Pencil drawings"

    def work(self, context: Context) -> Work[None]:
        chosen = [obj for obj in context.selected_objects if paints(obj)]
        active = context.view_layer.objects.active
        objects = sorted(chosen, key=lambda obj: (obj is not active, obj.name))
        frame = silhouettes.plane_of(context, objects[0], self.plane)
        options: Any = {"strokes": self.strokes, "fill_holes": self.fill_holes, "gap": self.gap}
        self.tell_hidden(context, objects)
        identities = [obj.session_uid for obj in objects]
        loops, problems = yield from silhouettes.painted_loops(context, objects, frame, **options)
        parts = [part for each in identities if (part := found_object(each)) is not None]
        if not parts or parts[0].session_uid != identities[0]:
            raise UserError("The active object was deleted meanwhile, so its silhouette was discarded")
        made = silhouettes.place_silhouette(context, parts[0], frame, loops, parts)
        select(context, made)
        self.tell_skipped(problems, "object")
        self.report({"INFO"}, f"'{made.name}': {sum(map(len, loops))} vertices in {counted(len(loops), 'loop')}")
