"""Bind to Cages: the drawing follows its cages, or stands by itself again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
from bpy.types import Context

from ..bind import bind
from ..bind.field import HARMONIC, LINEAR, NAMES
from ..blender.jobs import Work
from ..blender.props import choice
from ..blender.views import OUTLINES
from ..cage_sets import CageSet
from ..cage_sets.selection import check_free, select
from ..errors import UserError
from .base import SetOperator

BIND, UNBIND, REST = "BIND", "UNBIND", "REST_FROM_POSE"
ACTION_ITEMS = (
    ("TOGGLE", "Toggle", "Bind what is not bound; if all of it is, unbind it"),
    (BIND, "Bind", "Make the drawing follow its cages"),
    (UNBIND, "Unbind", "Restore cages and drawing as they were before binding, with their animation"),
    (REST, "Rest from Pose", "Bind the drawing in its original shape to the cages as they are now"),
)
METHOD_ITEMS = (
    ("AUTO", "Automatic", "Harmonic; linear where that would take too many weights to play"),
    (HARMONIC, NAMES[HARMONIC], "Smooth, also in concave cages and around holes"),
    (LINEAR, NAMES[LINEAR], "Linear on the triangles of the cage: nothing leaves it unless a triangle flips"),
)


class OBJECT_OT_nested_cages_bind(SetOperator, bpy.types.Operator):
    """Make the drawing follow its cages: move, key, sculpt or rig the coarsest one, and edit finer ones for detail; or
    unbind it. The file works without the add-on
    """

    bl_label = "Bind to Cages"
    purpose = "move it: select cages around it"
    exclusive = True

    action: choice("Action", "What to do with the selected cages", ACTION_ITEMS, options={"SKIP_SAVE"})
    method: choice("Method", "How each level follows the next coarser one", METHOD_ITEMS, default="AUTO")

    def suitable(self, context: Context, sets: Sequence[CageSet]) -> list[CageSet]:
        usable = SetOperator.suitable(self, context, sets)
        loose = [each for each in usable if not each.bound]
        if self.action in (UNBIND, REST):
            bound = [each for each in usable if each.bound]
            if not bound:
                raise UserError("Nothing is bound to these cages")
            return bound
        if next(bind.newcomers(context), None) is not None:
            return usable
        if not loose:
            if self.action == BIND:
                raise UserError("These cages are already bound")
            self.action = UNBIND
        return loose or usable

    def each(self, context: Context, cage_set: CageSet) -> Work[str]:
        if self.action == UNBIND:
            check_free(cage_set.members)
            return ""
        if self.action == REST:
            return (yield from bind.rebind(context, cage_set, self.method))
        if cage_set.bound:
            return (yield from bind.take_in(context, cage_set))
        return (yield from bind.steps(context, cage_set, self.method))

    def all(self, context: Context, sets: Sequence[CageSet]) -> Work[list[Any]]:
        if self.action == UNBIND:
            return (yield from SetOperator.all(self, context, sets))
        self.shown_by = (OUTLINES,)
        return (yield from bind.in_step(context, [self.each(context, cage_set) for cage_set in sets]))

    def finish(self, context: Context, done: Sequence[tuple[CageSet, str]]) -> None:
        if self.action == UNBIND:
            for sentence in bind.unbind(*(cage_set for cage_set, _ in done)):
                self.report({"WARNING"}, sentence)
            return
        cages = [cage_set.cages[-1] for cage_set, _ in done]
        select(context, *cages)
        name = f"'{cages[0].name}'" if len(cages) == 1 else f"the {len(cages)} coarsest cages"
        said = done[0][1] if len(done) == 1 else f"{len(done)} drawings follow"
        self.report({"INFO"}, f"Move {name} and the drawing follows. {said}")
