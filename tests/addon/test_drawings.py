"""Every kind of drawing: the cages are the core's own, around the lines that Blender shows."""

import re

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from support import drawings
from support.blender import refused
from support.drawings import add, certificate, circle, evaluated, generate, made, poly_curve, raised, star, text, wire

SHEAR = Matrix(((1.0, 0.5, 0.2, 0.0), (0.0, 1.0, 0.4, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
TURN = Euler((0.4, 1.0, -2.0)).to_matrix().to_4x4()


def changed(obj, **properties):
    """The object with some properties of its data set."""
    for name, value in properties.items():
        setattr(obj.data, name, value)
    return obj


def modified(obj, kind, **properties):
    """The object with a modifier."""
    modifier = obj.modifiers.new(kind, kind)
    for name, value in properties.items():
        setattr(modifier, name, value)
    return obj


def placed(obj, matrix):
    obj.matrix_world = matrix
    return obj


def child(obj):
    parent = add("Parent", None, select=False)
    parent.matrix_world = Matrix.Translation((5.0, 0.0, 1.0)) @ Matrix.Scale(2.0, 4) @ TURN
    obj.parent = parent
    return obj


def shared():
    first = poly_curve("First", [star()])
    first.select_set(False)
    return placed(add("Drawing", first.data), Matrix.Translation((3.0, 0.0, 0.0)))


def svg(folder):
    path = folder / "drawing.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">'
        '<path d="M10 10 C 40 0 60 0 90 10 L 90 90 L 10 90 Z M 30 30 L 30 60 L 60 60 Z"/></svg>',
        encoding="utf-8",
    )
    bpy.ops.preferences.addon_enable(module="io_curve_svg")
    bpy.ops.import_curve.svg(filepath=str(path))
    (obj,) = bpy.data.objects
    drawings.choose(obj)
    return obj


def linked(folder):
    path = str(folder / "library.blend")
    poly_curve("Drawing", [star()])
    bpy.data.libraries.write(path, set(bpy.data.objects))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (available, wanted):
        wanted.objects = available.objects
    (obj,) = wanted.objects
    bpy.context.scene.collection.objects.link(obj)
    drawings.choose(obj)
    return obj


def edited():
    """A mesh in Edit Mode with one of its two loops selected."""
    obj = wire("Drawing", [star(), circle(8, 3.0)])
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(obj.data)
    for edge in mesh.edges:
        edge.select_set(edge.index < 60)
    bmesh.update_edit_mesh(obj.data)
    return obj


def faces_in_edit_mode():
    """A grid of faces in Edit Mode with some of them selected, whose border has ten vertices."""
    obj = drawings.grid_face("Drawing", 4)
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(obj.data)
    mesh.select_mode = {"FACE"}
    for face in mesh.faces:
        middle = face.calc_center_median()
        face.select_set(0.25 < middle.x < 0.75 and middle.y < 0.75)
    mesh.select_flush_mode()
    bmesh.update_edit_mesh(obj.data)
    return obj


def bent():
    loop = raised(star())
    loop[3, 2] = 0.05
    return wire("Drawing", [loop])


# How the object is made, the settings that it needs, and how many points its loops have where that is known.
KINDS = {
    "Bezier": (lambda _: drawings.bezier_circle("Drawing"), {}, 48),
    "NURBS": (lambda _: poly_curve("Drawing", [circle(8)], kind="NURBS"), {}, None),
    "poly": (lambda _: poly_curve("Drawing", [star()]), {}, 60),
    "triangle": (lambda _: wire("Drawing", [circle(3)]), {}, 3),
    "many parts": (lambda _: wire("Drawing", [circle(5, 0.3, (x, 0.0)) for x in range(12)]), {"loops": "keep"}, 60),
    "2D filled": (lambda _: changed(poly_curve("Drawing", [star(), circle(12, 0.3)]), fill_mode="BOTH"), {}, 72),
    "3D": (lambda _: poly_curve("Drawing", [star()], dimensions="3D"), {}, 60),
    "curve with a modifier": (lambda _: modified(poly_curve("Drawing", [star()]), "CAST", factor=0.3), {}, 60),
    "text": (lambda _: text("Drawing", "do"), {}, None),
    "SVG": (svg, {}, None),
    "wire": (lambda _: wire("Drawing", [star(), circle(12, 0.3)]), {}, 72),
    "boundary of faces": (lambda _: drawings.grid_face("Drawing", 4), {}, 16),
    "mesh with a modifier": (lambda _: modified(drawings.grid_face("Drawing", 1), "SUBSURF", levels=2), {}, 16),
    "Edit Mode": (lambda _: edited(), {}, 60),
    "hair": (lambda _: drawings.hair("Drawing", [star(), circle(12, 0.3)]), {}, 72),
    "Grease Pencil": (lambda _: drawings.grease_pencil("Drawing", [star(), circle(12, 0.3)]), {}, 72),
    "open spline, closed": (lambda _: poly_curve("Drawing", [star()], cyclic=False), {"close_open": True}, 60),
    "open wire, closed": (lambda _: wire("Drawing", [star()], cyclic=False), {"close_open": True}, 60),
    "open stroke, closed": (
        lambda _: drawings.grease_pencil("Drawing", [star()], cyclic=False),
        {"close_open": True},
        60,
    ),
    "upright": (lambda _: wire("Drawing", [np.insert(star(), 0, 0.5, axis=1)]), {}, 60),
    "projected": (lambda _: bent(), {"project": True}, 60),
    "turned": (lambda _: placed(poly_curve("Drawing", [star()]), Matrix.Translation((1.0, 2.0, 3.0)) @ TURN), {}, 60),
    "child": (lambda _: child(poly_curve("Drawing", [star()])), {}, 60),
    "tiny": (lambda _: placed(wire("Drawing", [star()]), Matrix.Scale(1e-4, 4)), {}, 60),
    "sheared": (lambda _: placed(wire("Drawing", [star()]), SHEAR), {}, 60),
    "doubled points": (lambda _: poly_curve("Drawing", [np.repeat(star(), 2, axis=0)]), {}, 60),
    "at a height": (lambda _: wire("Drawing", [raised(star(), -1e4)]), {}, 60),
    "faces in Edit Mode": (lambda _: faces_in_edit_mode(), {}, 10),
    "stretched": (lambda _: placed(wire("Drawing", [star()]), TURN @ Matrix.Diagonal((2.0, 0.5, 3.0, 1.0))), {}, 60),
    "mirrored": (lambda _: placed(text("Drawing", "R"), Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0))), {}, None),
    "negative": (lambda _: placed(wire("Drawing", [star()]), Matrix.Diagonal((-2.0, -2.0, -2.0, 1.0))), {}, 60),
    "shared data": (lambda _: shared(), {}, 60),
    "linked": (linked, {}, 60),
}


CURVED = {"Bezier", "NURBS", "text", "SVG", "mirrored"}


@pytest.mark.parametrize("name", ["poly", *(pytest.param(n, marks=pytest.mark.slow) for n in KINDS if n != "poly")])
def test_the_operator_gives_the_core_s_cages(core, tmp_path, name) -> None:
    make, values, count = KINDS[name]
    source = make(tmp_path)
    bpy.context.view_layer.update()
    shown = drawings.in_world(source, outline(source))
    generate("40%", **values)
    fine, cage = made(source.name)
    depsgraph = drawings.at_frame(drawings.end_of(cage))
    points, corners = evaluated(fine, depsgraph)[:, :2], evaluated(cage, depsgraph)[:, :2]
    assert count is None or len(points) == count
    assert fine.matrix_world == cage.matrix_world

    mesh = core.Mesh(points.astype(float), drawings.edges_of(fine).astype(int))
    if name not in CURVED:  # others keep a distance from what they display, for their true curves
        (level,) = core.nested_cages(mesh, core.Share(0.4), stored=np.float32, loops=values.get("loops", "auto")).levels
        np.testing.assert_array_equal(corners, level.cage.vertices)
        np.testing.assert_array_equal(drawings.edges_of(cage), level.cage.edges)
        assert certificate(cage).excess == pytest.approx(level.report.excess, rel=1e-3)
    assert core.verify(core.Mesh(corners.astype(float), drawings.edges_of(cage).astype(int)), mesh).holds

    # Every point of the fine mesh is one that Blender shows of the source, in the same place of the world.
    if name != "projected":
        far = np.linalg.norm(drawings.in_world(fine, evaluated(fine, depsgraph))[:, None] - shown[None], axis=2)
        assert far.min(axis=1).max() < 1e-5 * np.linalg.norm(np.ptp(shown, axis=0))


def outline(obj):
    """Points (n, 3) of what Blender shows of an object, without what makes a curve solid."""
    if obj.type in {"CURVES", "GREASEPENCIL"} or obj.library:
        return raised(np.concatenate([star(), circle(12, 0.3)]))
    if obj.mode == "EDIT" and len(obj.data.vertices) > 60:
        return raised(star())
    if obj.type not in {"CURVE", "FONT"}:
        return evaluated(obj)
    before = {name: getattr(obj.data, name) for name in ("dimensions", "bevel_depth", "extrude", "fill_mode")}
    obj.data.bevel_depth = obj.data.extrude = 0.0
    if obj.type == "FONT":
        obj.data.fill_mode = "NONE"
    else:
        obj.data.dimensions = "3D"
    found = evaluated(obj)
    for name, value in before.items():
        setattr(obj.data, name, value)
    return found


@pytest.mark.parametrize("hide", [lambda obj: obj.hide_set(True), lambda obj: setattr(obj, "hide_viewport", True)])
@pytest.mark.parametrize("kind", ["mesh", "curve"])
def test_a_hidden_own_level_counts_with_its_modifiers(extension, hide, kind) -> None:
    """Own coarse meshes are often put out of sight."""
    own = wire("Own", [circle(8, 3.0)]) if kind == "mesh" else poly_curve("Own", [circle(8, 3.0)])
    modified(own, "ARRAY", count=1)
    modified(own, "CAST", factor=0.5, cast_type="CUBOID")
    expected = drawings.in_world(own, evaluated(own))
    own.select_set(False)
    hide(own)
    poly_curve("Drawing", [star()])
    before = drawings.snapshot()
    extension.cages([bpy.data.objects["Drawing"]], [own], as_published=True)
    cage = made()[1]
    first = evaluated(cage, drawings.at_frame(certificate(cage).frames[0]))
    np.testing.assert_allclose(drawings.in_world(cage, first), expected, atol=1e-5)
    assert drawings.snapshot()["hidden"][1:] == before["hidden"]


def theta():
    """A circle with a line across."""
    mesh = bpy.data.meshes.new("Theta")
    edges = [(i, (i + 1) % 6) for i in range(6)] + [(0, 6), (6, 3)]
    mesh.from_pydata([*raised(circle(6)).tolist(), (0.0, 0.0, 0.0)], edges, [])
    return add("Drawing", mesh)


def overlapping():
    """Two curves in one object that cross."""
    return poly_curve("Drawing", [circle(20), circle(20, 1.0, (1.0, 0.0))])


TOUCHING = np.array([(1.0, 0.0), (2.0, -1.0), (3.0, 0.0), (2.0, 1.0)])
RING = [star(), circle(12, 0.1)]
REFUSED = {
    "flat along an axis": (lambda: scaled((0.0, 1.0, 1.0)), {}),
    "nothing at all": (lambda: scaled((0.0, 0.0, 0.0)), {}),
    "no letters": (lambda: text("Drawing", "  "), {}),
    "a point": (lambda: wire("Drawing", [star()[:1]], cyclic=False), {}),
    "no numbers": (lambda: wire("Drawing", [np.array([(np.nan, 0.0), (1.0, 0.0), (0.0, 1.0)])]), {}),
    "open spline": (lambda: poly_curve("Drawing", [circle()], cyclic=False), {}),
    "open mesh line": (lambda: wire("Drawing", [circle(8)], cyclic=False), {}),
    "open hair": (lambda: drawings.hair("Drawing", [star()], cyclic=False), {}),
    "open stroke": (lambda: drawings.grease_pencil("Drawing", [star()], cyclic=False), {}),
    "not planar": (lambda: bent(), {}),
    "no outline": (lambda: add("Drawing", bpy.data.meshes.new("Points")), {}),
    "too few points": (lambda: poly_curve("Drawing", [circle(2)]), {}),
    "unknown kind": (lambda: add("Drawing", bpy.data.lights.new("Lamp", "POINT")), {}),
    "a branch": (theta, {}),
    "a solid": (lambda: named(bpy.ops.mesh.primitive_cube_add), {}),
    "duplicate loops": (lambda: poly_curve("Drawing", [star(), star()]), {}),
    "crossing loops": (overlapping, {}),
    "loops that touch": (lambda: poly_curve("Drawing", [circle(4), TOUCHING]), {}),
    "loops a rounding apart": (
        lambda: poly_curve("Drawing", [circle(4), circle(4, 1.0, (2.0, 0.0))]), {"loops": "keep"}
    ),
    "no room": (lambda: poly_curve("Drawing", RING), {"levels": "20, 10", "clearance": 0.2, "loops": "keep"}),
    "impossible clearance": (lambda: poly_curve("Drawing", RING), {"clearance": 5.0, "loops": "keep"}),
    "hidden": (lambda: poly_curve("Drawing", [star()]).hide_set(True), {}),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_caged_is_named_and_nothing_changes(name) -> None:
    make, options = REFUSED[name]
    make()
    with refused("'Drawing'"):
        generate(**{"levels": "12", **options})


def test_in_edit_mode_without_selected_edges_there_is_nothing_to_cage() -> None:
    wire("Drawing", [circle(10)])
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    with refused("'Drawing'"):
        generate("6")


@pytest.mark.skipif(bpy.app.version >= (4, 3), reason="converted when the file is opened")
def test_the_older_grease_pencil_is_refused() -> None:
    bpy.ops.object.gpencil_add(type="STROKE")
    for run in ("generate", "puppet"):
        with refused():
            getattr(bpy.ops.object, f"nested_cages_{run}")()


def named(make):
    make()
    bpy.context.object.name = "Drawing"


def scaled(scale):
    obj = poly_curve("Drawing", [star()])
    obj.scale = scale
    return obj


@pytest.mark.slow
def test_a_clearance_that_leaves_the_drawing_tiny_is_kept() -> None:
    poly_curve("Drawing", [star()])
    generate("12", clearance=1000.0)
    assert certificate(made()[1]).clearance >= 1000.0


@pytest.mark.slow
def test_what_was_made_is_counted(reports) -> None:
    for k in range(3):
        poly_curve(f"Drawing {k}", [star() + 3.0 * k])
    bpy.ops.object.select_all(action="SELECT")
    generate("12")
    assert re.findall(r"\d+", reports.read("Info").splitlines()[-1])[:2] == ["3", "3"]  # cages, drawings


def test_coordinates_are_those_of_the_drawing() -> None:
    outer, hole = star(), circle(12, 0.3)
    poly_curve("Drawing", [outer, hole])
    generate("24", loops="keep")
    wanted = {tuple(point) for point in np.concatenate([outer, hole]).astype(np.float32).tolist()}
    assert {tuple(point) for point in drawings.base(made()[0])[:, :2].tolist()} == wanted


@pytest.mark.slow
def test_letters_that_do_not_interlock_have_room_for_each_cage() -> None:
    text("Word", "Hifly")
    assert bpy.ops.object.nested_cages_generate() == {"FINISHED"}
    assert len(drawings.set_of(bpy.data.objects["Word"])) == 2


def test_a_drawing_far_from_its_origin_is_certified_as_stored(core) -> None:
    """At a thousand times its size away, float32 leaves some 1e-4 of the size between two numbers."""
    poly_curve("Drawing", [star() + 2000.0])
    generate("16")
    fine, cage = (
        core.Mesh(drawings.base(obj)[:, :2].astype(float), drawings.edges_of(obj).astype(int)) for obj in made()
    )
    assert core.verify(cage, fine, 1e-6 * fine.diagonal).holds
    assert drawings.solid(made()[1]).contains(drawings.solid(made()[0]))


def test_a_text_without_height_keeps_its_cages_where_it_is() -> None:
    """Flat texts are often scaled to nothing along z."""
    drawing = text("Drawing", "o")
    drawing.scale.z, drawing.location.x = 0.0, 5.0
    bpy.context.view_layer.update()
    generate("20%")
    bpy.context.view_layer.update()
    assert made()[1].matrix_world.translation.x > 4.9
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}


def test_smooth_hair_is_as_round_as_blender_shows_it() -> None:
    drawings.hair("Drawing", [circle(8)], kind="CATMULL_ROM")
    generate("12")
    fine = made()[0]
    assert len(drawings.base(fine)) > 8 and drawings.solid(fine).area == pytest.approx(np.pi, rel=1e-2)
