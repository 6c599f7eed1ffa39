"""Verify Cages: check cages again after editing."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from bpy.props import BoolProperty

from .. import keys
from ..animation import bake, shape_keys
from ..binding import field
from ..errors import UserError
from ..generation.checking import Chain, Finding, check, check_animation, same_frame, select_points
from ..generation.job import Work, completed
from ..io import silhouette
from ..scene import convert, ownership
from ..scene.convert import Drawing, Outline
from ..scene.plane import Frame, transform, world_matrix
from ..scene.selection import outputs_of_active, scene_of, select
from .base import JobOperator, Outcome


class OBJECT_OT_nested_cages_verify(JobOperator, bpy.types.Operator):
    """Checks cages that may have been edited."""

    bl_idname = "object.nested_cages_verify"
    bl_label = "Verify Cages"
    bl_description = (
        "Check whether cages are simple and strictly enclose their contents on this frame, and select the vertices "
        "at fault"
    )
    bl_options = {"REGISTER", "UNDO"}

    whole: BoolProperty(
        name="Whole Animation",
        description="Check all frames of the scene, up to the first with a fault",
        default=False,
        options={"SKIP_SAVE"},
    )

    exclusive = True

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        if context.mode != "OBJECT":
            return "Switch to Object Mode"
        if not _nested(context):
            return "Select a drawing with its cages, or at least two objects of which one encloses the other"
        return ""

    def work(self, context: bpy.types.Context) -> Work[Outcome]:
        scene = scene_of(context)
        chains = [_with_originals(context, objects) for objects in _nested(context, self.whole)]
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
        by_name = {obj.name: obj for obj in checked}
        for finding in findings:
            outer, inner = by_name[finding.cage], by_name[finding.fine]
            cage = outer if ownership.depth_of(outer) > 0 else inner
            if ownership.level_of(cage) is not None:
                keys.store(cage, {keys.CHECK: _verdict(finding), keys.FINDING: finding.sentence})
        names = {original.name for original in originals}
        shown = [found for found in findings if not found.holds or names.isdisjoint((found.fine, found.cage))]
        for holds, sentence in dict.fromkeys((finding.holds, finding.sentence) for finding in shown):
            self.report({"INFO"} if holds else {"WARNING"}, sentence)
        if at_fault:
            select(context, *reversed(at_fault))
        return {"FINISHED"}


def _with_originals(context: bpy.types.Context, objects: Sequence[bpy.types.Object]) -> Chain:
    """The objects with the originals of the fine mesh among them, if they are visible too: not while the animation
    plays on a copy, nor if they cannot follow exactly.
    """
    fine = next((obj for obj in objects if ownership.level_of(obj) == 0), None)
    collection = ownership.collection_about(scene_of(context), fine) if fine is not None else None
    if (
        fine is None
        or collection is None
        or any(shape_keys.is_step_shown(obj) for obj in objects if ownership.level_of(obj) is not None)
    ):
        return Chain(objects)
    found = [
        original for original in ownership.originals(collection) if original not in objects and original.visible_get()
    ]
    place = objects.index(fine)
    if not ownership.is_bound(collection):
        return Chain(objects, [original for original in found if _is_readable(context, original)], place)
    originals = [original for original in found if field.followed(original) is not None]
    return Chain(objects, originals, place, instead=bool(originals), seen=_displayed)


def _is_readable(context: bpy.types.Context, obj: bpy.types.Object) -> bool:
    try:
        convert.read(context, obj)
    except UserError:
        return False
    return True


def _displayed(context: bpy.types.Context, obj: bpy.types.Object, frame: Frame) -> tuple[Outline, Drawing]:
    """The outline of a bound drawing, or of the area that it paints if it has none. Raises: UserError."""
    try:
        outline = convert.read(context, obj)
    except UserError:
        shown = field.shown_by(obj)
        loops, _ = completed(silhouette.outline(context, [shown], frame, silhouette.Options(closed=True)))
        back = np.linalg.inv(world_matrix(shown)) @ frame.matrix
        own = tuple(transform(back, frame.points(loop)).astype(np.float32) for loop in loops)
        return Outline(obj.name, own, world_matrix(shown), obj.session_uid), Drawing(obj.name, frame, loops)
    return outline, convert.drawing_in(frame, outline, layer=True)


def _check_not_stepping(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> None:
    """Raises: UserError if the cages play how they form, when the drawing crosses them on purpose."""
    for obj in objects:
        collection = ownership.collection_about(scene, obj) if ownership.level_of(obj) is not None else None
        if collection is None or ownership.is_bound(collection) or keys.flag(collection, keys.MOVING):
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


def _verdict(finding: Finding) -> str:
    """The verdict for the panel."""
    first, last = finding.frames
    if not finding.holds:
        return f"Broken on frame {last}"
    if first == last:
        return f"Holds on frame {last}"
    return f"Holds on {first} – {last}"


def _nested(context: bpy.types.Context, hidden: bool = False) -> list[list[bpy.types.Object]]:
    """The objects to check, from the inside out: the selected ones, or the outputs of the active one; without objects
    hidden on this frame unless `hidden`.
    """
    chosen = [obj for obj in context.selected_objects if convert.readable(obj)]
    if len(chosen) > 1:
        return [sorted(chosen, key=lambda obj: (ownership.depth_of(obj), obj.dimensions.length))]
    found = [
        sorted((obj for obj in ownership.members(output) if hidden or not obj.hide_viewport), key=ownership.depth_of)
        for output in outputs_of_active(context)
    ]
    return [objects for objects in found if len(objects) > 1]
