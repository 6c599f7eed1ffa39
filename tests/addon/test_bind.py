"""Binding: at rest nothing moves, a posed cage moves the drawing, unbinding takes it all back, files need no add-on."""

import subprocess
import sys

import bpy
import numpy as np
import pytest
import shapely

from support import drawings
from support.blender import refused
from support.drawings import at_frame, base, bind, circle, evaluated, generate, lines, poly_curve, put, star, wire
from support.marks import slow_after

pytestmark = pytest.mark.slow

ROTATION = np.array([[0.8, -0.6], [0.6, 0.8]])


def bound(draw=poly_curve, levels="24, 12", **values):
    """A drawing with bound cages: its source, collection, fine mesh and cages."""
    source = draw("Drawing", [star() * 2.0, circle(20, 0.5)])
    source.location = (1.0, 2.0, 0.5)
    source.rotation_euler = (0.3, 0.2, 0.1)
    generate(levels)
    bind(**values)
    return members(source)


def members(source):
    fine, *cages = drawings.made(source.name)
    return source, bpy.data.collections["Drawing Cages"], fine, cages


def turned(points):
    """Points (n, 3) turned and stretched in their own x and y."""
    moved = points.copy()
    moved[:, :2] = points[:, :2] @ (ROTATION @ np.diag([1.5, 0.8])).T + (0.3, -0.2)
    return moved


EXACT = ("AUTO", "LINEAR")


def test_a_cage_that_fills_a_hole_moves_what_is_in_it() -> None:
    source = poly_curve("Drawing", [star(120), circle(40, 0.35), circle(24, 0.1, (0.55, 0.0))])
    generate("48, 12")
    fine, _, last = (bpy.data.objects[f"Drawing {name}"] for name in ("Fine", "Cage 1", "Cage 2"))
    assert len(shapely.get_rings(shapely.get_parts(drawings.solid(last)))) < len(
        shapely.get_rings(shapely.get_parts(drawings.solid(fine)))
    )
    drawings.choose(source)
    bind()
    before = evaluated(fine)
    for vertex in last.data.vertices:
        vertex.co.x += 0.5
    last.data.update()
    np.testing.assert_allclose(evaluated(fine) - before, np.tile((0.5, 0.0, 0.0), (len(before), 1)), atol=1e-5)


@pytest.mark.parametrize("method", EXACT)
def test_the_drawing_follows_affine_poses_through_all_levels(method) -> None:
    _, _, fine, cages = bound(method=method)
    assert np.abs(evaluated(fine) - base(fine)).max() <= 1e-5 * 4
    put(cages[-1], turned(base(cages[-1])))
    for obj in (fine, cages[0]):
        assert np.abs(evaluated(obj) - turned(base(obj))).max() <= 2e-5


def test_a_bent_cage_moves_the_drawing_by_harmonic_coordinates(core) -> None:
    _, _, fine, (cage,) = bound(poly_curve, "6")
    rest, off = base(cage), np.zeros((6, 3))
    off[2] = (0.6, 0.4, 0.0)
    weights = core.cage_coordinates(base(fine)[:, :2], core.Mesh.from_loops([rest[:, :2]]))
    put(cage, rest + off)
    assert np.abs(evaluated(fine) - base(fine) - weights @ off).max() < 0.01


@pytest.mark.parametrize("method", ["HARMONIC", "LINEAR"])
def test_edits_of_a_finer_cage_turn_with_the_coarser_one(method) -> None:
    _, _, fine, cages = bound(method=method)
    finer, coarser = cages
    edited = base(finer)
    edited[:, :2] += 0.1 * np.sin(edited[:, 1::-1])
    edited[:, 2] += 0.02 * np.cos(3.0 * edited[:, 0])
    put(finer, edited)
    bent, detailed = evaluated(fine), evaluated(finer)
    turn = np.eye(3)
    turn[:2, :2] = ROTATION
    put(coarser, base(coarser) @ turn.T + (0.3, -0.2, 0.0))
    for obj, before in ((finer, detailed), (fine, bent)):
        assert np.abs(evaluated(obj) - (before @ turn.T + (0.3, -0.2, 0.0))).max() < 1e-5


@pytest.mark.parametrize("draw", [poly_curve, wire])
def test_the_original_follows(draw) -> None:
    source, _, fine, cages = bound(draw)
    area_before = lines(fine).length
    put(cages[-1], turned(base(cages[-1])))
    assert lines(fine).length != pytest.approx(area_before, rel=1e-3)
    points, mine = drawings.in_world(source, evaluated(source)), drawings.in_world(fine, evaluated(fine))
    distance = np.linalg.norm(points[:, None] - mine[None], axis=2)
    assert distance.min(axis=1).max() < 1e-4
    assert distance.min(axis=0).max() < 1e-4


def subdivided():
    source = wire("Drawing", [circle(40)[:20] + np.array((0.0, 0.3))])
    source.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    return source


def thick():
    source = drawings.bezier_circle("Drawing")
    source.data.bevel_depth = 0.05
    return source


@pytest.mark.parametrize("draw", [subdivided, thick])
def test_an_original_of_which_more_is_shown_than_its_outline_follows(draw) -> None:
    source = draw()
    own = [modifier.name for modifier in source.modifiers]
    generate("8")
    bind()
    *_, (cage,) = members(source)
    before = evaluated(source)
    put(cage, base(cage) + np.array((0.5, 0.0, 0.0)))
    assert np.abs(evaluated(source) - before - (0.5, 0.0, 0.0)).max() < 5e-5
    bpy.ops.object.nested_cages_bind(action="UNBIND")
    assert [modifier.name for modifier in source.modifiers] == own


def parts():
    """Modifiers, visibility and meshes by name of all objects but the moving copy, which is made anew."""
    objects = [obj for obj in bpy.data.objects if "Moving" not in obj.name]
    return {obj.name: (tuple(m.name for m in obj.modifiers), obj.hide_render, obj.data.name) for obj in objects}


@pytest.mark.parametrize("draw", [poly_curve, wire])
def test_unbinding_takes_it_all_back(draw) -> None:
    source = draw("Drawing", [star() * 2.0])
    generate("24, 12", thickness=0.02)
    _, _, fine, cages = members(source)
    bpy.context.view_layer.objects.active = fine
    bpy.context.scene.frame_set(1)
    objects = parts()
    meshes, shown = len(bpy.data.meshes), [evaluated(obj, at_frame(9)) for obj in (fine, *cages)]
    bpy.context.scene.frame_set(1)
    bind()
    put(cages[-1], turned(base(cages[-1])))
    cages[-1].location.x += 1.0
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    after = parts()
    assert after == objects
    assert len(bpy.data.meshes) == meshes
    for obj, before in zip((fine, *cages), shown, strict=True):
        np.testing.assert_array_equal(evaluated(obj, at_frame(9)), before)
    with refused():
        bpy.ops.object.nested_cages_bind(action="UNBIND")
    put(cages[-1], 0.1 * base(cages[-1]))
    with refused(unchanged=False):
        bind()
    assert all(tree.users for tree in bpy.data.node_groups)


def test_rebinding_takes_the_cage_as_it_is() -> None:
    _, _, fine, cages = bound(levels="12")
    rest = base(fine)
    wider = base(cages[0])
    wider[np.linalg.norm(wider, axis=1) > 1.0] *= 1.3
    put(cages[0], wider)
    assert np.abs(evaluated(fine) - rest).max() > 0.1
    assert bpy.ops.object.nested_cages_bind(action="REST_FROM_POSE") == {"FINISHED"}
    assert np.abs(evaluated(fine) - rest).max() < 1e-5


@pytest.mark.parametrize("out_of_plane", slow_after(1, [True, False]))
def test_a_cage_that_no_longer_encloses_or_left_its_plane_is_refused(out_of_plane) -> None:
    _, _, fine, (cage,) = bound(levels="12")
    if out_of_plane:
        cage.location.z += 1.0
    else:
        put(cage, base(cage) * (0.7, 0.7, 1.0))
    shape = evaluated(fine)
    with refused():
        bpy.ops.object.nested_cages_bind(action="REST_FROM_POSE")
    np.testing.assert_array_equal(evaluated(fine), shape)


def test_unbinding_hides_what_was_hidden_before_and_nothing_else() -> None:
    source = poly_curve("Drawing", [star()])
    generate("24, 12, 6")
    bpy.ops.object.nested_cages_remove_animation()  # its keyframes would set again what they hide
    _, _, fine, cages = members(source)
    fine.hide_set(True)
    cages[0].hide_render = True
    cages[1].hide_viewport = True

    def hidden():
        return [(obj.hide_render, obj.hide_viewport, obj.hide_get()) for obj in (fine, *cages)]

    before = hidden()
    bind()
    assert hidden() != before
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    assert hidden() == before


OPENED = """
import sys, bpy, numpy as np
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
assert not hasattr(bpy.types.Scene, "nested_cages")
def shape(name):
    mesh = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    return points
names = ["Drawing", "Drawing Fine", "Drawing Cage 1"]
before = [shape(name) for name in names]
cage = bpy.data.objects["Drawing Cage 2"]
for vertex in cage.data.vertices:
    vertex.co.x += 0.75
cage.data.update()
for name, rest in zip(names, before):
    print(name, len(rest), np.abs(shape(name) - rest - (0.75, 0.0, 0.0)).max() < 1e-5)
"""


@pytest.mark.parametrize(("draw", "method"), [(poly_curve, "AUTO"), (wire, "LINEAR")])
def test_a_saved_file_moves_without_the_add_on(draw, method, tmp_path) -> None:
    bound(draw, method=method)
    command = [sys.executable, "-c", OPENED, drawings.save(tmp_path / "bound.blend")]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("True") == 3, done.stdout


def displayed(obj):
    """The displayed edges of an object in its own space, by shapely."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    lines = [[mesh.vertices[v].co[:2] for v in edge.vertices] for edge in mesh.edges]
    return shapely.multilinestrings([np.array(line) for line in lines])


def shown(obj):
    """Corners (2, 2) of the displayed bounding box in the object's own space, and the number of vertices."""
    points = evaluated(obj)[:, :2]
    return np.array([points.min(axis=0), points.max(axis=0)]), len(points)


def shape_key(source):
    source.shape_key_add(name="Basis")
    key = source.shape_key_add(name="Wide")
    key.points.foreach_set("co", (base(source) * (1.02, 0.9, 1.0)).ravel())
    key.value = 1.0


def simple_deform(source):
    modifier = source.modifiers.new("Bend", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis, modifier.factor = "TAPER", "X", 0.5
    source.modifiers.move(1, 0)


def doubled_vertex(source):
    put(source, np.where(np.arange(len(source.data.vertices))[:, None] == 0, 2.0, 1.0) * base(source))


def size(source):
    source.data.size *= 0.5


def body(source):
    source.data.body = "Hello"


@pytest.mark.parametrize(
    "edit", slow_after(2, [shape_key, simple_deform, doubled_vertex, size, body], thorough_after=3)
)
def test_a_bound_drawing_plays_its_own_changes_before_the_bend(edit) -> None:
    source = drawings.text("Drawing", "Hi") if edit in (size, body) else wire("Drawing", [star()])
    generate("24, 12")
    bind()
    cage = bpy.context.object
    put(cage, base(cage) * (1.0, 2.0, 1.0))
    before, _ = shown(source)
    edit(source)
    bpy.context.view_layer.update()
    source.modifiers["Nested Cages Follow"].show_viewport = False
    own, count = shown(source)
    source.modifiers["Nested Cages Follow"].show_viewport = True
    after, bent = shown(source)
    np.testing.assert_allclose(after, own * (1.0, 2.0), atol=2e-4)
    assert np.abs(after - before).max() > 0.01
    assert bent == count
    bpy.context.view_layer.objects.active = cage
    drawings.verify()
    finest = bpy.data.objects["Drawing Cage 1"]
    drawn, around = (shapely.polygonize(shapely.get_parts(shapely.node(displayed(o)))) for o in (source, finest))
    inside = shapely.contains_properly(shapely.unary_union(around), shapely.unary_union(drawn))
    assert drawings.holds(finest) == inside
