"""Silhouette: selected objects and layers as one filled outline."""

from __future__ import annotations

import bpy

from ..errors import UserError, counted
from ..generation.job import Work
from ..io import silhouette
from ..keys import found_object
from ..properties.kinds import choice, flag, length
from ..scene.areas import paints
from ..scene.selection import select
from .base import JobOperator

PLANE_ITEMS = (
    ("ACTIVE", "Active Object", "The plane that the active object lies in"),
    ("VIEW", "View", "As the 3D view shows it"),
    ("TOP", "Top", "The x and y axes of the world"),
    ("FRONT", "Front", "The x and z axes of the world"),
    ("RIGHT", "Right", "The y and z axes of the world"),
)


class OBJECT_OT_nested_cages_silhouette(JobOperator, bpy.types.Operator):
    """Unite the selected objects, layers and strokes into one flat outline, even if they overlap or lie at different
    depths
    """

    bl_label = "Silhouette"

    plane: choice("Plane", "Plane to project onto", PLANE_ITEMS, default="ACTIVE")
    strokes: flag(
        "Stroke Width",
        "Include the width of Grease Pencil strokes; otherwise closed strokes are areas and open ones are left out",
        default=True,
    )
    fill_holes: flag("Fill Holes", "Leave holes out")
    gap: length("Join Gaps", "Join parts that are closer than this")

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        if any(map(paints, context.selected_objects)):
            return ""
        return "Select meshes, curves, texts or Grease Pencil drawings"

    def work(self, context: bpy.types.Context) -> Work[None]:
        chosen = [obj for obj in context.selected_objects if paints(obj)]
        active = context.view_layer.objects.active
        objects = sorted(chosen, key=lambda obj: (obj is not active, obj.name))
        frame = silhouette.plane_of(context, objects[0], self.plane)
        options = silhouette.Options(strokes=self.strokes, fill_holes=self.fill_holes, gap=self.gap)
        identities = [obj.session_uid for obj in objects]
        loops, problems = yield from silhouette.outline(context, objects, frame, options)
        parts = [part for each in identities if (part := found_object(each)) is not None]
        if not parts or parts[0].session_uid != identities[0]:
            raise UserError("The active object was deleted meanwhile, so its silhouette was discarded")
        made = silhouette.place(context, parts[0], frame, loops, parts)
        select(context, made)
        self.tell_skipped(problems, "object")
        self.report({"INFO"}, f"'{made.name}': {sum(map(len, loops))} vertices in {counted(len(loops), 'loop')}")
