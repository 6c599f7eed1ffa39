"""Pictures: cutouts as meshes that their cages move, outlines of images, and silhouettes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object
from bpy_extras.io_utils import ImportHelper

from ..animation.timeline import Timing
from ..binding import binding, handles
from ..errors import UserError, counted
from ..generation import output
from ..generation.generate import Generation, Options, Request, Result
from ..generation.job import Work
from ..generation.levels import lengths, parse_levels
from ..generation.methods import Methods
from ..io import pictures, silhouettes
from ..io.pictures import Canvas, Picture
from ..keys import found_object
from ..properties.kinds import choice, flag, length, number, text, whole
from ..properties.settings import filled, settings_of
from ..scene import grease_pencil, ownership
from ..scene.areas import paints
from ..scene.convert import Drawing, fine_drawing, read
from ..scene.filling import mesh_of
from ..scene.ownership import scene_of, select
from .base import DialogJobOperator, JobOperator
from .files import FilesOperator, paths_of


class PictureProperties:
    """Properties of operators on pictures: how to outline opaque pixels."""

    padding: number(
        "Padding",
        "Distance in pixels between the outline and opaque pixels; 0 if not set and all of the picture is opaque",
        default=1.0,
        min=0.0,
        soft_max=32.0,
    )
    threshold: number("Threshold", "Opacity above which a pixel counts as opaque", min=0.0, max=1.0, subtype="FACTOR")
    holes: flag("Holes", "Keep holes open instead of filling them")


# Their names, which are those of the core's options.
NAMES = tuple(PictureProperties.__annotations__)


def trace_options(owner: Any) -> dict[str, Any]:
    """The options for ``Picture.outline`` of an operator with these properties."""
    return {name: getattr(owner, name) for name in NAMES} | {"tile": not owner.properties.is_property_set("padding")}


@dataclass(frozen=True)
class Part:
    """A picture, where it lies, and the number of the object that shows it, if one does."""

    image: bpy.types.Image
    canvas: Canvas
    shown_by: int | None


class OBJECT_OT_nested_cages_cutout(FilesOperator, PictureProperties, ImportHelper, bpy.types.Operator):  # type: ignore[misc]
    """Cut out image files, or selected image planes and empties, as textured meshes that follow a cage; and the layers
    of Grease Pencil drawings
    """

    bl_label = "Cutout"
    exclusive = True
    shown_by = ("shading", "color_type", "MATERIAL", "TEXTURE")

    filepath: text(
        "File Path",
        "Picture with an alpha channel; empty takes the selected image planes and image empties",
        subtype="FILE_PATH",
        options={"SKIP_PRESET", "SKIP_SAVE"},
    )
    filter_image: flag("Images", "Show images", default=True, options={"HIDDEN", "SKIP_SAVE"})
    vertices: whole("Vertices", "Vertex count of the mesh's outline", default=64, min=3, soft_max=256)
    levels: text("Cages", "Vertices of each cage, innermost first, such as 16 or 32, 12", default="16")
    bind: flag("Bind", "Make the pictures follow their cages", default=True)
    handles: flag("Handles", "Add a bone per corner of each bound cage to move that corner", default=True)

    def ask(self, context: Context, event: bpy.types.Event) -> Any:
        selected = _shown_pictures(context) or _strokes(context)
        return super().ask(context, event) if selected else ImportHelper.invoke(self, context, event)

    def draw(self, _context: Context) -> None:
        self.draw_options("vertices", *NAMES, "levels", "bind", "handles")

    def work(self, context: Context) -> Work[None]:
        if not paths_of(self) and not _shown_pictures(context) and _strokes(context):
            yield from self._cut_layers(context, _strokes(context))
            return
        parts, settings = self._parts(context), settings_of(context)
        levels = parse_levels(self.levels, lengths(scene_of(context)))
        drawings: list[tuple[Part, Drawing]] = []
        problems: list[UserError] = []
        opaque: list[str] = []
        for part in parts:
            try:
                frame, shown = part.canvas.frame(), Picture.of(part.image)
                outline = yield from shown.trace(self.vertices, **trace_options(self))
                points = part.canvas.placed(np.asarray(outline.vertices) / shown.size)
                name = Path(part.image.name).stem or part.image.name
                drawing = Drawing(name, frame, tuple(points[loop] for loop in outline.loops))
                drawing.mesh()
            except UserError as error:
                problems.append(error)
                continue
            drawings.append((part, drawing))
            if (shown.alpha > self.threshold).all():
                opaque.append(part.image.name)
        if not drawings:
            raise problems[0]
        requests = [Request(drawing) for _, drawing in drawings]
        generation = Generation(requests, Options(levels=levels, methods=filled(Methods, settings)))
        yield from generation
        problems += generation.problems
        # Those that have a cage, in the same order.
        caged = {id(result.drawing) for result in generation.results}
        parts = [part for part, drawing in drawings if id(drawing) in caged]
        made: list[Object] = []
        try:
            for part, result in zip(parts, generation.results, strict=True):
                shown_by, drawing = found_object(part.shown_by), result.drawing
                data = pictures.textured_mesh(drawing.name, drawing.mesh(), part.canvas, part.image)
                made.append(pictures.place(context, drawing.name, data, drawing.frame, shown_by))
            context.view_layer.update()
            self._write(context, made, generation.results)
        except BaseException:
            for obj in made:
                mesh = mesh_of(obj)
                bpy.data.objects.remove(obj)
                bpy.data.meshes.remove(mesh)
            raise
        for part in parts:
            shown_by = found_object(part.shown_by)
            if shown_by is not None:
                shown_by.hide_set(True)
                shown_by.hide_render = True
        self.tell_skipped(problems, "picture")
        for name in opaque:
            self.report(
                {"WARNING"},
                f"'{name}' has no transparent pixels, so its outline is a rectangle: erase its background, or raise "
                "the threshold",
            )

    def _cut_layers(self, context: Context, drawn: Sequence[Object]) -> Work[None]:
        """Makes each layer that shows something an object of its own, in cages. Raises: UserError."""
        levels, methods = parse_levels(self.levels, lengths(scene_of(context))), filled(Methods, settings_of(context))
        made = [part for obj in drawn for part in grease_pencil.separated(context, obj)]
        try:
            context.view_layer.update()
            requests = [Request(fine_drawing(read(context, part))) for part in made]
            generation = Generation(requests, Options(levels=levels, methods=methods))
            yield from generation
            if generation.problems:
                raise generation.problems[0]
            self._write(context, made, generation.results)
        except BaseException:
            bpy.data.batch_remove([block for part in made for block in (part, part.data)])
            raise
        self.tell_hidden(context, drawn)
        for obj in drawn:
            obj.hide_set(True)
            obj.hide_render = True

    def _write(self, context: Context, made: Sequence[Object], results: Sequence[Result]) -> None:
        """Cages around the new objects, without animation, and bound."""
        placed = [
            replace(result, drawing=replace(result.drawing, identity=obj.session_uid))
            for obj, result in zip(made, results, strict=True)
        ]
        scene = scene_of(context)
        collections, _ = output.write(scene, placed, filled(Timing, settings_of(context)), still=True)
        context.view_layer.update()
        cages: list[Object] = []
        for collection in collections if self.bind else ():
            try:
                binding.bind(context, collection)
            except UserError as error:
                self.report({"WARNING"}, f"Not bound: {error}")
                continue
            cages.append(ownership.members(collection)[-1])
        rig = handles.add(context, cages) if self.handles and cages else None
        select(context, *(made if rig is None else [rig]))
        noun = "layer" if made[0].type == grease_pencil.KINDS[0] else "picture"
        how = "the vertices of the cage" if rig is None else "the bones"
        self.report({"INFO"}, f"{counted(len(made), noun)} cut out: move {how} to pose it")

    def _parts(self, context: Context) -> list[Part]:
        """The requested pictures. Raises: UserError."""
        if paths := paths_of(self):
            images = [pictures.load(path) for path in paths]
            places = pictures.side_by_side(list(map(pictures.size_of, images)))
            return [Part(image, place, None) for image, place in zip(images, places, strict=True)]
        shown = _shown_pictures(context)
        if not shown:
            raise UserError("Choose a picture file, or select image planes, image empties or Grease Pencil drawings")
        return [
            Part(image, pictures.canvas_of(obj, pictures.size_of(image)), obj.session_uid)
            for obj in shown
            if (image := pictures.image_on(obj)) is not None
        ]


def _shown_pictures(context: Context) -> list[Object]:
    """The selected objects that show a picture and are not cutouts, the active one first."""
    active = context.view_layer.objects.active
    shown = [obj for obj in context.selected_objects if pictures.image_on(obj) is not None]
    return sorted(shown, key=lambda obj: (obj is not active, obj.name))


def _strokes(context: Context) -> list[Object]:
    """The selected Grease Pencil drawings."""
    return [obj for obj in context.selected_objects if obj.type == grease_pencil.KINDS[0]]


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
