"""Cages lie around the drawing as Blender displays it: whatever adds, places, moves and deforms it."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
import shapely

from drawings import at_frame, evaluated, in_world, star, wire


def bezier():
    bpy.ops.curve.primitive_bezier_circle_add(location=(1.0, 2.0, 0.5), rotation=(0.3, 0.2, 0.1))


def nurbs():
    bpy.ops.curve.primitive_nurbs_circle_add(radius=0.5, location=(-1.0, 0.0, 0.0))


def text_on_path():
    bezier()
    path = bpy.context.object
    bpy.ops.object.text_add()
    bpy.context.object.parent = path
    path.select_set(False)


def on_vertices():
    wire("Drawing", [star()]).instance_type = "VERTS"


KINDS = {"bezier": bezier, "nurbs": nurbs, "text on a path": text_on_path, "instancing": on_vertices}


def displayed(obj, depsgraph):
    """The displayed edges of an evaluated object in the world, as lines (k, 2, 3)."""
    shape = obj.evaluated_get(depsgraph)
    mesh = shape.to_mesh()
    edges = np.array([edge.vertices for edge in mesh.edges])
    shape.to_mesh_clear()
    return in_world(shape, evaluated(obj, depsgraph))[edges]


def check_enclosed(source, cage, frame):
    """Raises AssertionError unless the displayed drawing is inside the displayed cage, seen along the cage's z."""
    depsgraph = at_frame(frame)
    back = np.linalg.inv(np.array(cage.evaluated_get(depsgraph).matrix_world))
    inner, outer = (
        shapely.multilinestrings((displayed(obj, depsgraph) @ back[:3, :3].T + back[:3, 3])[:, :, :2])
        for obj in (source, cage)
    )
    area = shapely.union_all(shapely.polygonize(shapely.get_parts(shapely.unary_union(outer))).geoms)
    assert area.contains(inner)


@pytest.mark.parametrize("kind", KINDS)
def test_cages_lie_and_stay_around_what_is_displayed(kind) -> None:
    KINDS[kind]()
    source = bpy.context.object
    assert bpy.ops.object.nested_cages_generate(levels="12") == {"FINISHED"}
    cage = next(obj for obj in bpy.data.objects if obj.get("nested_cages_level") == 1)
    end = bpy.context.scene.frame_current
    check_enclosed(source, cage, end)
    source.delta_location.x, source.delta_scale = 0.7, (1.5, 1.5, 1.5)
    if source.parent is None:
        source.constraints.new("COPY_LOCATION").target = bpy.data.objects.new("There", None)
    for frame in (end, end + 50):
        check_enclosed(source, cage, frame)
    assert bpy.ops.object.nested_cages_generate(levels="12") == {"FINISHED"}
    assert [len(obj.constraints) for obj in (cage, source)] in ([1, 1], [0, 0])
    check_enclosed(source, cage, end)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert cage["nested_cages_check"].startswith("Holds")
