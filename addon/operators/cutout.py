"""Cutout: pictures, and layers of Grease Pencil, as objects that cages move."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object
from bpy_extras.io_utils import ImportHelper

from ..animation.timeline import Timing
from ..bind import bind, handles
from ..blender.blocks import removed_on_failure
from ..blender.jobs import Work
from ..blender.props import choice, flag, text
from ..blender.views import FLAT_LIGHT, TEXTURES
from ..cage_sets.selection import scene_of, select
from ..drawing import grease_pencil
from ..drawing.planar import Drawing, fine_drawing, read
from ..errors import UserError, counted
from ..files import pictures
from ..files.pictures import Canvas, Picture
from ..generate import output
from ..generate.levels import lengths, parse_levels
from ..generate.methods import Methods
from ..generate.run import Generation, Options, Request, Result
from ..generate.settings import filled, settings_of
from ..keys import found_object
from ..puppets import one_cage
from .base import pose
from .files import FilesOperator, paths_of
from .pictures import NAMES, PictureProperties, trace_options

HANDLES, CAGES, SKELETON, NOTHING = "HANDLES", "CAGES", "SKELETON", "NOTHING"
MOVER_ITEMS = (
    (HANDLES, "Handles", "A cage for each picture, with a bone per vertex"),
    (CAGES, "Cages", "A cage for each picture, whose vertices are moved"),
    (SKELETON, "Skeleton", "One cage around all, with bones along its limbs"),
    (NOTHING, "Nothing", "A cage for each picture that it does not follow yet"),
)


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
    shown_by = (TEXTURES, FLAT_LIGHT)

    filter_image: flag("Images", "Show images", default=True, options={"HIDDEN", "SKIP_SAVE"})
    levels: text("Cages", "Vertices of each cage, innermost first, such as 16 or 32, 12", default="16")
    moved_by: choice("Moved By", "What moves the pictures", MOVER_ITEMS)

    def ask(self, context: Context, event: bpy.types.Event) -> Any:
        selected = _shown_pictures(context) or _strokes(context)
        return super().ask(context, event) if selected else ImportHelper.invoke(self, context, event)

    def draw(self, _context: Context) -> None:
        levels = () if self.moved_by == SKELETON else ("levels",)
        self.draw_options(*NAMES, "standard", "moved_by", *levels)

    def work(self, context: Context) -> Work[None]:
        with removed_on_failure():
            if not paths_of(self) and not _shown_pictures(context) and _strokes(context):
                yield from self._cut_layers(context, _strokes(context))
            else:
                yield from self._cut_pictures(context)
        self.show_colours(context)

    def _cut_pictures(self, context: Context) -> Work[None]:
        """Makes each picture a mesh, in cages. Raises: UserError."""
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
        results: list[Result] = []
        if self.moved_by != SKELETON:
            requests = [Request(drawing) for _, drawing in drawings]
            generation = Generation(requests, Options(levels=levels, methods=filled(Methods, settings)))
            yield from generation
            problems, results = problems + generation.problems, generation.results
            # Those that have a cage, in the same order.
            caged = {id(result.drawing) for result in results}
            drawings = [(part, drawing) for part, drawing in drawings if id(drawing) in caged]
        made: list[Object] = []
        for part, drawing in drawings:
            data = pictures.textured_mesh(drawing.name, drawing.mesh(), part.canvas, part.image)
            made.append(pictures.place(context, drawing.name, data, drawing.frame, found_object(part.shown_by)))
        context.view_layer.update()
        yield from self._rig(context, made, results)
        self.framed = tuple(made) if paths_of(self) else ()
        _hide([found_object(part.shown_by) for part, _ in drawings])
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
        context.view_layer.update()
        results: list[Result] = []
        if self.moved_by != SKELETON:
            requests = [Request(fine_drawing(read(context, part))) for part in made]
            generation = Generation(requests, Options(levels=levels, methods=methods))
            yield from generation
            if generation.problems:
                raise generation.problems[0]
            results = generation.results
        yield from self._rig(context, made, results)
        self.tell_hidden(context, drawn)
        _hide(drawn)

    def _rig(self, context: Context, made: list[Object], results: Sequence[Result]) -> Work[None]:
        """One cage around all new objects, moved by bones along their limbs; or the cages of these results."""
        noun = "layer" if made[0].type == grease_pencil.KINDS[0] else "picture"
        if self.moved_by != SKELETON:
            self._write(context, made, results, noun)
            return
        count = len(made)
        whole, problems = yield from one_cage.united_drawing(context, made, 0.0)
        armature, bones = one_cage.add_skeleton(context, whole)
        made.append(armature)
        yield from one_cage.make(context, whole, armature, 0)
        pose(context, armature)
        self.tell_skipped(problems, noun)
        self.report({"INFO"}, f"{counted(count, noun)} cut out: turn {counted(bones, 'bone')} to pose it")

    def _write(self, context: Context, made: Sequence[Object], results: Sequence[Result], noun: str) -> None:
        """Cages around the new objects, without animation, and bound."""
        placed = [
            replace(result, drawing=replace(result.drawing, identity=obj.session_uid))
            for obj, result in zip(made, results, strict=True)
        ]
        scene = scene_of(context)
        sets, _ = output.write(scene, placed, filled(Timing, settings_of(context)), still=True)
        context.view_layer.update()
        cages: list[Object] = []
        for cage_set in sets if self.moved_by != NOTHING else ():
            try:
                bind.bind(context, cage_set)
            except UserError as error:
                self.report({"WARNING"}, f"Not bound: {error}")
                continue
            cages.append(cage_set.cages[-1])
        rig = handles.add(context, cages) if self.moved_by == HANDLES and cages else None
        if rig is None:
            select(context, *made)
        else:
            pose(context, rig)
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


def _hide(objects: Iterable[Object | None]) -> None:
    """Hides what new objects show instead."""
    for obj in objects:
        if obj is not None:
            obj.hide_set(True)
            obj.hide_render = True


def _shown_pictures(context: Context) -> list[Object]:
    """The selected objects that show a picture and are not cutouts, the active one first."""
    active = context.view_layer.objects.active
    shown = [obj for obj in context.selected_objects if pictures.image_on(obj) is not None]
    return sorted(shown, key=lambda obj: (obj is not active, obj.name))


def _strokes(context: Context) -> list[Object]:
    """The selected Grease Pencil drawings."""
    return [obj for obj in context.selected_objects if obj.type == grease_pencil.KINDS[0]]
