"""Three doors by task: which of them fits what is selected, which is open, and what is behind each.

What they offer stays in its place while a door is open: what cannot be used is greyed out, with its reason.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Vector

from .. import record
from ..errors import UserError, counted
from ..generation.job import running
from ..generation.levels import lengths, loop_sizes, meanings, parse_levels
from ..generation.rules import KEEP
from ..io.pictures import image_on
from ..operators.base import Operator, last_fault
from ..operators.bind import REST
from ..operators.puppet import CLIP_ITEMS, HANDLES, ONE_CAGE
from ..operators.views import redraw
from ..properties import groups
from ..properties.kinds import choice, registration
from ..properties.settings import copy_values, settings_of
from ..puppets.armatures import is_puppet, puppet_of
from ..puppets.controls import reach_of
from ..scene.areas import paints
from ..scene.ownership import chosen, scene_of, sets_of_chosen

RIG, PICTURE, CAGES = "RIG", "PICTURE", "CAGES"
TITLES = {RIG: "Rig a Character", PICTURE: "Cut Out a Picture", CAGES: "Cages around Drawings"}
SAYS = {
    RIG: "Move a drawing with bones: its parts by themselves, or all of it in one cage",
    PICTURE: "Make pictures with a transparent background parts to pose",
    CAGES: "Wrap drawings in coarse outlines that strictly enclose them, and move them by these",
}
ICONS = {RIG: "ARMATURE_DATA", PICTURE: "IMAGE_PLANE", CAGES: "MOD_MESHDEFORM"}
NOTHING = "Select drawings, pictures or a character"
# Objects that are looked at, so that a panel is drawn at once whatever is selected.
MOST = 200
# Fraction of the selected drawings that overlap others from which on they are the parts of a character.
PARTS = 0.5

# The door that was opened by hand, and the one that fitted then: it stays open until another one fits.
_by_hand: dict[str, str] = {}


def fitting(context: Context) -> str:
    """The door that fits the selection; empty if none does."""
    objects = _looked_at(context)
    sources = [source for each in sets_of_chosen(context) if (source := each.source) is not None]
    if any(image_on(obj) is not None for obj in (*sources, *objects)):
        return PICTURE
    armatures = [obj for obj in objects if obj.type == "ARMATURE"]
    if any(not record.is_helper(obj, record.HANDLES) for obj in armatures):
        return RIG
    drawings = [obj for obj in objects if paints(obj)]
    by_themselves = settings_of(context).use_selected_as_levels or any(
        record.level_of(obj) is not None for obj in drawings
    )
    if len(drawings) > 1 and not by_themselves and _overlap(drawings):
        return RIG
    return CAGES if drawings or armatures else ""


def opened(context: Context) -> str:
    """The door that is open: the one that fits, unless another one was opened since."""
    fits = fitting(context)
    return _by_hand["door"] if _by_hand.get("fits") == fits else fits


def _looked_at(context: Context) -> list[Object]:
    """What is selected; with nothing selected, the active object if it has cages."""
    selected = list(context.selected_objects)
    return (selected or [obj for obj in chosen(context) if sets_of_chosen(context)])[:MOST]


def _overlap(objects: Sequence[Object]) -> bool:
    """Whether most objects overlap others, seen along the direction in which all of them are thinnest."""
    corners = np.array([[obj.matrix_world @ Vector(corner) for corner in obj.bound_box] for obj in objects])
    low, high = corners.min(axis=1), corners.max(axis=1)
    seen = np.argsort(high.max(axis=0) - low.min(axis=0))[1:]
    low, high = low[:, seen], high[:, seen]
    meet = ((low[:, None] < high) & (low < high[:, None])).all(axis=2)
    return bool((meet.sum(axis=1) > 1).mean() > PARTS)


def draw(layout: Any, context: Context) -> None:
    """The doors, a line about the selection, and what is behind the door that is open."""
    door = opened(context)
    column = layout.column(align=True)
    for name, title in TITLES.items():
        column.operator("scene.nested_cages_door", text=title, icon=ICONS[name], depress=name == door).door = name
    row = layout.row()
    row.label(text=_selection(context, door), translate=False)
    if last_fault:
        row.operator("object.nested_cages_select_fault", icon="VIEWZOOM")
    if door:
        BEHIND[door](layout, context)
    else:
        layout.operator("object.nested_cages_import", text="Import Drawings", icon="IMPORT")
        layout.operator("object.nested_cages_cutout", text="Cut Out Picture Files", icon="IMAGE_PLANE")


def _selection(context: Context, door: str) -> str:
    """What is selected, in a line."""
    selected = [obj for obj in context.selected_objects if obj.type != "ARMATURE"]
    if not door:
        return NOTHING
    if len(selected) == 1:
        return selected[0].name
    return counted(len(selected), "drawing" if door != PICTURE else "picture") if selected else ""


def _first(layout: Any, name: str, **options: Any) -> Any:
    """The button to press, or in its place what it is doing."""
    row, job = layout.row(align=True), running()
    row.scale_y = 1.5
    if job is None:
        return row.operator(f"object.nested_cages_{name}", **options)
    row.progress(factor=job.fraction, text=job.message)
    row.operator("object.nested_cages_cancel", text="", icon="CANCEL")
    return None


def _rig_door(layout: Any, context: Context) -> None:
    given = any(obj.type == "ARMATURE" and not is_puppet(obj) for obj in context.selected_objects)
    button = _first(layout, "puppet", icon="ARMATURE_DATA")
    if button is not None and given:
        button.source = ONE_CAGE
    column = layout.column(align=True)
    column.operator_menu_enum("object.nested_cages_puppet", "source", icon="MOD_ARMATURE")
    column.operator("object.nested_cages_bind", text="Bind New Parts", icon="LINKED")
    puppet = puppet_of(chosen(context))
    if puppet is not None:
        row = layout.row(align=True)
        for kind, name, _ in CLIP_ITEMS:
            row.operator("object.nested_cages_clip", text=name).kind = kind
        column = layout.column(align=True)
        for reach in filter(None, map(reach_of, puppet.pose.bones)):
            row = column.row(align=True)
            row.prop(reach, "influence", text=reach.subtarget, slider=True, translate=False)
            row.operator("object.nested_cages_snap", text="", icon="SNAP_ON").control = reach.subtarget
        layout.operator("object.nested_cages_verify", text="Verify Whole Animation", icon="SEQUENCE").whole = True
    layout.operator("object.nested_cages_import", text="Import Puppet", icon="IMPORT").outlines = "PUPPET"
    layout.operator("object.nested_cages_export", icon="EXPORT")


def _picture_door(layout: Any, context: Context) -> None:
    _first(layout, "cutout", icon="IMAGE_PLANE")
    column = layout.column(align=True)
    column.operator("object.nested_cages_cutout", text="Cut Out with Skeleton", icon="ARMATURE_DATA").skeleton = True
    column.operator("object.nested_cages_import", text="Outline of Image", icon="IMAGE_DATA").outlines = "ONE"
    layout.operator("object.nested_cages_export", icon="EXPORT")


def _cages_door(layout: Any, context: Context) -> None:
    settings = settings_of(context)
    button = _first(layout, "generate", icon="MOD_MESHDEFORM")
    if button is not None:
        copy_values(settings, button)
    column = layout.column()
    column.use_property_split, column.use_property_decorate = True, False
    row = column.row()
    row.active = not settings.use_selected_as_levels
    row.prop(settings, "levels")
    row = column.row()
    row.alignment = "RIGHT"
    row.label(text=counts(context), translate=False)
    groups.draw(column, settings, groups.SPACE)
    grid = layout.column(align=True)
    bound = any(each.bound for each in sets_of_chosen(context))
    row = grid.row(align=True)
    text, icon = ("Unbind", "UNLINKED") if bound else ("Bind to Cages", "LINKED")
    row.operator("object.nested_cages_bind", text=text, icon=icon)
    row.operator("object.nested_cages_bind", text="Rest from Pose", icon="FILE_REFRESH").action = REST
    grid.operator("object.nested_cages_puppet", text="Add Handles", icon="BONE_DATA").source = HANDLES
    grid.operator("object.nested_cages_follow", icon="CON_FOLLOWTRACK")


BEHIND: dict[str, Callable[[Any, Context], None]] = {RIG: _rig_door, PICTURE: _picture_door, CAGES: _cages_door}


def counts(context: Context) -> str:
    """The vertices of the cages of all selected drawings: "20 % = 4 to 93 vertices"; empty if they are not known."""
    settings, known = settings_of(context), lengths(scene_of(context))
    if settings.use_selected_as_levels:
        return ""
    drawings = [obj for obj in chosen(context)[:MOST] if record.level_of(obj) is None and obj.mode == "OBJECT"]
    sizes = [of_one for obj in drawings if sum(of_one := loop_sizes(obj))]
    try:
        levels = parse_levels(settings.levels, known) if sizes else ()
    except UserError:
        return ""
    size = max((obj.dimensions.length for obj in drawings), default=0.0)
    keeps = settings.inside or settings.loops == KEEP
    return meanings(levels, sizes, size, keeps=keeps) if levels else ""


class SCENE_OT_nested_cages_door(Operator, bpy.types.Operator):
    """Show these buttons until others fit what is selected"""

    bl_label = "Task"
    bl_options = {"INTERNAL"}
    modes = ()
    during_jobs = True
    keeps_fault = True

    door: choice("Door", "What to do", [(name, title, "") for name, title in TITLES.items()])

    @classmethod
    def description(cls, _context: Context, properties: Any) -> str:
        return SAYS[properties.door]

    def run(self, context: Context) -> None:
        _by_hand.update(door=self.door, fits=fitting(context))
        redraw(context)


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_load(*_: object) -> None:
    """Another file was opened."""
    _by_hand.clear()


_register, _unregister = registration((SCENE_OT_nested_cages_door,))


def register() -> None:
    _register()
    bpy.app.handlers.load_post.append(_on_load)


def unregister() -> None:
    bpy.app.handlers.load_post.remove(_on_load)
    _unregister()
