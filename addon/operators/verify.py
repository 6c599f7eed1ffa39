"""Verify Cages, Show and Write Report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy
import numpy as np
from bpy.types import Collection, Context, Object, Scene
from mathutils import Vector

from .. import record
from ..animation import visibility
from ..binding.adoption import adopt, waiting
from ..errors import Fault, UserError
from ..following import claims
from ..generation.job import Work
from ..generation.verifying import Finding, check, check_animation, same_frame, select_points
from ..keys import found_object
from ..properties.kinds import flag
from ..scene import convert, ownership
from ..scene.ownership import chosen, outputs_of_chosen, scene_of, select
from .base import JobOperator, Operator, OutputOperator, last_fault


class OBJECT_OT_nested_cages_verify(JobOperator, bpy.types.Operator):
    """Check that cages are simple and strictly enclose their contents on this frame, and select what is at fault"""

    bl_label = "Verify Cages"

    whole: flag("Whole Animation", "Check all frames of the scene, up to the first with a fault", options={"SKIP_SAVE"})

    exclusive = True
    modes = ("OBJECT", "POSE")

    missing = "Select a drawing with its cages, or at least two objects of which one encloses the other"

    @staticmethod
    def needs(context: Context) -> object:
        return _nested(context) or waiting(chosen(context))

    def work(self, context: Context) -> Work[None]:
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
        shown = [each for each in findings if not each.holds or names.isdisjoint((each.fine, each.cage))]
        for holds, sentence in dict.fromkeys((finding.holds, finding.note) for finding in shown):
            self.report({"INFO"} if holds else {"WARNING"}, sentence)
        if at_fault and context.mode == "OBJECT":
            select(context, *reversed(at_fault))


def _check_not_stepping(scene: Scene, objects: Sequence[Object]) -> None:
    """Raises: UserError if the cages play how they form, when the drawing crosses them on purpose."""
    for obj in objects:
        collection = ownership.collection_about(scene, obj) if ownership.level_of(obj) is not None else None
        if collection is None or ownership.is_bound(collection) or record.of(collection).moving:
            continue
        if visibility.is_animated(collection):
            raise UserError(
                f"'{collection.name}' plays how its cages form, which the drawing crosses on purpose: "
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
    selected = [obj for obj in context.selected_objects if convert.readable(obj)]
    outputs = outputs_of_chosen(context)
    mine = [obj for obj in selected if ownership.level_of(obj) is not None]
    others = [obj for obj in selected if obj not in mine]
    plain = bool(others) and not any(ownership.outputs_about(scene_of(context), obj) for obj in others)
    drawings = {ownership.source_of(output) for output in outputs}
    if len(selected) > 1 and (not outputs or (len(drawings) == 1 and (plain or len(mine) > 1))):
        return [sorted(selected, key=lambda obj: (ownership.depth_of(obj), obj.dimensions.length))]
    nested = [
        sorted((obj for obj in ownership.members(output) if hidden or not obj.hide_viewport), key=ownership.depth_of)
        for output in outputs
    ]
    return [objects for objects in nested if len(objects) > 1]


class OBJECT_OT_nested_cages_select_fault(Operator, bpy.types.Operator):
    """Enter Edit Mode with the points selected that the last message is about, and zoom to them"""

    bl_label = "Show"
    modes = ()

    @classmethod
    def unavailable(cls, context: Context) -> str:
        if not last_fault:
            return "No message has named a place yet"
        obj = found_object(last_fault[0].identity)
        if obj is None or obj.name not in context.view_layer.objects:
            return "The object of the last message is gone"
        return "" if obj.is_editable else f"'{obj.name}' cannot be edited because it is linked from another file"

    def run(self, context: Context) -> None:
        fault = last_fault[0]
        obj = found_object(fault.identity)
        assert obj is not None
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        obj.hide_viewport = False
        obj.hide_set(False)
        select(context, obj)
        middle = sum((Vector(place) for place in fault.places), Vector()) / len(fault.places)
        context.scene.cursor.location = middle
        if obj.type in {"MESH", "CURVE"}:
            bpy.ops.object.mode_set(mode="EDIT")
            (bpy.ops.mesh if obj.type == "MESH" else bpy.ops.curve).select_all(action="DESELECT")
            bpy.ops.object.mode_set(mode="OBJECT")
            _select_points(obj, fault)
            if obj.type == "MESH":
                context.tool_settings.mesh_select_mode = (True, False, False)
            bpy.ops.object.mode_set(mode="EDIT")
        if context.area is not None and context.area.type == "VIEW_3D" and context.region is not None:
            views = bpy.ops.view3d
            (views.view_selected if obj.type in {"MESH", "CURVE"} else views.view_center_cursor)()
        names = ", ".join(f"{x:.4g}" for x in (middle.x, middle.y, middle.z))
        self.report({"INFO"}, f"'{obj.name}' at ({names}), where the 3D cursor is now")


def _select_points(obj: Object, fault: Fault) -> None:
    """Selects the vertices or control points closest to the places of the fault."""
    if obj.type == "MESH":
        points = list(obj.data.vertices)
    else:
        points = [point for spline in obj.data.splines for point in (*spline.bezier_points, *spline.points)]
    if not points:
        return
    there = np.array([(obj.matrix_world @ Vector(point.co[:3]))[:] for point in points])
    for place in fault.places:
        chosen = points[np.linalg.norm(there - place, axis=1).argmin()]
        setattr(chosen, "select_control_point" if hasattr(chosen, "select_control_point") else "select", True)


NAME = "Nested Cages Report"
FRAMES = ("first frame", "growing back from frame", "tightening from frame", "result on frame")


class OBJECT_OT_nested_cages_report(OutputOperator, bpy.types.Operator):
    """Write a text with all facts about these cages: certificates, binding errors, times, notes"""

    bl_label = "Write Report"
    modes = ("OBJECT", "POSE")
    both = True

    def finish(self, _context: Context, done: Sequence[tuple[Collection, None]]) -> None:
        text = bpy.data.texts.get(NAME) or bpy.data.texts.new(NAME)
        text.from_string("\n\n".join("\n".join(lines(collection)) for collection, _ in done) + "\n")
        self.report({"INFO"}, f"Written to the text '{NAME}': open it in a Text Editor")


def lines(collection: Collection) -> Iterator[str]:
    """The lines of the report, level by level."""
    yield collection.name
    for obj in ownership.members(collection):
        node = record.node_of(obj)
        numbers: dict[str, float] = {"vertices": len(obj.data.vertices)}
        if node.role == record.CAGE:
            numbers |= {"excess": node.excess, "clearance": node.clearance, "seconds": node.seconds}
            numbers |= {name: frame for name, frame in zip(FRAMES, node.frames, strict=True) if frame >= 0}
        yield ""
        yield obj.name
        for label, value in numbers.items():
            yield f"    {label}: {value:.6g}"
        edited = not ownership.is_bound(collection) and record.is_edited(obj)
        unknown = "" if edited and record.is_judged(obj) else record.EDITED
        certificate = unknown if edited else record.certificate(node)
        method, error = record.link(obj)
        follows = f"{method}, error {error:.1e} at rest" if method else ""
        said = (node.start, certificate, follows, *record.sentences(node, checks=True))
        for sentence in filter(None, said):
            yield f"    {sentence}"
