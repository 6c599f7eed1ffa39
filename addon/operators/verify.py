"""Verify Cages: what was true when they were made may not be after editing."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext

import bpy
import numpy as np
from bpy.props import BoolProperty

from .. import keys
from ..animation import bake
from ..errors import UserError
from ..generation.checking import Finding, check, check_animation, same_frame, select_points
from ..scene import convert, ownership
from ..scene.selection import collection_of_active, select


class OBJECT_OT_nested_cages_verify(bpy.types.Operator):
    """Checks cages that may have been edited."""

    bl_idname = "object.nested_cages_verify"
    bl_label = "Verify Cages"
    bl_description = (
        "Check whether cages, as they are on this frame, are simple and strictly enclose what is in them, "
        "and select the vertices at fault"
    )
    bl_options = {"REGISTER", "UNDO"}

    whole: BoolProperty(  # type: ignore[valid-type]
        name="Whole Animation",
        description=(
            "Check all frames of the scene instead of this one, up to the first with a fault, and come back to this one"
        ),
        default=False,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to Object Mode")
            return False
        if len(_nested(context)) < 2:
            cls.poll_message_set(
                "Select a drawing with its cages, or at least two objects of which one encloses the other"
            )
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        objects, scene = _nested(context, self.whole), context.scene
        try:
            if self.whole:
                _refuse_steps(scene, objects)
            with same_frame(scene) if self.whole else nullcontext():
                findings = (check_animation if self.whole else check)(context, objects)
                at_fault = [obj for obj in objects if _select_faults(context, obj, findings)]
        except UserError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for finding in findings:
            cage = next(obj for obj in objects if obj.name == finding.cage)
            if keys.LEVEL in cage:
                cage[keys.CHECK] = _verdict(finding)
                cage[keys.FINDING] = finding.sentence
        reports = dict.fromkeys((finding.holds, finding.sentence) for finding in findings)
        for holds, sentence in sorted(reports, key=lambda found: not found[0]):
            # The status bar shows the last one: what does not hold.
            self.report({"INFO"} if holds else {"WARNING"}, sentence)
        if at_fault:
            select(context, *reversed(at_fault))
        return {"FINISHED"}


def _refuse_steps(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> None:
    """Raises: UserError if cages play how they came about, in which what is inside comes through them on purpose."""
    for obj in objects:
        collection = ownership.collection_about(scene, obj) if keys.LEVEL in obj else None
        if collection is not None and not ownership.is_bound(collection) and bake.is_animated(collection):
            raise UserError(
                f"'{collection.name}' plays how its cages came about, and there they are crossed on purpose: "
                "bind the drawing or remove the animation first, or check single frames"
            )


def _select_faults(context: bpy.types.Context, obj: bpy.types.Object, findings: Sequence[Finding]) -> bool:
    """Selects the vertices of an object that are at fault on this frame; whether there are any."""
    points = [finding.cage_faults for finding in findings if finding.cage == obj.name]
    points += [finding.fine_faults for finding in findings if finding.fine == obj.name]
    return obj.type == "MESH" and obj.data.is_editable and select_points(context, obj, np.concatenate(points)) > 0


def _verdict(finding: Finding) -> str:
    """What the panel says."""
    first, last = finding.frames
    if not finding.holds:
        return f"Broken on frame {last}"
    if first == last:
        return f"Holds on frame {last}"
    return f"Holds on {first} – {last}"


def _nested(context: bpy.types.Context, hidden: bool = False) -> list[bpy.types.Object]:
    """The objects to check, from the inside out: the selected ones, or those of the active one's cages, without those
    that are hidden on this frame unless `hidden`.
    """
    chosen = [obj for obj in context.selected_objects if convert.readable(obj)]
    if len(chosen) > 1:
        return sorted(chosen, key=lambda obj: (obj.get(keys.LEVEL, 0), obj.dimensions.length))
    collection = collection_of_active(context)
    members = ownership.members(collection) if collection is not None else []
    return [obj for obj in members if hidden or not obj.hide_viewport]
