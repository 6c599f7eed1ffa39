"""Every kind of drawing through the operator: the cages are the core's own, around the lines that Blender shows."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from support.drawings import (
    add,
    at_frame,
    bezier_circle,
    circle,
    edges_of,
    evaluated,
    facts,
    grease_pencil,
    grid_face,
    hair,
    in_world,
    nurbs_circle,
    poly_curve,
    raised,
    snapshot,
    star,
    text,
    wire,
)

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
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
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
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
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


def bent():
    loop = raised(star())
    loop[3, 2] = 0.05
    return wire("Drawing", [loop])


# How the object is made, the settings that it needs, and how many points its loops have where that is known.
KINDS = {
    "Bezier": (lambda _: bezier_circle("Drawing"), {}, 48),
    "NURBS": (lambda _: nurbs_circle("Drawing"), {}, None),
    "poly": (lambda _: poly_curve("Drawing", [star()]), {}, 60),
    "2D filled": (lambda _: changed(poly_curve("Drawing", [star(), circle(12, 0.3)]), fill_mode="BOTH"), {}, 72),
    "3D": (lambda _: poly_curve("Drawing", [star()], dimensions="3D"), {}, 60),
    "bevelled": (lambda _: changed(poly_curve("Drawing", [star()]), bevel_depth=0.1), {}, 60),
    "extruded": (lambda _: changed(poly_curve("Drawing", [star()]), extrude=0.1), {}, 60),
    "curve with a modifier": (lambda _: modified(poly_curve("Drawing", [star()]), "CAST", factor=0.3), {}, 60),
    "resolution": (lambda _: bezier_circle("Drawing"), {"resolution": 5}, 20),
    "text": (lambda _: text("Drawing", "do"), {}, None),
    "SVG": (svg, {}, None),
    "wire": (lambda _: wire("Drawing", [star(), circle(12, 0.3)]), {}, 72),
    "boundary of faces": (lambda _: grid_face("Drawing", 4), {}, 16),
    "mesh with a modifier": (lambda _: modified(grid_face("Drawing", 1), "SUBSURF", levels=2), {}, 16),
    "Edit Mode": (lambda _: edited(), {}, 60),
    "hair": (lambda _: hair("Drawing", [star(), circle(12, 0.3)]), {}, 72),
    "Grease Pencil": (lambda _: grease_pencil("Drawing", [star(), circle(12, 0.3)]), {}, 72),
    "open spline, closed": (lambda _: poly_curve("Drawing", [star()], cyclic=False), {"close_open": True}, 60),
    "open wire, closed": (lambda _: wire("Drawing", [star()], cyclic=False), {"close_open": True}, 60),
    "open stroke, closed": (lambda _: grease_pencil("Drawing", [star()], cyclic=False), {"close_open": True}, 60),
    "upright": (lambda _: wire("Drawing", [np.insert(star(), 0, 0.5, axis=1)]), {}, 60),
    "projected": (lambda _: bent(), {"project": True}, 60),
    "turned": (lambda _: placed(poly_curve("Drawing", [star()]), Matrix.Translation((1.0, 2.0, 3.0)) @ TURN), {}, 60),
    "child": (lambda _: child(poly_curve("Drawing", [star()])), {}, 60),
    "stretched": (lambda _: placed(wire("Drawing", [star()]), TURN @ Matrix.Diagonal((2.0, 0.5, 3.0, 1.0))), {}, 60),
    "mirrored": (lambda _: placed(text("Drawing", "R"), Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0))), {}, None),
    "negative": (lambda _: placed(wire("Drawing", [star()]), Matrix.Diagonal((-2.0, -2.0, -2.0, 1.0))), {}, 60),
    "shared data": (lambda _: shared(), {}, 60),
    "linked": (linked, {}, 60),
}


@pytest.mark.parametrize("name", ["poly", *(pytest.param(n, marks=pytest.mark.slow) for n in KINDS if n != "poly")])
def test_the_operator_gives_the_core_s_cages(addon, core, tmp_path, name) -> None:
    make, values, count = KINDS[name]
    source = make(tmp_path)
    bpy.context.view_layer.update()
    shown = in_world(source, outline(source))
    assert bpy.ops.object.nested_cages_generate(levels="40%", **values) == {"FINISHED"}
    (collection,) = [c for c in bpy.data.collections if "source" in facts(c)]
    fine, cage = sorted(collection.objects, key=lambda obj: facts(obj)["level"])
    depsgraph = at_frame(facts(cage)["end"])
    points, corners = evaluated(fine, depsgraph)[:, :2], evaluated(cage, depsgraph)[:, :2]
    assert count is None or len(points) == count
    assert fine.matrix_world == cage.matrix_world

    mesh = core.Mesh(points.astype(float), edges_of(fine).astype(int))
    wanted = max(3 * len(mesh.loops), round(0.4 * len(points)))
    (level,) = core.nested_cages(mesh, [wanted], stored=np.float32).levels
    np.testing.assert_array_equal(corners, level.cage.vertices)
    np.testing.assert_array_equal(edges_of(cage), level.cage.edges)
    assert facts(cage)["excess"] == pytest.approx(level.report.excess, rel=1e-3)
    assert core.verify(core.Mesh(corners.astype(float), edges_of(cage).astype(int)), mesh).holds

    # Every point of the fine mesh is one that Blender shows of the source, in the same place of the world.
    if name not in {"projected", "resolution"}:
        gaps = np.linalg.norm(in_world(fine, evaluated(fine, depsgraph))[:, None] - shown[None], axis=2).min(axis=1)
        assert gaps.max() < 1e-5 * np.linalg.norm(np.ptp(shown, axis=0))


def outline(obj):
    """Points (n, 3) of what Blender shows of an object, without what makes a curve solid."""
    if obj.type in {"CURVES", "GREASEPENCIL"} or obj.library:
        return raised(np.concatenate([star(), circle(12, 0.3)]))
    if obj.mode == "EDIT":
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
def test_a_hidden_own_level_counts_with_its_modifiers(hide, kind) -> None:
    """Own coarse meshes are often put out of sight."""
    own = wire("Own", [circle(8, 3.0)]) if kind == "mesh" else poly_curve("Own", [circle(8, 3.0)])
    modified(own, "ARRAY", count=1)
    modified(own, "CAST", factor=0.5, cast_type="CUBOID")
    expected = in_world(own, evaluated(own))
    own.select_set(False)
    hide(own)
    poly_curve("Drawing", [star()])
    before = snapshot()
    generate = bpy.ops.object.nested_cages_generate
    assert generate(levels="*", level_objects="Own", as_published=True, shrink=False) == {"FINISHED"}
    cage = bpy.data.objects["Drawing Cage 1"]
    first = evaluated(cage, at_frame(facts(cage)["flow_start"]))
    np.testing.assert_allclose(in_world(cage, first), expected, atol=1e-5)
    assert snapshot()["hidden"] == ["Drawing Moving", *before["hidden"]]
    assert facts(cage)["end"] == facts(cage)["flow_start"]  # nothing moves


@pytest.mark.parametrize(
    ("drawing", "options", "sentence"),
    [
        (lambda: scaled((0.0, 1.0, 1.0)), {}, "'Drawing' is scaled to nothing along X: give it a scale first"),
        (lambda: scaled((0.0, 0.0, 0.0)), {}, "'Drawing' is scaled to nothing along X and Y"),
        (lambda: text("Text", "  "), {}, "'Text' is a text without letters: write some"),
        (lambda: wire("Dot", [star()[:1]], cyclic=False), {}, "'Dot' has no outline: draw a closed line"),
        (lambda: wire("Lost", [np.array([(np.nan, 0.0), (1.0, 0.0), (0.0, 1.0)])]), {}, "place is not a number"),
        (lambda: scaled((1.0, 1.0, 1.0)), {"levels": "0mm"}, "'0mm' is none of these.$"),
        (lambda: scaled((1.0, 1.0, 1.0)), {"levels": "12, *"}, "1 of the levels should be an object of your own"),
    ],
)
def test_what_cannot_be_caged_is_said_in_words(drawing, options, sentence) -> None:
    drawing()
    bpy.context.view_layer.update()
    before = snapshot()
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.object.nested_cages_generate(**{"levels": "12", **options})
    assert snapshot() == before


def scaled(scale):
    obj = poly_curve("Drawing", [star()])
    obj.scale = scale
    return obj


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"levels": "12", "clearance": 1000.0}, "The gap is 3"),
        ({"levels": "8%, 20%"}, "2 certified cages: "),
        ({"levels": "12"}, "3 certified cages for 3 drawings: "),
    ],
)
def test_what_was_made_is_said_in_words(capfd, options, sentence) -> None:
    for k in range(1 + 2 * ("drawings" in sentence)):
        poly_curve(f"Drawing {k}", [star() + 3.0 * k])
    for obj in bpy.data.objects:
        obj.select_set(True)
    assert bpy.ops.object.nested_cages_generate(**options) == {"FINISHED"}
    assert sentence in capfd.readouterr().out
