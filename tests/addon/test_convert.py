"""Objects of every kind to planar loops: against the object's own numbers and against geometry that is known."""

from __future__ import annotations

import math

import bmesh
import bpy
import numpy as np
import pytest
import shapely
from mathutils import Euler, Matrix

from support.drawings import (
    add,
    bezier_circle,
    circle,
    evaluated,
    grease_pencil,
    grid_face,
    hair,
    nurbs_circle,
    poly_curve,
    raised,
    snapshot,
    star,
    text,
    wire,
)


def read(addon, obj, **options):
    return addon.scene.convert.fine_drawing(
        addon.scene.convert.read(bpy.context, obj, addon.scene.convert.ReadingOptions(**options)),
        addon.scene.convert.ReadingOptions(**options),
    )


def area(drawing) -> float:
    """Area between the loops by shapely, in the world's unit."""
    shape = shapely.Polygon()
    for loop in sorted(map(shapely.Polygon, drawing.loops), key=lambda p: -p.area):
        shape = shape.symmetric_difference(loop)
    return shape.area * drawing.frame.scale**2


def world(drawing) -> np.ndarray:
    return np.concatenate([drawing.frame.to_world(loop) for loop in drawing.loops])


def test_a_poly_curve_is_read_with_its_own_numbers(addon) -> None:
    outer, hole = star(), circle(12, 0.3)
    drawing = read(addon, poly_curve("Poly", [outer, hole]))
    assert drawing.frame.own
    assert [len(loop) for loop in drawing.loops] == [60, 12]
    np.testing.assert_array_equal(drawing.loops[0], outer.astype(np.float32))
    np.testing.assert_array_equal(drawing.loops[1], hole.astype(np.float32))


def test_a_bezier_curve_has_the_points_that_blender_shows(addon) -> None:
    obj = bezier_circle("Bezier", radius=2.0, resolution=10)
    drawing = read(addon, obj)
    np.testing.assert_array_equal(drawing.loops[0], evaluated(obj)[:40, :2])
    assert area(drawing) == pytest.approx(4.0 * math.pi, rel=1e-2)


def test_resolution_changes_the_reading_but_not_the_curve(addon) -> None:
    obj = bezier_circle("Bezier", resolution=4)
    obj.data.bevel_depth = 0.1
    bpy.context.view_layer.update()
    before = snapshot()
    assert len(read(addon, obj, resolution=25).loops[0]) == 100
    assert obj.data.resolution_u == 4 and obj.data.splines[0].resolution_u == 4
    assert snapshot() == before


def test_a_nurbs_curve_is_closed(addon) -> None:
    drawing = read(addon, nurbs_circle("Nurbs"))
    assert len(drawing.loops) == 1
    assert 1.0 < area(drawing) < math.pi


@pytest.mark.parametrize("change", ["bevel", "extrude", "bevel object", "fill", "3D", "taper"])
def test_what_gives_a_curve_thickness_does_not_count(addon, change) -> None:
    obj = poly_curve("Curve", [star(), circle(12, 0.3)])
    plain = read(addon, obj)
    data = obj.data
    match change:
        case "bevel":
            data.bevel_depth = 0.1
        case "extrude":
            data.extrude = 0.2
        case "bevel object":
            data.bevel_mode = "OBJECT"
            data.bevel_object = poly_curve("Profile", [circle(5, 0.1)])
        case "fill":
            data.fill_mode = "BOTH"
        case "3D":
            data.dimensions = "3D"
        case "taper":
            data.bevel_depth = 0.1
            data.taper_object = poly_curve("Taper", [circle(5, 0.1)], cyclic=False)
    drawing = read(addon, obj)
    for loop, expected in zip(drawing.loops, plain.loops, strict=True):
        np.testing.assert_array_equal(loop, expected)


def test_modifiers_of_a_curve_count(addon) -> None:
    obj = poly_curve("Curve", [circle()])
    modifier = obj.modifiers.new("Cast", "CAST")
    modifier.cast_type = "CUBOID"
    modifier.factor = 0.5
    assert area(read(addon, obj)) > area(read(addon, poly_curve("Plain", [circle()]))) * 1.01


def test_modifiers_of_a_mesh_count(addon) -> None:
    obj = grid_face("Grid", cells=1)
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 2
    drawing = read(addon, obj)
    assert len(drawing.loops[0]) == 16
    assert area(drawing) < 1.0


def test_wire_loops_keep_their_points(addon) -> None:
    drawing = read(addon, wire("Wire", [circle(10), circle(5, 0.2)]))
    np.testing.assert_array_equal(drawing.loops[0], circle(10).astype(np.float32))
    assert len(drawing.loops[1]) == 5


def test_only_the_boundary_of_faces_is_read(addon) -> None:
    drawing = read(addon, grid_face("Grid", cells=4))
    assert [len(loop) for loop in drawing.loops] == [16]
    assert area(drawing) == pytest.approx(1.0)


def test_a_text_is_read_without_its_fill(addon) -> None:
    obj = text("Text", "do")
    obj.data.extrude = 0.1
    drawing = read(addon, obj)
    assert len(drawing.loops) == 4
    assert area(drawing) > 0.1


@pytest.mark.parametrize("make", [hair, grease_pencil])
def test_curves_without_a_mesh_of_their_own_are_read(addon, make) -> None:
    obj = make("Strokes", [star(), circle(12, 0.3)])
    obj.location = (1.0, 2.0, 3.0)
    bpy.context.view_layer.update()
    before = snapshot()
    drawing = read(addon, obj)
    assert snapshot() == before
    np.testing.assert_array_equal(drawing.loops[0], star().astype(np.float32))
    hole = circle(12, 0.3).astype(np.float32)  # the other way round if it was united
    assert len(drawing.loops[1]) == 12 and {tuple(p) for p in drawing.loops[1]} == {tuple(p) for p in hole}
    assert drawing.frame.own and tuple(drawing.frame.matrix[:3, 3]) == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("make, problem", [(hair, "is open: join the ends"), (grease_pencil, "has no area")])
def test_open_strokes_are_refused_or_closed(addon, make, problem) -> None:
    obj = make("Strokes", [star()], cyclic=False)
    with pytest.raises(addon.errors.UserError, match=f"'Strokes' {problem}"):
        read(addon, obj)
    assert len(read(addon, obj, close_open=True).loops[0]) == 60


def test_layers_of_a_grease_pencil_count_where_they_are(addon) -> None:
    obj = grease_pencil("Strokes", [star()])
    obj.data.layers[0].translation = (2.0, 0.0, 0.5)
    np.testing.assert_allclose(world(read(addon, obj)), raised(star() + np.array([2.0, 0.0]), 0.5), atol=1e-6)


def test_smooth_hair_has_the_points_that_blender_shows(addon) -> None:
    obj = hair("Hair", [circle(8)], kind="CATMULL_ROM")
    drawing = read(addon, obj)
    assert len(drawing.loops[0]) > 8
    assert area(drawing) == pytest.approx(math.pi, rel=1e-2)
    assert len(read(addon, obj, resolution=20).loops[0]) == 160


def in_edit_mode(obj, select):
    """Goes to Edit Mode with exactly the faces selected for whose middle `select` is true."""
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(obj.data)
    mesh.select_mode = {"FACE"}
    for face in mesh.faces:
        face.select_set(select(face.calc_center_median()))
    mesh.select_flush_mode()
    bmesh.update_edit_mesh(obj.data)


def test_in_edit_mode_the_border_of_the_selected_faces_is_read(addon) -> None:
    obj = grid_face("Grid", cells=4)
    in_edit_mode(obj, lambda middle: 0.25 < middle.x < 0.75 and middle.y < 0.75)
    drawing = read(addon, obj)
    assert [len(loop) for loop in drawing.loops] == [10]
    assert area(drawing) == pytest.approx(0.5 * 0.75)


def test_in_edit_mode_selected_loops_are_read(addon) -> None:
    obj = wire("Wire", [circle(10), circle(6, 0.2)])
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(obj.data)
    for edge in mesh.edges:
        edge.select_set(edge.index < 10)
    assert [len(loop) for loop in read(addon, obj).loops] == [10]
    for edge in mesh.edges:
        edge.select_set(False)
    with pytest.raises(addon.errors.UserError, match="'Wire' is in Edit Mode without selected edges"):
        read(addon, obj)


def test_objects_that_share_data_and_linked_objects_are_read(addon, tmp_path) -> None:
    first = poly_curve("First", [circle(20)])
    second = add("Second", first.data)
    second.location = (3.0, 0.0, 0.0)
    np.testing.assert_allclose(world(read(addon, second)), raised(circle(20, 1.0, (3.0, 0.0))), atol=1e-6)
    path = str(tmp_path / "library.blend")
    wire("Mesh", [circle(7)])
    bpy.data.libraries.write(path, set(bpy.data.objects))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (available, wanted):
        wanted.objects = available.objects
    for obj in wanted.objects:
        bpy.context.scene.collection.objects.link(obj)
        assert obj.library
    bpy.context.view_layer.update()
    before = snapshot()
    assert [len(read(addon, obj).loops[0]) for obj in sorted(wanted.objects, key=lambda o: o.name)] == [20, 7, 20]
    assert snapshot() == before


def test_doubled_points_are_merged(addon) -> None:
    loop = np.repeat(circle(12), 2, axis=0)
    loop[3] += 1e-9
    drawing = read(addon, poly_curve("Doubled", [np.vstack([loop, loop[:1]])]))
    assert len(drawing.loops[0]) == 12


@pytest.mark.parametrize("height", [0.0, 0.7, -1e4])
def test_a_flat_mesh_at_any_height_keeps_its_frame(addon, height) -> None:
    obj = wire("Wire", [raised(circle(10), height)])
    drawing = read(addon, obj)
    assert drawing.frame.own
    assert drawing.frame.height == np.float32(height)


MATRICES = {
    "moved": Matrix.Translation((1.0, -2.0, 3.0)),
    "turned": Matrix.Translation((1.0, -2.0, 3.0)) @ Euler((0.4, 1.0, -2.0)).to_matrix().to_4x4(),
    "scaled": Euler((0.4, 1.0, -2.0)).to_matrix().to_4x4() @ Matrix.Scale(2.5, 4),
    "stretched": Euler((0.4, 1.0, -2.0)).to_matrix().to_4x4() @ Matrix.Diagonal((2.0, 0.5, 3.0, 1.0)),
    "mirrored": Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0)),
    "sheared": Matrix(((1.0, 0.5, 0.2, 0.0), (0.0, 1.0, 0.4, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))),
    "tiny": Matrix.Scale(1e-4, 4),
}


@pytest.mark.parametrize("name", MATRICES)
def test_a_drawing_lies_where_its_object_does(addon, name) -> None:
    obj = poly_curve("Curve", [star(), circle(12, 0.3)])
    obj.matrix_world = MATRICES[name]
    drawing = read(addon, obj)
    assert drawing.frame.own == (name in {"moved", "turned", "scaled", "tiny"})
    local = np.concatenate([raised(star()), raised(circle(12, 0.3))]).astype(np.float32).astype(float)
    matrix = np.array(obj.matrix_world, dtype=float)
    expected = local @ matrix[:3, :3].T + matrix[:3, 3]
    scale = np.linalg.norm(np.ptp(expected, axis=0))
    np.testing.assert_allclose(world(drawing), expected, atol=2e-7 * scale)
    assert np.linalg.det(drawing.frame.matrix[:3, :3]) > 0.0


def test_parents_count(addon) -> None:
    parent = add("Parent", None, select=False)
    parent.location = (5.0, 0.0, 0.0)
    parent.scale = (2.0, 2.0, 2.0)
    obj = poly_curve("Curve", [circle(10)])
    obj.parent = parent
    drawing = read(addon, obj)
    np.testing.assert_allclose(world(drawing), raised(circle(10)) * 2.0 + (5.0, 0.0, 0.0), atol=1e-6)


def test_the_object_behind_a_fitted_plane_may_be_upright(addon) -> None:
    obj = wire("Wire", [np.column_stack([np.zeros(10), circle(10)])])
    drawing = read(addon, obj)
    assert not drawing.frame.own
    assert area(drawing) == pytest.approx(shapely.Polygon(circle(10)).area, rel=1e-5)


def test_several_drawings_share_the_frame_of_the_first(addon) -> None:
    fine = poly_curve("Fine", [circle(40)])
    fine.matrix_world = MATRICES["turned"]
    coarse = wire("Coarse", [circle(8, 0.5)])
    coarse.matrix_world = MATRICES["turned"] @ Matrix.Scale(2.0, 4) @ Matrix.Translation((0.1, 0.0, 0.0))
    drawing = read(addon, fine)
    shared = addon.scene.convert.drawing_in(drawing.frame, addon.scene.convert.read(bpy.context, coarse))
    np.testing.assert_allclose(shared.loops[0], circle(8, 1.0, (0.2, 0.0)), atol=1e-6)


def bent(addon) -> None:
    loop = raised(circle(20))
    loop[3, 2] = 0.25
    return wire("Bent", [loop])


REFUSALS = {
    "open spline": (lambda _: poly_curve("Open", [circle()], cyclic=False), "'Open' is open: make its spline 1"),
    "open mesh line": (lambda _: wire("Line", [circle(8)], cyclic=False), "'Line' is open: join the ends"),
    "not planar": (bent, "'Bent' does not lie in one plane"),
    "no outline": (lambda _: add("Points", bpy.data.meshes.new("Points")), "'Points' has no outline"),
    "too few points": (lambda _: poly_curve("Two", [circle(2)]), "'Two' has a loop with fewer than three"),
    "unknown kind": (lambda _: add("Lamp", bpy.data.lights.new("Lamp", "POINT")), "'Lamp' is of a kind"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_a_refusal_names_the_object_and_leaves_everything(addon, name) -> None:
    make, sentence = REFUSALS[name]
    obj = make(addon)
    bpy.context.view_layer.update()
    before = snapshot()
    with pytest.raises(addon.errors.UserError, match="^" + sentence.replace("(", r"\(")):
        read(addon, obj)
    assert snapshot() == before


def test_a_branching_mesh_is_refused_with_the_place(addon) -> None:
    mesh = bpy.data.meshes.new("Theta")
    mesh.from_pydata(
        [*raised(circle(6)).tolist(), (0.0, 0.0, 0.0)], [(i, (i + 1) % 6) for i in range(6)] + [(0, 6), (6, 3)], []
    )
    with pytest.raises(addon.errors.UserError, match=r"'Theta' branches at \(1, 0, 0\)"):
        read(addon, add("Theta", mesh))


def test_open_lines_are_closed_on_request(addon) -> None:
    drawing = read(addon, poly_curve("Open", [circle(12)], cyclic=False), close_open=True)
    assert len(drawing.loops[0]) == 12


def test_a_bent_drawing_is_projected_on_request(addon) -> None:
    drawing = read(addon, bent(addon), project=True)
    assert len(drawing.loops[0]) == 20


@pytest.mark.skipif(bpy.app.version >= (4, 3), reason="converted when the file is opened")
def test_the_older_grease_pencil_is_told() -> None:
    bpy.ops.object.gpencil_add(type="STROKE")
    for run in ("generate", "silhouette", "suggest_bones"):
        with pytest.raises(
            RuntimeError, match=r"is a Grease Pencil of the kind before Blender 4\.3: open the file there"
        ):
            getattr(bpy.ops.object, f"nested_cages_{run}")()
