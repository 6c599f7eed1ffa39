"""New objects: silhouettes of what is selected, convex pieces of outlines, and cages as faces that play."""

from __future__ import annotations

import bpy
from bpy.types import Context, Object

from ..blender.jobs import Work
from ..blender.props import choice, flag, whole
from ..cage_sets.selection import select, sets_of_chosen
from ..drawing.painted import paints
from ..errors import UserError, counted
from ..files import exporters, silhouettes
from ..keys import found_object
from .base import GapProperty, JobOperator
from .files import has_outlines, outlines

SILHOUETTE, PIECES, ANIMATED = "SILHOUETTE", "PIECES", "ANIMATED"
SHAPE_ITEMS = (
    (SILHOUETTE, "Silhouette", "One flat outline of all that is selected, across overlaps and depths, solids too"),
    (PIECES, "Convex Pieces", "Convex polygons of few vertices that tile cages, or the coarsest of a drawing"),
    (ANIMATED, "Animated Faces", "Triangles that play the steps of cages, for Alembic, which drops loose edges"),
)
PLANE_ITEMS = (
    ("ACTIVE", "Active Object", "The plane that the active object lies in"),
    ("VIEW", "View", "As the 3D view shows it"),
    ("TOP", "Top", "The x and y axes of the world"),
    ("FRONT", "Front", "The x and z axes of the world"),
    ("RIGHT", "Right", "The y and z axes of the world"),
)


class OBJECT_OT_nested_cages_to_objects(JobOperator, GapProperty, bpy.types.Operator):
    """Make new objects from what is selected: one silhouette of everything, convex pieces of outlines as they are on
    this frame, or cages as faces that play their animation
    """

    bl_label = "Outlines to Objects"

    shape: choice("Shape", "What to make", SHAPE_ITEMS)
    plane: choice("Plane", "Plane to project a silhouette onto", PLANE_ITEMS, default="ACTIVE")
    fill_holes: flag("Fill Holes", "Leave holes of a silhouette out")
    pieces: whole("Vertices", "Maximum number of vertices of a piece; Box2D takes 8", default=8, min=3, soft_max=32)

    needs = staticmethod(lambda context: has_outlines(context) or any(map(paints, context.selected_objects)))
    missing = "Select cages, or meshes, curves, texts or Grease Pencil drawings"

    def draw(self, _context: Context) -> None:
        self.layout.use_property_split = True
        shown = {SILHOUETTE: ("plane", "fill_holes", "gap"), PIECES: ("pieces",)}
        for name in ("shape", *shown.get(self.shape, ())):
            self.layout.prop(self, name)

    def work(self, context: Context) -> Work[None]:
        if self.shape == SILHOUETTE:
            yield from self._silhouette(context)
        elif self.shape == ANIMATED:
            select(context, *exporters.make_animated(_known(outlines(context))))
        else:
            made = exporters.make_pieces(context, _known(coarsest(context)), self.pieces)
            select(context, *made)
            self.report({"INFO"}, f"{counted(len(made), 'convex piece')} of at most {self.pieces} vertices")

    def _silhouette(self, context: Context) -> Work[None]:
        """One outline of all selected objects."""
        painting = [obj for obj in context.selected_objects if paints(obj)]
        if not painting:
            raise UserError(self.missing)
        active = context.view_layer.objects.active
        objects = sorted(painting, key=lambda obj: (obj is not active, obj.name))
        frame = silhouettes.plane_of(context, objects[0], self.plane)
        self.tell_hidden(context, objects)
        identities = [obj.session_uid for obj in objects]
        work = silhouettes.painted_loops(context, objects, frame, fill_holes=self.fill_holes, gap=self.gap)
        loops, problems = yield from work
        parts = [part for each in identities if (part := found_object(each)) is not None]
        if not parts or parts[0].session_uid != identities[0]:
            raise UserError("The active object was deleted meanwhile, so its silhouette was discarded")
        made = silhouettes.place_silhouette(context, parts[0], frame, loops, parts)
        select(context, made)
        self.tell_skipped(problems, "object")
        self.report({"INFO"}, f"'{made.name}': {sum(map(len, loops))} vertices in {counted(len(loops), 'loop')}")


def coarsest(context: Context) -> list[Object]:
    """Of the selected outlines, the coarsest cage of each drawing, and others."""
    outlined, selected = outlines(context), context.selected_objects
    sets = [[obj for obj in each.members if obj in outlined] for each in sets_of_chosen(context)]
    finer = {obj for objects in sets for obj in objects[:-1] if obj not in selected}
    return [obj for obj in outlined if obj not in finer]


def _known(outlined: list[Object]) -> list[Object]:
    """The outlines. Raises: UserError if there are none."""
    if not outlined:
        raise UserError("Select cages, or other objects with a closed outline")
    return outlined
