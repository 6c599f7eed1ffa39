"""Verify Cages and Show."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object, Scene

from .. import cage_sets
from ..animation import visibility
from ..bind.copies import complete
from ..blender import mesh_data, views
from ..blender.jobs import Work
from ..blender.props import flag, text
from ..cage_sets import CageSet, changes, selection
from ..cage_sets.selection import chosen, each_of_chosen, scene_of, select, sets_of_chosen
from ..drawing import planar
from ..drawing.plane import transform, world_matrix
from ..errors import Fault, UserError, last_fault
from ..keys import found_object
from ..puppets import armatures, duplicates, weights
from ..verify import claims
from ..verify.check import Chain, Finding, check, check_animation, same_frame, select_points
from .base import JobOperator, Operator


class OBJECT_OT_nested_cages_verify(JobOperator, bpy.types.Operator):
    """Check that cages do not cross themselves and enclose their contents on this frame, and select what is at
    fault; of a puppet, that none of its parts folds over itself
    """

    bl_label = "Verify Cages"

    whole: flag("Whole Animation", "Check all frames of the scene, up to the first with a fault", options={"SKIP_SAVE"})

    exclusive = True
    modes = ("OBJECT", "POSE")

    missing = "Select a drawing with its cages, or at least two objects of which one encloses the other"

    @staticmethod
    def needs(context: Context) -> bool:
        several = islice(filter(planar.readable, context.selected_objects), 2)
        caged = len(list(several)) > 1 or next(each_of_chosen(context), None) is not None
        return caged or armatures.puppet_of(chosen(context)) is not None

    def work(self, context: Context) -> Work[None]:
        scene, puppet = scene_of(context), armatures.puppet_of(chosen(context))
        if puppet is not None and not sets_of_chosen(context):
            duplicates.complete_puppets()
            yield from self._judge(context, puppet)
            return
        complete()
        chains = [claims.chain_of(context, objects) for objects in _nested(context, self.whole)]
        objects = [obj for chain in chains for obj in chain.objects]
        originals = list(dict.fromkeys(obj for chain in chains for obj in chain.originals))
        checked = [*objects, *originals]
        if self.whole:
            _check_not_stepping(scene, objects)
            with same_frame(scene):
                findings = yield from check_animation(context, chains)
                at_fault = _select_faults(context, checked, findings)
                _store(context, checked, findings)
        else:
            findings = check(context, chains)
            at_fault = _select_faults(context, checked, findings)
            _store(context, checked, findings)
        changes.settle(filter(None, (CageSet.of(chain.objects[0]) for chain in chains if chain.originals)))
        names = {original.name for original in originals}
        shown = [each for each in findings if each.broken or names.isdisjoint((each.fine, each.cage))]
        for verdict, sentence in dict.fromkeys((finding.verdict, finding.note) for finding in shown):
            self.report({"INFO"} if verdict == cage_sets.HOLDS else {"WARNING"}, sentence)
        if at_fault and context.mode == "OBJECT":
            select(context, *reversed(at_fault))

    def _judge(self, context: Context, puppet: Object) -> Work[None]:
        """Reports whether parts of a puppet fold over themselves, and goes to the first frame on which most does."""
        scene, chains = scene_of(context), [Chain((), folding=weights.foldings_of(puppet))]
        if self.whole:
            with same_frame(scene):
                findings = yield from check_animation(context, chains)
        else:
            findings = check(context, chains)
        for finding in findings:
            self.report({"WARNING"}, finding.note)
        if not findings:
            when = f"frames {scene.frame_start} to {scene.frame_end}" if self.whole else "this frame"
            self.report({"INFO"}, f"No part of '{puppet.name}' folds over itself on {when}")
            return
        worst = max(findings, key=lambda each: float(each.note.data["share"]))
        scene.frame_set(worst.frames[1])
        last_fault[:] = [Fault.at(puppet.session_uid, np.reshape(worst.note.data["place"], (1, 3)))]


def _store(context: Context, checked: Sequence[Object], findings: list[Finding]) -> None:
    """Failures last: the status bar shows, and the cage keeps, the last finding. Show goes to the first failure."""
    findings.sort(key=lambda finding: finding.broken)
    claims.remember(context, checked, findings)
    last_fault[:] = filter(None, (place_of(checked, each) for each in findings if each.broken))
    del last_fault[1:]


def place_of(checked: Sequence[Object], finding: Finding) -> Fault | None:
    """The place in the world where a finding fails, if it has one."""
    by_name = {obj.name: obj for obj in checked}
    cage, fine = by_name[finding.cage], by_name[finding.fine]
    points = [
        transform(world_matrix(obj), faults.astype(np.float64))
        for obj, faults in ((cage, finding.cage_faults), (fine, finding.fine_faults))
    ]
    places = np.concatenate([*points, np.reshape(finding.note.data.get("place", []), (-1, 3))])
    return Fault.at(cage.session_uid, places) if len(places) else None


def _check_not_stepping(scene: Scene, objects: Sequence[Object]) -> None:
    """Raises: UserError if the cages play how they form, when the drawing crosses them on purpose."""
    for obj in objects:
        cage_set = CageSet.of(obj) if cage_sets.level_of(obj) is not None else None
        if cage_set is None or cage_set.bound or cage_set.record.moving:
            continue
        if visibility.is_animated(cage_set):
            raise UserError(
                f"'{cage_set.name}' plays how its cages form, which the drawing crosses on purpose: "
                "bind the drawing or remove the animation first, or check single frames"
            )


def _select_faults(context: Context, objects: Sequence[Object], findings: Sequence[Finding]) -> list[Object]:
    """Selects the vertices that are at fault on this frame; returns the objects that have any."""
    faults = []
    for obj in objects:
        points = [finding.cage_faults for finding in findings if finding.cage == obj.name]
        points += [finding.fine_faults for finding in findings if finding.fine == obj.name]
        editable = obj.type == "MESH" and obj.data.is_editable
        if editable and select_points(context, obj, np.concatenate([np.empty((0, 3), np.float32), *points])):
            faults.append(obj)
    return faults


def _nested(context: Context, hidden: bool = False) -> list[list[Object]]:
    """The objects to check, from the inside out: selected ones of one set, or without sets; else all outputs of the
    selection, without objects hidden on this frame unless `hidden`.
    """
    selected = [obj for obj in context.selected_objects if planar.readable(obj)]
    outputs = sets_of_chosen(context)
    mine = [obj for obj in selected if cage_sets.level_of(obj) is not None]
    others = [obj for obj in selected if obj not in mine]
    plain = bool(others) and not any(CageSet.all_of(obj) for obj in others)
    drawings = {each.source for each in outputs}
    if len(selected) > 1 and (not outputs or (len(drawings) == 1 and (plain or len(mine) > 1))):
        return [sorted(selected, key=lambda obj: (selection.depth_of(obj), obj.dimensions.length))]
    nested = [
        sorted((obj for obj in output.members if hidden or not obj.hide_viewport), key=selection.depth_of)
        for output in outputs
    ]
    return [objects for objects in nested if len(objects) > 1]


class OBJECT_OT_nested_cages_select_fault(Operator, bpy.types.Operator):
    """Go to the place that the last message is about, or where a cage is at fault, and mark it in the view. Points of
    a drawing there are selected in Edit Mode
    """

    bl_label = "Show"
    modes = ()
    keeps_fault = True

    cage: text("Cage", "Name of the cage to show; empty for the last message", options={"SKIP_SAVE"})

    @classmethod
    def unavailable(cls, context: Context) -> str:
        if not last_fault:
            return "" if _broken(context) else "No message has named a place yet"
        obj = found_object(last_fault[0].identity)
        if obj is None or obj.name not in context.view_layer.objects:
            return "The object of the last message is gone"
        return ""

    def run(self, context: Context) -> None:
        cage = next((obj for obj in _broken(context) if obj.name == self.cage or not last_fault), None)
        if cage is not None:
            self._look_again(context, cage)
        if not last_fault:
            return
        fault = last_fault[0]
        obj = found_object(fault.identity)
        assert obj is not None
        obj.hide_viewport = False
        obj.hide_set(False)
        if cage_sets.level_of(obj) is None and obj.is_editable and obj.type != "ARMATURE":
            _edit(context, obj, fault)
        places = np.array(fault.places)
        context.scene.cursor.location = places.mean(axis=0)
        views.frame(context, places, obj.dimensions.length)
        views.redraw(context)
        self.report({"INFO"}, f"'{obj.name}': the place is marked in red")

    def _look_again(self, context: Context, cage: Object) -> None:
        """Checks a cage on the frame on which it was at fault, for the places there."""
        frame = cage_sets.node_of(cage).checked[1]
        if context.scene.frame_current != frame:
            context.scene.frame_set(frame)
        home = CageSet.of(cage)
        members = home.members if home is not None else [cage]
        chain = claims.chain_of(context, sorted(members, key=selection.depth_of))
        checked, findings = [*chain.objects, *chain.originals], check(context, [chain])
        _store(context, checked, [each for each in findings if cage.name in (each.cage, each.fine)])
        if not last_fault:
            self.report({"INFO"}, f"'{cage.name}' holds now")


def _broken(context: Context) -> list[Object]:
    """The cages of the selection that are at fault."""
    cages = [obj for each in sets_of_chosen(context) for obj in each.members[1:]]
    return [obj for obj in cages if cage_sets.node_of(obj).check == cage_sets.FAULT]


def _edit(context: Context, obj: Object, fault: Fault) -> None:
    """Edit Mode of a drawing, with the vertices or control points closest to the places of a fault selected."""
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    select(context, obj)
    points: list[Any] = list(obj.data.vertices) if obj.type == "MESH" else []
    if obj.type == "CURVE":
        points = [point for spline in obj.data.splines for point in (*spline.bezier_points, *spline.points)]
    if not points:
        return
    there = transform(np.array(obj.matrix_world), np.array([point.co[:3] for point in points]))
    closest = [int(np.linalg.norm(there - place, axis=1).argmin()) for place in fault.places]
    if obj.type == "MESH":
        mesh_data.select_vertices(mesh_data.mesh_of(obj), np.isin(np.arange(len(points)), closest))
        context.tool_settings.mesh_select_mode = (True, False, False)
    for number, point in enumerate(points if obj.type == "CURVE" else ()):
        chosen = number in closest
        if isinstance(point, bpy.types.BezierSplinePoint):
            point.select_control_point = point.select_left_handle = point.select_right_handle = chosen
        else:
            point.select = chosen
    bpy.ops.object.mode_set(mode="EDIT")
