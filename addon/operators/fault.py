"""Select Fault: go to the place that the last message names."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Vector

from ..errors import Fault
from ..keys import found_object
from ..scene.plane import nearest
from ..scene.selection import select
from .base import Operator, last_fault


class OBJECT_OT_nested_cages_select_fault(Operator, bpy.types.Operator):
    """Enter Edit Mode with the points selected that the last message is about, and zoom to them"""

    bl_label = "Select Fault"
    modes = ()

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        fault = last_fault()
        if fault is None:
            return "No message has named a place yet"
        obj = found_object(fault.identity)
        if obj is None or obj.name not in context.view_layer.objects:
            return "The object of the last message is gone"
        return "" if obj.is_editable else f"'{obj.name}' cannot be edited because it is linked from another file"

    def run(self, context: bpy.types.Context) -> None:
        fault = last_fault()
        obj = found_object(fault.identity) if fault is not None else None
        assert fault is not None and obj is not None
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        obj.hide_viewport = False
        obj.hide_set(False)
        select(context, obj)
        middle = sum((Vector(place) for place in fault.places), Vector()) / len(fault.places)
        context.scene.cursor.location = middle
        if obj.type in {"MESH", "CURVE"}:
            bpy.ops.object.mode_set(mode="EDIT")
            if obj.type == "MESH":
                bpy.ops.mesh.select_all(action="DESELECT")
            else:
                bpy.ops.curve.select_all(action="DESELECT")
            bpy.ops.object.mode_set(mode="OBJECT")
            _select_points(obj, fault)
            if obj.type == "MESH":
                context.tool_settings.mesh_select_mode = (True, False, False)
            bpy.ops.object.mode_set(mode="EDIT")
        if context.area is not None and context.area.type == "VIEW_3D" and context.region is not None:
            if obj.type in {"MESH", "CURVE"}:
                bpy.ops.view3d.view_selected()
            else:
                bpy.ops.view3d.view_center_cursor()
        names = ", ".join(f"{x:.4g}" for x in (middle.x, middle.y, middle.z))
        self.report({"INFO"}, f"'{obj.name}' at ({names}), where the 3D cursor is now")


def _select_points(obj: bpy.types.Object, fault: Fault) -> None:
    """Selects the vertices or control points closest to the places of the fault."""
    if obj.type == "MESH":
        points = list(obj.data.vertices)
    else:
        points = [point for spline in obj.data.splines for point in (*spline.bezier_points, *spline.points)]
    if not points:
        return
    there = np.array([(obj.matrix_world @ Vector(point.co[:3]))[:] for point in points])
    for index in nearest(np.array(fault.places), there):
        chosen = points[index]
        if hasattr(chosen, "select_control_point"):
            chosen.select_control_point = True
        else:
            chosen.select = True
