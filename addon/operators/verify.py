"""Verify Cages: what was true when they were made may not be after editing."""

from __future__ import annotations

import bpy
import numpy as np

from .. import convert, ownership
from ..checking import check, select_points
from ..refusal import Refusal, load_core, say


class OBJECT_OT_nested_cages_verify(bpy.types.Operator):
    """Checks cages that may have been edited."""

    bl_idname = "object.nested_cages_verify"
    bl_label = "Verify Cages"
    bl_description = (
        "Check whether cages, as they are on this frame, are simple and strictly enclose what is in them, "
        "and select the vertices at fault"
    )
    bl_options = {"REGISTER", "UNDO"}

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
        objects = _nested(context)
        try:
            findings = check(context, objects, load_core())
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        at_fault = []
        for obj in objects:
            points = [finding.cage_faults for finding in findings if finding.cage == obj.name]
            points += [finding.fine_faults for finding in findings if finding.fine == obj.name]
            if obj.type == "MESH" and obj.data.is_editable and select_points(context, obj, np.concatenate(points)):
                at_fault.append(obj)
        for finding in findings:
            cage = next(obj for obj in objects if obj.name == finding.cage)
            if ownership.LEVEL in cage:
                verdict = "Holds on frame {frame}" if finding.holds else "Broken on frame {frame}"
                cage["nested_cages_check"] = say(verdict, frame=context.scene.frame_current)
                cage["nested_cages_finding"] = finding.sentence
        reports = dict.fromkeys((finding.holds, finding.sentence) for finding in findings)
        for holds, sentence in sorted(reports, key=lambda found: not found[0]):
            # The status bar shows the last one: what does not hold.
            self.report({"INFO"} if holds else {"WARNING"}, sentence)
        if at_fault:
            for obj in context.selected_objects:
                obj.select_set(False)
            for obj in at_fault:
                obj.select_set(True)
            context.view_layer.objects.active = at_fault[0]
        return {"FINISHED"}


def _nested(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The objects to check, from the inside out: the selected ones, or those of the active one's cages."""
    chosen = [obj for obj in context.selected_objects if convert.readable(obj)]
    if len(chosen) > 1:
        return sorted(chosen, key=lambda obj: (obj.get(ownership.LEVEL, 0), obj.dimensions.length))
    active = context.view_layer.objects.active
    collection = ownership.collection_about(context.scene, active) if active is not None else None
    return [obj for obj in ownership.members(collection) if not obj.hide_viewport] if collection is not None else []
