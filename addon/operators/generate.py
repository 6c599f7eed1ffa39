"""Generate Nested Cages: in slices with progress when invoked, at once when executed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy
from bpy.types import Context, Object

from .. import cage_sets
from ..blender.jobs import Work, running
from ..blender.views import WIRES
from ..cage_sets import CageSet
from ..drawing import planar
from ..errors import UserError
from ..generate import groups, request
from ..generate.settings import GenerationProperties, OperatorProperties
from .base import JobOperator, Operator


class DrawingsOperator(JobOperator, OperatorProperties):
    """Works on the drawings of the selection, with the settings."""

    bl_options = {"REGISTER", "UNDO", "PRESET"}

    @classmethod
    def unavailable(cls, context: Context) -> str:
        return why_nothing(context) if next(_each_source(context), None) is None else ""


class OBJECT_OT_nested_cages_generate(DrawingsOperator, bpy.types.Operator):
    """Wrap the selected drawings in coarse outlines that strictly enclose them, and animate how the outlines grow"""

    bl_label = "Generate Nested Cages"
    modes = ("OBJECT", "EDIT_MESH")
    wrong_mode = "Switch to Object Mode, or select edge loops of a mesh in Edit Mode"
    shown_by = (WIRES,)

    def prepare(self, context: Context) -> None:
        self.take_from_panel(context)

    def draw(self, _context: Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "levels")
        groups.draw(layout.column(), self, (*groups.SPACE, *groups.WHICH))
        for title, names in groups.SECTIONS.items():
            header, body = layout.panel(f"nested_cages_{title}", default_closed=title != "Animation")
            header.label(text=title)
            if body is not None:
                groups.draw(body.column(), self, names)

    def work(self, context: Context) -> Work[None]:
        drawings, own = asked(context, self)
        _, problems = yield from request.make(context, drawings, own, self, self.tell)
        self.tell_skipped(problems)


class OBJECT_OT_nested_cages_cancel(Operator, bpy.types.Operator):
    """Stop the running job and leave the scene as it was"""

    bl_label = "Cancel"
    bl_options = {"INTERNAL"}
    modes = ()
    during_jobs = True

    needs, missing = staticmethod(lambda _context: running()), "No job is running"

    def run(self, _context: Context) -> None:
        job = running()
        if job is not None:
            job.cancelled = True


def sources(context: Context, *, as_selected: bool = False) -> list[Object]:
    """The drawings of the selection: all selected objects that can have an outline, or the meshes in Edit Mode.

    Output of a selected drawing, and bound output, is about to be replaced, not to be caged, unless it is wanted
    `as_selected`. With nothing selected, the active object counts if it has cages: an original hidden for its animation
    is no longer selected.
    """
    if as_selected and context.mode != "EDIT_MESH" and context.selected_objects:
        selected = [obj for obj in context.selected_objects if planar.readable(obj)]
        sets = {obj: CageSet.of(obj) if cage_sets.level_of(obj) is not None else None for obj in selected}
        return [obj for obj, its in sets.items() if its is None or its.source not in selected]
    return list(dict.fromkeys(_each_source(context)))


def _each_source(context: Context) -> Iterator[Object]:
    """The drawings one by one, so that a button need not look at all of them."""
    if context.mode == "EDIT_MESH":
        yield from context.objects_in_mode_unique_data
        return
    selected, active = context.selected_objects, context.view_layer.objects.active
    for obj in filter(planar.readable, selected):
        yield from _drawings_of(obj, selected)
    if not selected and active is not None and planar.readable(active) and CageSet.all_of(active):
        yield active


def why_nothing(context: Context) -> str:
    """Why there is nothing to cage: nothing is selected, or it is hidden or has no outline."""
    wanted = "a closed curve, a text, a Grease Pencil or a mesh made of edge loops"
    active = context.view_layer.objects.active
    if context.selected_objects:
        obj = active if active in context.selected_objects else context.selected_objects[0]
        kind = obj.bl_rna.properties["type"].enum_items[obj.type].name.lower()
        return f"'{obj.name}' has no outline, it is of the kind {kind}: select {wanted}"
    if active is not None and not active.visible_get():
        return f"'{active.name}' is hidden: show it (Alt H, or the Outliner) and select it"
    return f"Nothing is selected: select {wanted}"


def _drawings_of(obj: Object, selected: Sequence[Object]) -> list[Object]:
    """The drawings that an object stands for: those of a bound set, none of a moving copy, else itself."""
    if not cage_sets.has_node(obj):
        return [obj]
    if cage_sets.shown(obj, cage_sets.FILL) is not None:
        return []
    cage_set = CageSet.of(obj) if cage_sets.level_of(obj) is not None else None
    if cage_set is None:
        return [obj]
    if cage_set.source in selected:
        return []
    return (cage_set.originals if cage_set.bound else []) or [obj]


def asked(context: Context, values: GenerationProperties) -> tuple[list[Object], list[Object]]:
    """The drawings of the selection, the active one first, and the objects that are their levels. Raises: UserError."""
    active = context.view_layer.objects.active
    selected = sources(context, as_selected=values.use_selected_as_levels)
    if not selected:
        raise UserError(why_nothing(context))
    if not values.use_selected_as_levels:
        return sorted(selected, key=lambda obj: obj is not active), []
    if active is None or active not in selected or len(selected) < 2:
        raise UserError(
            "'Selected as Cages' needs the drawing as the active object and at least one coarse mesh selected as well"
        )
    return [active], [obj for obj in selected if obj is not active]
