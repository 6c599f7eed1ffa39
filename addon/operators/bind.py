"""Bind to Cages: the drawing follows its cages, or stands by itself again."""

from __future__ import annotations

import bpy
from bpy.types import Context

from ..bind import bind
from ..bind.copies import complete
from ..bind.field import HARMONIC, LINEAR, NAMES
from ..blender.jobs import Work
from ..blender.props import choice
from ..blender.views import OUTLINES
from ..cage_sets import CageSet
from ..cage_sets.selection import check_free, select, sets_of_chosen
from ..errors import UserError
from .base import JobOperator, why_none

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


class OBJECT_OT_nested_cages_bind(JobOperator, bpy.types.Operator):
    """Make the drawing follow its cages: move, key, sculpt or rig the coarsest one, and edit finer ones for detail; or
    unbind it. The file works without the add-on
    """

    bl_label = "Bind to Cages"
    exclusive = True

    action: choice("Action", "What to do with the selected cages", ACTION_ITEMS, options={"SKIP_SAVE"})
    method: choice("Method", "How each level follows the next coarser one", METHOD_ITEMS, default="AUTO")

    unavailable = classmethod(lambda _cls, context: why_none(context, _why_not))

    def work(self, context: Context) -> Work[None]:
        usable = [each for each in sets_of_chosen(context, both=False) if not _why_not(each)]
        if not usable:
            raise UserError(self.unavailable(context))
        bound, loose = ([each for each in usable if bool(each.bound) == is_bound] for is_bound in (True, False))
        newcomers = list(bind.newcomers(context)) if self.action in ("TOGGLE", BIND) else []
        if self.action in (UNBIND, REST) and not bound:
            raise UserError("Nothing is bound to these cages")
        if self.action == BIND and not (loose or newcomers):
            raise UserError("These cages are already bound")
        complete()
        unbinds = self.action == UNBIND or (self.action == "TOGGLE" and not (loose or newcomers))
        works = {each: bind.steps(context, each, self.method) for each in loose}
        if unbinds:
            works = {each: _freed(each) for each in bound}
        elif self.action == REST:
            works = {each: bind.rebind(context, each, self.method) for each in bound}
        elif newcomers:
            works |= {each: bind.take_in(context, each) for each in bound}
        done = yield from bind.in_step(context, list(works.values()))
        problems = [result for result in done if isinstance(result, UserError)]
        said = {each: result for each, result in zip(works, done, strict=True) if isinstance(result, str)}
        if not said:
            raise problems[0]
        self.tell_skipped(problems)
        if unbinds:
            for sentence in bind.unbind(*said):
                self.report({"WARNING"}, sentence)
            return
        self.shown_by = (OUTLINES,)
        cages = [each.cages[-1] for each in said]
        select(context, *cages)
        name = f"'{cages[0].name}'" if len(cages) == 1 else f"the {len(cages)} coarsest cages"
        follow = next(iter(said.values())) if len(said) == 1 else f"{len(said)} drawings follow"
        self.report({"INFO"}, f"Move {name} and the drawing follows. {follow}")


def _freed(cage_set: CageSet) -> Work[str]:
    """Nothing, for a set that can be changed. Raises: UserError."""
    check_free(cage_set.members)
    yield from ()
    return ""


def _why_not(cage_set: CageSet) -> str:
    """Why nothing can follow a set; empty if something can."""
    if cage_set.inside:
        return "Inner cages do not contain the drawing, so they cannot move it: select cages around it"
    return ""
