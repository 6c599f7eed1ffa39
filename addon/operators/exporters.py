"""Cages as other objects and as files."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty

from .. import keys
from ..errors import UserError, counted
from ..io import exporters
from ..scene import convert, ownership
from ..scene.selection import select

SHAPE_ITEMS = (
    ("CURVE", "Curves", "Filled 2D curves"),
    ("FILLED", "Faces", "Meshes of triangles, with holes open"),
    ("PRISM", "Prisms", "Closed meshes of some height"),
    ("ANIMATED", "Animated Faces", "Meshes of triangles that play the steps, for Alembic, which drops lone edges"),
)
FILE_ITEMS = (
    ("SVG", "SVG", "One path per outline, holes cut out"),
    ("GEOJSON", "GeoJSON", "One feature per outline, for maps and shapely"),
    ("ENGINE", "Collision Outline", "Polygons with holes of the outermost outline as JSON for game engines"),
)
SUFFIXES = {"SVG": ".svg", "GEOJSON": ".geojson", "ENGINE": ".json"}


class OnOutlines:
    """What both operators share: they work on what is selected, as it is on this frame."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to Object Mode")
            return False
        if not chosen(context):
            cls.poll_message_set("Select cages, or other objects with a closed outline")
            return False
        return True


class OBJECT_OT_nested_cages_to_objects(OnOutlines, bpy.types.Operator):
    """Makes curves, faces or prisms of cages."""

    bl_idname = "object.nested_cages_to_objects"
    bl_label = "Cages to Objects"
    bl_description = "Make new objects of the selected cages: as on this frame, or as faces that play the animation"
    bl_options = {"REGISTER", "UNDO"}

    shape: EnumProperty(  # type: ignore[valid-type]
        name="Shape", description="What becomes of each outline", items=SHAPE_ITEMS, default="FILLED"
    )
    height: FloatProperty(  # type: ignore[valid-type]
        name="Height",
        description="Height of prisms; 0 takes a fifth of the outline's size",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
        unit="LENGTH",
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            objects = chosen(context)
            if self.shape == "ANIMATED":
                made = exporters.make_animated(objects)
            else:
                made = exporters.make(context, objects, self.shape, self.height)
        except UserError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        select(context, *made)
        return {"FINISHED"}


class OBJECT_OT_nested_cages_export(OnOutlines, bpy.types.Operator):
    """Writes outlines to a file."""

    bl_idname = "object.nested_cages_export"
    bl_label = "Export Cages"
    bl_description = (
        "Write the selected outlines, or a drawing with all of its cages, as they are on this frame, to a file"
    )
    bl_options = {"REGISTER"}

    filepath: StringProperty(  # type: ignore[valid-type]
        name="File", description="The file to write", subtype="FILE_PATH", default=""
    )
    kind: EnumProperty(  # type: ignore[valid-type]
        name="Format", description="Kind of the file", items=FILE_ITEMS, default="SVG"
    )
    flip_y: BoolProperty(  # type: ignore[valid-type]
        name="Y Down", description="Let y point down, as in pictures, SVG and most 2D engines", default=True
    )
    world: BoolProperty(  # type: ignore[valid-type]
        name="World",
        description="Write coordinates of the world, seen from the top, front or right, not those of the first object",
        default=False,
    )
    scale: FloatProperty(  # type: ignore[valid-type]
        name="Scale",
        description="Units in the file for one unit of the scene, such as pixels per metre",
        default=1.0,
        min=1e-9,
        soft_max=1000.0,
    )
    triangles: BoolProperty(  # type: ignore[valid-type]
        name="Triangles",
        description="Add triangles to a collision outline, for engines whose pieces must be convex",
        default=False,
    )
    check_existing: BoolProperty(  # type: ignore[valid-type]
        name="Check Existing", description="Ask before a file is overwritten", default=True, options={"HIDDEN"}
    )

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        if not self.filepath:
            name = bpy.path.clean_name(chosen(context)[0].name)
            self.filepath = str(Path(bpy.data.filepath).parent / (name + SUFFIXES[self.kind]))
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def check(self, _context: bpy.types.Context) -> bool:
        """Gives the file the ending of its kind."""
        path = Path(self.filepath)
        if path.suffix in SUFFIXES.values() and path.suffix != SUFFIXES[self.kind]:
            self.filepath = str(path.with_suffix(SUFFIXES[self.kind]))
            return True
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            if not self.filepath:
                raise UserError("Name the file to write")
            path = Path(bpy.path.abspath(self.filepath))
            shapes = exporters.meshes(context, chosen(context), world=self.world, scale=self.scale)
            count = exporters.write(path, self.kind, shapes, flip_y=self.flip_y, triangles=self.triangles)
        except UserError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{counted(count, 'outline')} written to {path.name}")
        return {"FINISHED"}


def chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The selected outlines from the inside out; of a single drawing that has cages, the drawing and all of these."""
    selected = [obj for obj in context.selected_objects if convert.readable(obj)]
    if len(selected) == 1 and not selected[0].get(keys.LEVEL):
        collection = ownership.collection_about(context.scene, selected[0])
        if collection is not None:
            return ownership.members(collection)
    return sorted(selected, key=lambda obj: (obj.get(keys.LEVEL, 0), obj.name))


CLASSES = (OBJECT_OT_nested_cages_to_objects, OBJECT_OT_nested_cages_export)
