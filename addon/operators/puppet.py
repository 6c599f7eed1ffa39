"""Make Puppet: an armature that moves the parts of a layered drawing by themselves."""

from __future__ import annotations

import bpy
from bpy.types import Context, Object

from .. import record
from ..core import core
from ..errors import UserError, counted
from ..generation.job import Work
from ..properties.kinds import flag
from ..puppets import armatures, moving
from ..scene.areas import paints
from .base import JobOperator, pose
from .views import OUTLINES


class OBJECT_OT_nested_cages_puppet(JobOperator, bpy.types.Operator):
    """Give the selected drawings bones, so that each part moves by itself: those that overlap hang on each other, and
    long ones bend. Hang a bone on another one and press again, and the puppet follows
    """

    bl_label = "Make Puppet"
    modes = ("OBJECT", "POSE")
    exclusive = True

    limits: flag("Limit Turns", "Limit each joint to the range in which nothing folds over itself", default=True)

    needs = staticmethod(lambda context: _selected_parts(context)[0])
    missing = "Select the parts of a drawing: meshes, curves, texts, pictures or Grease Pencil"
    shown_by = (OUTLINES,)

    def work(self, context: Context) -> Work[None]:
        objects, old = _selected_parts(context)
        if old is not None and not old.is_editable:
            raise UserError(f"'{old.name}' is linked from another file: make it local first")
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        self.tell_hidden(context, objects)
        with moving.at_rest(context, objects, old):
            given = yield from moving.drawn(context, objects)
            armature, puppet = yield from moving.articulate(context, given, old, limits=self.limits)
        pose(context, armature)
        self.tell_skipped(list(given.problems))
        for note in puppet.draft.notes:
            self.report({"WARNING"}, note)
        ranges = [each for each in puppet.ranges if each != core.puppet.JointRange()]
        proved = min((min(-each.low, each.high) for each in ranges), default=0.0)
        folds = f"; nothing folds within {proved:.0f}° of any joint that bends" if ranges else ""
        count = counted(len(given.parts), "part")
        self.report({"INFO"}, f"{count} on {counted(len(puppet.bones), 'bone')}: pose '{armature.name}'{folds}")


def _selected_parts(context: Context) -> tuple[list[Object], Object | None]:
    """The drawings of a puppet, and its armature if there is one: what is selected, with all that moves with it."""
    selected = list(context.selected_objects)
    drawings = [obj for obj in selected if paints(obj) and record.level_of(obj) is None]
    old = armatures.puppet_of(sorted(selected, key=lambda obj: obj.type != "ARMATURE"))
    known = armatures.drawings_of(old) if old is not None else []
    return [*known, *(obj for obj in drawings if obj not in known)], old
