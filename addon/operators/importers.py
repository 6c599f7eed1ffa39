"""Drawings from files."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import EnumProperty, FloatProperty, StringProperty

from ..errors import UserError, counted
from ..io import importers
from ..scene.selection import select

Y_ITEMS = (
    ("AUTO", "As Usual", "Down in SVG and collision outlines, up in maps"),
    ("DOWN", "Down", "The file counts y downwards, as pictures do"),
    ("UP", "Up", "The file counts y upwards, as maps do"),
)


class OBJECT_OT_nested_cages_import(bpy.types.Operator):
    """Reads outlines from a file."""

    bl_idname = "object.nested_cages_import"
    bl_label = "Import Outlines"
    bl_description = (
        "Read drawings to be caged: the filled area of an SVG, overlaps united, each feature of a GeoJSON, "
        "or a collision outline"
    )
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(  # type: ignore[valid-type]
        name="File", description="The file to read", subtype="FILE_PATH", default=""
    )
    filter_glob: StringProperty(  # type: ignore[valid-type]
        name="Filter", description="Files that are shown", default="*.svg;*.geojson;*.json", options={"HIDDEN"}
    )
    y: EnumProperty(  # type: ignore[valid-type]
        name="Y", description="Where y points in the file", items=Y_ITEMS, default="AUTO"
    )
    scale: FloatProperty(  # type: ignore[valid-type]
        name="Scale", description="Length in Blender of one unit of the file", default=0.01, min=1e-9, soft_max=100.0
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to Object Mode")
            return False
        return True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            if not self.filepath:
                raise UserError("Name the file to read")
            shapes = importers.shapes_in(Path(bpy.path.abspath(self.filepath)))
            y_down = {"AUTO": None, "DOWN": True, "UP": False}[self.y]
            made = importers.place(
                context,
                shapes,
                y_down=y_down,
                scale=self.scale,
            )
        except UserError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        select(context, *made)
        count = sum(len(obj.data.vertices) for obj in made)
        self.report({"INFO"}, f"{counted(len(made), 'outline')}, {count} vertices")
        return {"FINISHED"}


CLASSES = (OBJECT_OT_nested_cages_import,)
