"""Cutout: pictures, and layers of Grease Pencil, as objects that cages move."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
from bpy.types import Context, Object
from bpy_extras.io_utils import ImportHelper

from ..api import values_of
from ..bind import bind
from ..blender.blocks import removed_on_failure
from ..blender.jobs import Work
from ..blender.props import choice, flag, text
from ..blender.views import FLAT_LIGHT, TEXTURES
from ..cage_sets.selection import select
from ..drawing import grease_pencil
from ..errors import UserError, counted
from ..files import pictures
from ..files.pictures import Part
from ..generate import request
from ..generate.groups import SHAPE
from ..generate.settings import settings_of
from .base import hide
from .files import TRACING, FilesOperator, PictureProperties, paths_of
from .puppet import add_handles, make_one_cage

HANDLES, CAGES, SKELETON, NOTHING = "HANDLES", "CAGES", "SKELETON", "NOTHING"
MOVER_ITEMS = (
    (HANDLES, "Handles", "A cage for each picture, with a bone per vertex"),
    (CAGES, "Cages", "A cage for each picture, whose vertices are moved"),
    (SKELETON, "Skeleton", "One cage around all, with bones along its limbs"),
    (NOTHING, "Nothing", "A cage for each picture that it does not follow yet"),
)


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
        self.draw_options(*TRACING, "standard", "moved_by", *levels)

    def work(self, context: Context) -> Work[None]:
        with removed_on_failure():
            paths, shown, drawn = paths_of(self), _shown_pictures(context), _strokes(context)
            if drawn and not (paths or shown):
                made = [part for obj in drawn for part in grease_pencil.separated(context, obj)]
                self.tell_hidden(context, drawn)
                yield from self._cage(context, made)
                hide(drawn)
                return
            parts = pictures.from_files(paths) if paths else pictures.on_objects(shown)
            if not parts:
                raise UserError(
                    "Choose a picture file, or select image planes, image empties or Grease Pencil drawings"
                )
            yield from self._cut(context, parts)
        self.show_colours(context)

    def _cut(self, context: Context, parts: Sequence[Part]) -> Work[None]:
        """Makes each picture a mesh, in cages. Raises: UserError."""
        made, problems = dict[Object, Part](), list[UserError]()
        for part in parts:
            try:
                drawing = yield from self.traced(part)
            except UserError as error:
                problems.append(error)
                continue
            data = pictures.textured_mesh(drawing.name, drawing.mesh(), part.canvas, part.image)
            made[part.place(context, drawing.name, data)] = part
        if not made:
            raise problems[0]
        made = {obj: made[obj] for obj in (yield from self._cage(context, list(made)))}
        hide(part.shown_by for part in made.values() if part.shown_by is not None)
        self.framed = tuple(made) if paths_of(self) else ()
        self.tell_skipped(problems, "picture")
        for part in made.values():
            if (pictures.opacity_of(part.image) > self.threshold).all():
                self.report(
                    {"WARNING"},
                    f"'{part.image.name}' has no transparent pixels, so its outline is a rectangle: erase its "
                    "background, or raise the threshold",
                )

    def _cage(self, context: Context, made: Sequence[Object]) -> Work[Sequence[Object]]:
        """Puts new objects into cages, which move them, or into one that bones along their limbs move; returns those
        that have one, and removes others.
        """
        context.view_layer.update()
        if self.moved_by == SKELETON:
            yield from make_one_cage(self, context, made)
            return made
        settings = settings_of(context)
        values = values_of(levels=self.levels, **{name: getattr(settings, name) for name in SHAPE})
        sets, problems = yield from request.make(context, made, (), values, self.tell, jump=False, still=True)
        caged = [obj for each in sets for obj in each.parts]
        bpy.data.batch_remove([obj for obj in made if obj not in caged])
        self.tell_skipped(problems)
        select(context, *caged)
        if self.moved_by == HANDLES:
            yield from add_handles(self, context, sets)
        elif self.moved_by == CAGES:
            yield from bind.bind_all(context, sets)
            self.report({"INFO"}, f"{counted(len(sets), 'cutout')}: move the vertices of the cages to pose them")
        return caged


def _shown_pictures(context: Context) -> list[Object]:
    """The selected objects that show a picture and are not cutouts, the active one first."""
    active = context.view_layer.objects.active
    shown = [obj for obj in context.selected_objects if pictures.image_on(obj) is not None]
    return sorted(shown, key=lambda obj: (obj is not active, obj.name))


def _strokes(context: Context) -> list[Object]:
    """The selected Grease Pencil drawings."""
    return [obj for obj in context.selected_objects if obj.type == grease_pencil.KINDS[0]]
