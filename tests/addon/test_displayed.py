"""Cages lie around the drawing as Blender displays it: whatever adds, places, moves and deforms it."""

from __future__ import annotations

from random import Random

import bpy
import numpy as np
import pytest
import shapely

from drawings import at_frame, evaluated, grease_pencil, in_world, star, wire


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
    if obj.type == "GREASEPENCIL":
        strokes = [s for layer in shape.data.layers for s in layer.current_frame().drawing.strokes]
        found = [np.array([point.position for point in stroke.points], np.float32) for stroke in strokes]
        pairs = [np.stack([points, np.roll(points, -1, axis=0)], axis=1) for points in found]
        return in_world(shape, np.concatenate(pairs).reshape(-1, 3)).reshape(-1, 2, 3)
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


def closed_curve(add):
    """A curve of the menu that is open, closed and flat."""
    add()
    data = bpy.context.object.data
    for spline in data.splines:
        spline.use_cyclic_u = True
    if data.dimensions == "3D":
        data.dimensions = "2D"


def stroke():
    """A closed stroke, as drawn by hand: those of the menu are open and cross themselves."""
    grease_pencil("Stroke", [star()])


ADD = {
    "bezier circle": bpy.ops.curve.primitive_bezier_circle_add,
    "nurbs circle": bpy.ops.curve.primitive_nurbs_circle_add,
    "bezier": lambda: closed_curve(bpy.ops.curve.primitive_bezier_curve_add),
    "nurbs": lambda: closed_curve(bpy.ops.curve.primitive_nurbs_curve_add),
    "text": bpy.ops.object.text_add,
    "plane": bpy.ops.mesh.primitive_plane_add,
    "circle": bpy.ops.mesh.primitive_circle_add,
    "grid": bpy.ops.mesh.primitive_grid_add,
    "stroke": stroke,
}


def carried(random, source):
    """Gives an object a parent that moves, a constraint, a delta, and an instance elsewhere, some of these."""
    if random.random() < 0.6:
        random.choice([bezier, lambda: bpy.ops.object.empty_add(rotation=(0.2, 0.1, 0.4))])()
        parent = bpy.context.object
        parent.scale = [random.uniform(0.5, 2.0)] * 3
        parent.keyframe_insert("location", frame=1)
        parent.location.x += 3.0
        parent.keyframe_insert("location", frame=200)
        source.parent = parent
    if random.random() < 0.5:
        bpy.ops.object.empty_add(location=(0.5, -1.0, 2.0))
        kind = random.choice(["COPY_LOCATION", "CHILD_OF", "COPY_TRANSFORMS", "TRACK_TO"])
        source.constraints.new(kind).target = bpy.context.object
    if random.random() < 0.5:
        source.delta_location, source.delta_rotation_euler = (0.3, -0.2, 0.1), (0.0, 0.0, 0.7)
    if random.random() < 0.5:
        home = bpy.data.collections.new("Home")
        home.objects.link(source)
        bpy.ops.object.collection_instance_add(collection="Home", location=(5.0, 0.0, 0.0))
    source.location, source.rotation_euler = (1.0, 2.0, 3.0), (0.4, 0.3, 0.2)
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    source.select_set(True)
    bpy.context.view_layer.objects.active = source


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ADD)
def test_what_users_add_and_place_stays_in_its_displayed_cage(kind, seed, tmp_path) -> None:
    random = Random(f"{kind} {seed}")
    ADD[kind]()
    source = bpy.context.object
    carried(random, source)
    assert bpy.ops.object.nested_cages_generate(levels="16, 8") == {"FINISHED"}
    name, cages = source.name, [f"{source.name} Cage {number}" for number in (1, 2)]
    end = bpy.context.scene.frame_current

    def check(*frames):
        for frame in frames:
            for cage in cages:
                check_enclosed(bpy.data.objects[name], bpy.data.objects[cage], frame)

    check(end)
    assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
    check(end, end + 40)
    source.location.x += random.uniform(-3.0, 3.0)
    check(end + 80)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "caged.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "caged.blend"))
    check(end)
    cage = bpy.data.objects[cages[1]]
    cage.location.x += 0.5
    cage.rotation_euler.z += 0.5
    check(end)


def test_a_drawing_in_two_scenes_has_no_ghost_in_the_other() -> None:
    source = wire("Drawing", [star()])
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(source)
    assert bpy.ops.object.nested_cages_generate(levels="12") == {"FINISHED"}
    assert [obj.name for obj in other.objects] == ["Drawing"]
    at_frame(3)
    assert not source.hide_viewport and not source.hide_render


def test_text_of_instances_and_hidden_strokes_are_read_as_displayed(addon) -> None:
    instanced = wire("Drawing", [star()])
    tree = bpy.data.node_groups.new("Text", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    letters, fill = tree.nodes.new("GeometryNodeStringToCurves"), tree.nodes.new("GeometryNodeFillCurve")
    letters.inputs["String"].default_value = "o"
    tree.links.new(letters.outputs[0], fill.inputs[0])
    tree.links.new(fill.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    instanced.modifiers.new("Text", "NODES").node_group = tree
    bpy.context.view_layer.update()
    (face,) = addon.scene.areas.areas_of(bpy.context, instanced)
    assert len(face.triangles) > 10 and np.ptp(face.points[:, 0]) < 1.0
    if hasattr(bpy.types, "GreasePencilDrawing"):
        drawn = grease_pencil("Strokes", [star(), star() * 0.5])
        for layer in drawn.data.layers:
            layer.opacity = 0.0
        with pytest.raises(addon.errors.UserError, match="no silhouette"):
            addon.scene.areas.areas_of(bpy.context, drawn)
