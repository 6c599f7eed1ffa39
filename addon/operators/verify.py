"""Verify Cages: check cages again after editing."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from .. import record
from ..animation import bake
from ..binding.adoption import adopt, waiting
from ..errors import UserError
from ..following import claims
from ..generation.checking import Finding, check, check_animation, same_frame, select_points
from ..generation.job import Work
from ..properties.kinds import flag
from ..scene import convert, ownership
from ..scene.selection import chosen, outputs_of_chosen, scene_of, select
from .base import JobOperator


class OBJECT_OT_nested_cages_verify(JobOperator, bpy.types.Operator):
    """Check whether cages are simple and strictly enclose their contents on this frame, and select the vertices at
    fault
    """

    bl_label = "Verify Cages"

    whole: flag("Whole Animation", "Check all frames of the scene, up to the first with a fault", options={"SKIP_SAVE"})

    exclusive = True
    modes = ("OBJECT", "POSE")

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        if not _nested(context) and not waiting(chosen(context)):
            return "Select a drawing with its cages, or at least two objects of which one encloses the other"
        return ""

    def work(self, context: bpy.types.Context) -> Work[None]:
        scene = scene_of(context)
        adopt(scene, chosen(context))
        chains = [claims.chain_of(context, objects) for objects in _nested(context, self.whole)]
        objects = [obj for chain in chains for obj in chain.objects]
        originals = list(dict.fromkeys(obj for chain in chains for obj in chain.originals))
        checked = [*objects, *originals]
        if self.whole:
            _check_not_stepping(scene, objects)
            with same_frame(scene):
                findings = yield from check_animation(context, chains)
                at_fault = _select_faults(context, checked, findings)
        else:
            findings = check(context, chains)
            at_fault = _select_faults(context, checked, findings)
        # Failures last: the status bar shows, and the cage keeps, the last finding.
        findings.sort(key=lambda finding: not finding.holds)
        claims.remember(checked, findings)
        names = {original.name for original in originals}
        shown = [found for found in findings if not found.holds or names.isdisjoint((found.fine, found.cage))]
        for holds, sentence in dict.fromkeys((finding.holds, finding.note) for finding in shown):
            self.report({"INFO"} if holds else {"WARNING"}, sentence)
        if at_fault and context.mode == "OBJECT":
            select(context, *reversed(at_fault))


def _check_not_stepping(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> None:
    """Raises: UserError if the cages play how they form, when the drawing crosses them on purpose."""
    for obj in objects:
        collection = ownership.collection_about(scene, obj) if ownership.level_of(obj) is not None else None
        if collection is None or ownership.is_bound(collection) or record.of(collection).moving:
            continue
        if bake.is_animated(collection):
            raise UserError(
                f"'{collection.name}' plays how its cages form, which the drawing crosses on purpose: "
                "bind the drawing or remove the animation first, or check single frames"
            )


def _select_faults(
    context: bpy.types.Context, objects: Sequence[bpy.types.Object], findings: Sequence[Finding]
) -> list[bpy.types.Object]:
    """Selects the vertices that are at fault on this frame; returns the objects that have any."""
    found = []
    for obj in objects:
        points = [finding.cage_faults for finding in findings if finding.cage == obj.name]
        points += [finding.fine_faults for finding in findings if finding.fine == obj.name]
        editable = obj.type == "MESH" and obj.data.is_editable
        if editable and select_points(context, obj, np.concatenate([np.empty((0, 3), np.float32), *points])):
            found.append(obj)
    return found


def _nested(context: bpy.types.Context, hidden: bool = False) -> list[list[bpy.types.Object]]:
    """The objects to check, from the inside out: selected ones of one set, or without sets; else all outputs of the
    selection, without objects hidden on this frame unless `hidden`.
    """
    selected = [obj for obj in context.selected_objects if convert.readable(obj)]
    outputs = outputs_of_chosen(context)
    mine = [obj for obj in selected if ownership.level_of(obj) is not None]
    plain = len(selected) > len(mine) and not any(ownership.outputs_of(scene_of(context), obj) for obj in selected)
    drawings = {ownership.source_of(output) for output in outputs}
    if len(selected) > 1 and (not outputs or (len(drawings) == 1 and (plain or len(mine) > 1))):
        return [sorted(selected, key=lambda obj: (ownership.depth_of(obj), obj.dimensions.length))]
    found = [
        sorted((obj for obj in ownership.members(output) if hidden or not obj.hide_viewport), key=ownership.depth_of)
        for output in outputs
    ]
    return [objects for objects in found if len(objects) > 1]
