"""Cages lie around the drawing as Blender displays it: whatever adds, places, moves and deforms it."""

from random import Random

import bpy
import numpy as np
import pytest
import shapely

from support import drawings
from support.drawings import at_frame, bind, choose, evaluated, generate, in_world, made, star, text, wire
from support.marks import slow_after
from support.panels import draw


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


@pytest.mark.parametrize("kind", slow_after(2, KINDS))
def test_cages_lie_and_stay_around_what_is_displayed(kind) -> None:
    KINDS[kind]()
    source = bpy.context.object
    generate("12")
    cage = drawings.set_of(source).cages[0]
    end = bpy.context.scene.frame_current
    check_enclosed(source, cage, end)
    source.delta_location.x, source.delta_scale = 0.7, (1.5, 1.5, 1.5)
    if source.parent is None:
        source.constraints.new("COPY_LOCATION").target = bpy.data.objects.new("There", None)
    for frame in (end, end + 50):
        check_enclosed(source, cage, frame)
    generate("12")
    assert [len(obj.constraints) for obj in (cage, source)] in ([1, 1], [0, 0])
    check_enclosed(source, cage, end)
    assert drawings.verify(cage)


@pytest.mark.slow
def test_path_animation_switched_on_later_moves_no_cage() -> None:
    bezier()
    source = bpy.context.object
    source.data.use_path = False
    generate("12")
    bind()
    cage = bpy.data.objects[f"{source.name} Cage 1"]
    assert cage.parent == source
    source.data.use_path = True
    for frame in (100, 150):
        check_enclosed(source, cage, frame)
    source.location.x += 2.0
    check_enclosed(source, cage, 150)
    assert cage.matrix_world == source.matrix_world


def bent(obj):
    obj.modifiers.new("Bend", "SIMPLE_DEFORM").angle = 2.0


CHANGES = {
    "longer": lambda obj: setattr(obj.data, "body", "Hello"),
    "no letters": lambda obj: setattr(obj.data, "body", ""),
    "size": lambda obj: setattr(obj.data, "size", 1.5),
    "modifier": bent,
}


@pytest.mark.parametrize("bound", slow_after(1, [True, False]))
@pytest.mark.parametrize("change", slow_after(2, CHANGES))
def test_the_panel_says_that_a_drawing_changed_until_it_is_as_before(change, bound, tmp_path) -> None:
    source = text("Word", "Hi")
    bpy.ops.ed.undo_push(message="text")
    generate("40, 20")
    outer = made("Word")[2]
    if bound:
        bind()
        outer.location.x += 0.1
    bpy.ops.ed.undo_push(message="cages")
    assert not changed()
    CHANGES[change](source)
    assert changed()
    bpy.ops.ed.undo_push(message="changed")
    bpy.ops.ed.undo()
    assert not changed()
    bpy.ops.ed.redo()
    assert changed()
    drawings.save(tmp_path / "changed.blend", again=True)
    assert changed()
    source = bpy.data.objects["Word"]
    source.data.body, source.data.size = "Hi", 1.0
    if "Bend" in source.modifiers:
        source.modifiers.remove(source.modifiers["Bend"])
    assert not changed()


def changed() -> bool:
    """Whether the panel says of a drawing that it has changed."""
    return "Drawing changed" in draw()


@pytest.mark.slow
@pytest.mark.parametrize("bound", slow_after(1, [True, False], thorough_after=1))
@pytest.mark.parametrize("add", [bezier, lambda: wire("Drawing", [star()])])
def test_a_transform_that_is_applied_moves_no_cage(add, bound, tmp_path) -> None:
    add()
    source = bpy.context.object
    source.scale, source.rotation_euler, source.location = (2.0, 2.0, 2.0), (0.1, 0.2, 0.3), (1.0, 2.0, 3.0)
    generate("16, 8")
    name, end = source.name, bpy.context.scene.frame_current
    if bound:
        bind()
    else:
        drawings.save(tmp_path / "caged.blend", again=True)
    source, *cages = (bpy.data.objects[name + ending] for ending in ("", " Cage 1", " Cage 2"))
    choose(source)
    bpy.ops.object.transform_apply()
    for cage in cages:
        check_enclosed(source, cage, end)
    if bound:
        for point in cages[1].data.vertices:
            point.co.x += 0.3 * point.co.y
    source.location.x += 1.0
    for cage in cages:
        check_enclosed(source, cage, end)


@pytest.mark.parametrize("seed", slow_after(1, range(4)))
@pytest.mark.parametrize("thick", [{}, {"offset": 0.1}, {"bevel_depth": 0.1}, {"bevel_depth": 0.03, "extrude": 0.2}])
def test_curves_and_texts_are_caged_by_what_they_show_in_viewport_and_renders(thick, seed) -> None:
    random = Random(seed)
    source = [lambda: text("Drawing", random.choice("Rag&S")), lambda: drawings.bezier_circle("Drawing")][seed % 2]()
    if source.type == "CURVE":
        source.data.dimensions = random.choice(["2D", "3D"])
        for point in source.data.splines[0].bezier_points:
            point.co.x *= random.uniform(0.5, 2.0)
            point.co.y += random.uniform(-0.4, 0.4)
    source.data.resolution_u, source.data.render_resolution_u = random.randint(2, 8), random.choice([0, 1, 20])
    for name, value in thick.items():
        setattr(source.data, name, value)
    source.scale, source.rotation_euler = (random.choice([-1.0, 1.0]), random.uniform(0.5, 2.0), 1.0), (0.4, 0.3, 0.2)
    generate("16")
    cage = drawings.set_of(source).cages[0]
    for resolution in (source.data.resolution_u, source.data.render_resolution_u, 64 * (not thick)):
        source.data.resolution_u = resolution or source.data.resolution_u
        depsgraph = at_frame(drawings.end_of(cage))
        back = np.linalg.inv(np.array(cage.matrix_world)) @ np.array(source.matrix_world)
        flat = evaluated(source, depsgraph) @ back[:2, :3].T + back[:2, 3]
        mesh = source.evaluated_get(depsgraph).to_mesh()
        mesh.calc_loop_triangles()
        shapes = shapely.polygons(flat[[list(each.vertices) for each in mesh.loop_triangles]].reshape(-1, 3, 2))
        lines = shapely.linestrings(flat[[list(edge.vertices) for edge in mesh.edges]])
        source.evaluated_get(depsgraph).to_mesh_clear()
        region = drawings.solid(cage, depsgraph)
        assert shapely.covers(region, lines).all() and shapely.covers(region, shapes[shapely.area(shapes) > 0]).all()
    bind()
    assert drawings.verify(cage)


ADD = {
    "bezier circle": bpy.ops.curve.primitive_bezier_circle_add,
    "nurbs circle": bpy.ops.curve.primitive_nurbs_circle_add,
    "text": bpy.ops.object.text_add,
    "plane": bpy.ops.mesh.primitive_plane_add,
    "circle": bpy.ops.mesh.primitive_circle_add,
    "grid": bpy.ops.mesh.primitive_grid_add,
    "stroke": lambda: drawings.grease_pencil("Stroke", [star()]),  # those of the menu are open and cross themselves
}


def carried(random, source):
    """Gives an object a parent that moves, a constraint and a delta, some of these."""
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
    source.location, source.rotation_euler = (1.0, 2.0, 3.0), (0.4, 0.3, 0.2)
    choose(source)


@pytest.mark.parametrize("seed", slow_after(0, range(3), thorough_after=1))
@pytest.mark.parametrize("kind", slow_after(0, ADD, thorough_after=3))
def test_what_users_add_and_place_stays_in_its_displayed_cage(kind, seed, tmp_path) -> None:
    random = Random(f"{kind} {seed}")
    ADD[kind]()
    source = bpy.context.object
    carried(random, source)
    generate("16, 8")
    name, cages = source.name, [f"{source.name} Cage {number}" for number in (1, 2)]
    end = bpy.context.scene.frame_current

    def check(*frames):
        for frame in frames:
            for cage in cages:
                check_enclosed(bpy.data.objects[name], bpy.data.objects[cage], frame)

    check(end)
    bind()
    check(end, end + 40)
    source.location.x += random.uniform(-3.0, 3.0)
    check(end + 80)
    drawings.save(tmp_path / "caged.blend", again=True)
    check(end)
    cage = bpy.data.objects[cages[1]]
    cage.location.x += 0.5
    cage.rotation_euler.z += 0.5
    check(end)


def test_a_drawing_in_two_scenes_has_no_ghost_in_the_other() -> None:
    source = wire("Drawing", [star()])
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(source)
    generate("12")
    assert [obj.name for obj in other.objects] == ["Drawing"]
    at_frame(3)
    assert not source.hide_viewport and not source.hide_render
    with bpy.context.temp_override(scene=other, view_layer=other.view_layers[0]):
        other.view_layers[0].objects.active = source
        source.select_set(True, view_layer=other.view_layers[0])
        generate("10")
    assert {"Drawing Fine", "Drawing Cage 1"} <= {obj.name for obj in other.objects}  # one set, shown in both


def word(obj, fill):
    """Makes an object display letters by Geometry Nodes, as instances."""
    tree = bpy.data.node_groups.new("Text", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    letters, filled = tree.nodes.new("GeometryNodeStringToCurves"), tree.nodes.new("GeometryNodeFillCurve")
    letters.inputs["String"].default_value = "oi"
    tree.links.new(letters.outputs[0], filled.inputs[0])
    tree.links.new((filled if fill else letters).outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    obj.modifiers.new("Text", "NODES").node_group = tree
    bpy.context.view_layer.update()


@pytest.mark.parametrize("fill", [True, False])
@pytest.mark.parametrize("kind", slow_after(0, ["wire", "text", "bezier"], thorough_after=1))
def test_instances_of_nodes_are_read_as_displayed(kind, fill) -> None:
    drawing = {"wire": lambda: wire("Drawing", [star()]), "text": lambda: text("Drawing", "x"), "bezier": bezier}
    drawing[kind]()
    source = bpy.context.object
    word(source, fill)
    generate("24, 16")
    fine, outer, _ = made(source.name)
    assert len(shapely.get_rings(shapely.get_parts(drawings.solid(fine)))) == 4  # two letters, two holes
    assert np.ptp(drawings.base(fine)[:, 0]) == pytest.approx(0.8, abs=0.2) and np.ptp(evaluated(outer)[:, 0]) < 1.2
    bind()
    assert drawings.verify(outer)


@pytest.mark.slow
def test_the_silhouette_of_an_instance_leaves_cages_out() -> None:
    drawings.gathered("Home", wire("Drawing", [star()]))
    for operator in (bpy.ops.object.nested_cages_generate, bpy.ops.object.nested_cages_bind):
        assert operator() == {"FINISHED"}
    bpy.ops.object.collection_instance_add(collection="Home", location=(5.0, 0.0, 0.0))
    assert bpy.ops.object.nested_cages_import(outlines="SELECTED") == {"FINISHED"}
    assert len(bpy.context.object.data.vertices) == 60
