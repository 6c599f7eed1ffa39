"""Cages as curves, faces and prisms, cages as files, and outlines of images: against shapely and pixel by pixel."""

from __future__ import annotations

import json
import re
from xml.etree import ElementTree as ET

import bpy
import numpy as np
import pytest
import shapely

from support.drawings import choose, circle, evaluated, facts, in_world, poly_curve, solid, star

SIDE = 40


@pytest.fixture
def cages():
    """A drawing with a hole and its cages: the source, the fine mesh, the cages."""
    source = poly_curve("Drawing", [star() * 2.0, circle(20, 0.5)])
    source.location = (1.0, 2.0, 0.5)
    source.rotation_euler = (0.3, 0.2, 0.1)
    source.scale = (2.0, 2.0, 2.0)
    assert bpy.ops.object.nested_cages_generate(levels="24, 12") == {"FINISHED"}
    members = [obj for obj in bpy.data.objects if "level" in facts(obj)]
    fine, *found = sorted(members, key=lambda obj: facts(obj)["level"])
    return source, fine, found


@pytest.mark.slow
def test_faces_fill_the_cage(cages) -> None:
    _, _, (inner, _) = cages
    choose(inner)
    assert bpy.ops.object.nested_cages_to_objects(shape="FILLED") == {"FINISHED"}
    made = bpy.context.active_object
    bpy.context.view_layer.update()
    assert made.matrix_world == inner.matrix_world
    assert sum(face.area for face in made.data.polygons) == pytest.approx(solid(inner).area, rel=1e-5)
    assert all(face.normal.z > 0.999 for face in made.data.polygons)


@pytest.mark.slow
def test_prisms_are_closed_and_point_out(cages) -> None:
    _, _, both = cages
    choose(*both)
    assert bpy.ops.object.nested_cages_to_objects(shape="PRISM", height=1.0) == {"FINISHED"}
    for obj, made in zip(both, sorted(bpy.context.selected_objects, key=lambda obj: obj.name), strict=True):
        uses = np.zeros(len(made.data.edges), int)
        for corner in made.data.loops:
            uses[corner.edge_index] += 1
        assert (uses == 2).all()
        made.data.calc_loop_triangles()
        points = in_world(made, evaluated(made))
        triangles = points[[list(triangle.vertices) for triangle in made.data.loop_triangles]]
        volume = np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6.0
        assert volume == pytest.approx(4.0 * solid(obj).area * 1.0, rel=1e-4)


@pytest.mark.slow
def test_curves_have_the_cage_s_points(cages) -> None:
    _, _, (inner, _) = cages
    choose(inner)
    assert bpy.ops.object.nested_cages_to_objects(shape="CURVE") == {"FINISHED"}
    made = bpy.context.active_object
    bpy.context.view_layer.update()
    assert made.type == "CURVE"
    assert len(made.data.splines) == 2
    points = np.array([point.co[:3] for spline in made.data.splines for point in spline.points])
    np.testing.assert_array_equal(
        np.unique(in_world(made, points), axis=0), np.unique(in_world(inner, evaluated(inner)), axis=0)
    )


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "told"), [("SVG", "3 outlines"), ("GEOJSON", "3 outlines"), ("ENGINE", "1 outline")])
def test_it_says_how_many_outlines_were_written(cages, tmp_path, capfd, kind, told) -> None:
    choose(cages[0])
    bpy.ops.object.nested_cages_export(filepath=str(tmp_path / "file"), kind=kind)
    assert f"{told} written to file" in capfd.readouterr().out


@pytest.mark.slow
def test_a_drawing_goes_to_svg_with_all_its_cages(cages, core, tmp_path) -> None:
    source, fine, both = cages
    choose(source)
    path = tmp_path / "cages.svg"
    assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG", flip_y=False) == {"FINISHED"}
    for obj in (fine, *both):
        back = core.exchange.read_svg(path, element=obj.name)
        assert shapely.equals(shapely.normalize(shapely.geometry.shape(back)), shapely.normalize(solid(obj)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("unit", "scale_length", "per_metre"),
    [("METERS", 1.0, 1e3), ("MILLIMETERS", 0.001, 1e3), ("CENTIMETERS", 1.0, 1e2), ("INCHES", 1.0, 1 / 0.0254)],
)
def test_an_svg_has_its_size_in_the_unit_of_the_scene(cages, tmp_path, unit, scale_length, per_metre) -> None:
    shown = bpy.context.scene.unit_settings
    shown.system = "IMPERIAL" if unit == "INCHES" else "METRIC"
    shown.length_unit, shown.scale_length = unit, scale_length
    choose(cages[0])
    path = tmp_path / "cages.svg"
    bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG")
    root = ET.fromstring(path.read_text())
    width, name = re.fullmatch(r"([\d.e+]+)(mm|cm|in)", root.get("width")).groups()
    assert name == {"CENTIMETERS": "cm", "INCHES": "in"}.get(unit, "mm")
    per_unit = float(width) / float(root.get("viewBox").split()[2])
    assert per_unit == pytest.approx(2.0 * scale_length * per_metre, rel=1e-5)  # the drawing is scaled by 2
    shown.system = "NONE"
    bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG")
    assert "width" not in ET.fromstring(path.read_text()).attrib


@pytest.mark.slow
def test_the_engine_gets_the_outermost(cages, core, tmp_path) -> None:
    source, _, both = cages
    choose(source)
    path = tmp_path / "cages.json"
    assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="ENGINE", triangles=True) == {"FINISHED"}
    document = json.loads(path.read_text())
    assert len(document["points"]) == len(both[-1].data.vertices)
    back = core.exchange.from_engine_json(path.read_text(), flip_y=0.0)
    assert shapely.geometry.shape(back).area == pytest.approx(solid(both[-1]).area)


@pytest.mark.slow
def test_a_file_that_cannot_be_written_is_a_sentence(cages, tmp_path) -> None:
    choose(cages[0])
    with pytest.raises(RuntimeError, match="cannot be written"):
        bpy.ops.object.nested_cages_export(filepath=str(tmp_path / "missing" / "cages.svg"))


def sprite(name="Sprite"):
    """An image (H, W) with a ragged opaque ring, and its opacity with the bottom row first."""
    y, x = np.mgrid[:SIDE, : 2 * SIDE] + 0.5
    angle = np.arctan2(y - 15.0, x - 30.0)
    distance = np.hypot(x - 30.0, y - 15.0)
    opaque = (distance < 12.0 + 2.0 * np.cos(5.0 * angle)) & (distance > 5.0)
    image = bpy.data.images.new(name, 2 * SIDE, SIDE, alpha=True)
    pixels = np.ones((SIDE, 2 * SIDE, 4), np.float32)
    pixels[..., 3] = opaque
    image.pixels.foreach_set(pixels.ravel())
    return image, opaque


@pytest.mark.parametrize(("holes", "padding"), [(False, 0.0), (True, 0.5)])
def test_no_opaque_pixel_is_outside(holes, padding) -> None:
    image, opaque = sprite()
    empty = bpy.data.objects.new("Picture", None)
    empty.empty_display_type = "IMAGE"
    empty.data = image
    empty.empty_display_size = 4.0
    empty.location = (3.0, 1.0, 0.0)
    bpy.context.scene.collection.objects.link(empty)
    choose(empty)
    done = bpy.ops.object.nested_cages_from_image(vertices=16, padding=padding, holes=holes)
    assert done == {"FINISHED"}
    made = bpy.context.active_object
    area = solid(made)
    assert len(made.data.vertices) == 16
    assert len(getattr(area, "interiors", ())) == int(holes)
    bpy.context.view_layer.update()
    assert made.matrix_world == empty.matrix_world
    pixel = 4.0 / (2 * SIDE)
    rows, columns = np.nonzero(opaque)
    low = np.column_stack([columns, rows]) * pixel + (-2.0, -1.0)
    boxes = shapely.box(*low.T, *(low + pixel).T)
    assert shapely.covers(area.buffer(1e-5), boxes).all()
    if padding:
        assert shapely.distance(area.boundary, boxes).min() >= 0.99 * padding * pixel


def test_images_without_anything_to_outline_are_refused() -> None:
    image = bpy.data.images.new("Clear", 8, 8, alpha=True)
    image.pixels.foreach_set(np.zeros(8 * 8 * 4, np.float32))
    with pytest.raises(RuntimeError, match="no opaque pixel"):
        bpy.ops.object.nested_cages_from_image(image="Clear")
    with pytest.raises(RuntimeError, match="Choose an image"):
        bpy.ops.object.nested_cages_from_image()
    assert not bpy.data.objects


# There and back


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "flip_y"), [("SVG", True), ("GEOJSON", False), ("ENGINE", True)])
def test_what_is_exported_comes_back_the_same(cages, core, tmp_path, kind, flip_y) -> None:
    source, _, _ = cages
    source.matrix_world.identity()
    bpy.context.view_layer.update()
    assert bpy.ops.object.nested_cages_generate(levels="24, 12") == {"FINISHED"}
    both = [bpy.data.objects[f"Drawing Cage {number}"] for number in (1, 2)]
    choose(both[-1])
    path = tmp_path / {"SVG": "a.svg", "GEOJSON": "a.geojson", "ENGINE": "a.json"}[kind]
    options = {"kind": kind, "flip_y": flip_y, "world": True, "scale": 64.0}
    assert bpy.ops.object.nested_cages_export(filepath=str(path), **options) == {"FINISHED"}
    y = "AUTO" if kind == "GEOJSON" else "DOWN" if flip_y else "UP"
    assert bpy.ops.object.nested_cages_import(filepath=str(path), scale=1 / 64, y=y) == {"FINISHED"}
    (back,) = bpy.context.selected_objects
    bpy.context.view_layer.update()
    points, there = in_world(back, evaluated(back)), in_world(both[-1], evaluated(both[-1]))
    gaps = np.linalg.norm(points[:, None] - there[None], axis=2)
    assert gaps.shape[0] == gaps.shape[1]
    assert gaps.min(axis=1).max() < 5e-7  # float32
    mesh = core.Mesh.from_loops([np.array(ring.coords)[:-1] for ring in rings(back)])
    assert core.verify(mesh, core.Mesh.from_loops([np.array(ring.coords)[:-1] for ring in rings(both[0])]))


def rings(obj):
    """The outlines of a mesh of edges in the world, seen from the top."""
    flat = shapely.transform(solid(obj), lambda xy: in_world(obj, np.column_stack([xy, np.zeros(len(xy))]))[:, :2])
    return [flat.exterior, *flat.interiors]


def test_an_outline_that_stands_up_is_written_as_seen_from_the_front(core, tmp_path) -> None:
    source = poly_curve("Drawing", [star()])
    source.rotation_euler = (np.pi / 2, 0.0, 0.0)
    source.location = (3.0, 0.0, 1.0)
    path = str(tmp_path / "a.json")
    options = {"kind": "ENGINE", "flip_y": False, "world": True, "scale": 100.0}
    assert bpy.ops.object.nested_cages_export(filepath=path, **options) == {"FINISHED"}
    found = core.exchange.from_engine_json((tmp_path / "a.json").read_text())
    expected = in_world(source, evaluated(source))[:, [0, 2]] * 100.0
    assert found.vertices.min(axis=0) == pytest.approx(expected.min(axis=0), abs=1e-3)
    assert found.vertices.max(axis=0) == pytest.approx(expected.max(axis=0), abs=1e-3)
    source.rotation_euler = (0.4, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="is tilted"):
        bpy.ops.object.nested_cages_export(filepath=path, **options)


def test_drawings_are_read_from_files_and_caged(core, tmp_path, capfd) -> None:
    overlapping = '<svg xmlns="http://www.w3.org/2000/svg"><circle r="50"/><rect width="80" height="80"/></svg>'
    (tmp_path / "logo.svg").write_text(overlapping)
    lying = {"outlines": "ONE", "plane": "XY", "centre": False}
    assert bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "logo.svg"), **lying) == {"FINISHED"}
    assert "1 outline, " in capfd.readouterr().out
    logo = bpy.context.active_object
    assert logo.name == "logo"
    assert logo.location.y < 0.0  # the square goes down to the right
    assert bpy.ops.object.nested_cages_generate(levels="12") == {"FINISHED"}

    def region(name, x):
        square = shapely.geometry.mapping(shapely.box(x, 6e6, x + 9, 6e6 + 9))
        return {"type": "Feature", "properties": {"name": name}, "geometry": square}

    squares = [region("West", 5e5), region("East", 6e5)]
    spoilt = {"type": "Feature", "properties": {"name": "Spoilt"}, "geometry": {"type": "Polygon", "coordinates": 3}}
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [*squares, spoilt]}))
    assert bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "map.geojson"), scale=1.0) == {"FINISHED"}
    assert "'map.geojson': feature 2" in capfd.readouterr().out
    assert {obj.name for obj in bpy.context.selected_objects} == {"West", "East"}
    assert {tuple(obj.dimensions[:2]) for obj in bpy.context.selected_objects} == {(9.0, 9.0)}


def test_points_that_float32_cannot_tell_apart_become_one(tmp_path) -> None:
    near = 1e-7
    data = f"M0 0H10V10H0Z M0 0h{near}v{-near}z M10 10h5v5h-5z M3 3h2v{near}h-2z"  # a speck, a touch, a slit
    (tmp_path / "fine.svg").write_text(f'<svg><path fill-rule="evenodd" d="{data}"/></svg>')
    assert bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "fine.svg"), scale=1.0) == {"FINISHED"}
    assert solid(bpy.context.active_object).area == pytest.approx(125.0, rel=1e-4)
    assert bpy.ops.object.nested_cages_generate(levels="6") == {"FINISHED"}


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("a.txt", "", "not a supported file type"),
        ("a.svg", "hello", "not an SVG"),
        ("a.geojson", "{", "not GeoJSON"),
        ("b.geojson", '{"type": "FeatureCollection", "features": []}', "no polygons"),
        ("none.svg", None, "There is no file '.*none.svg'"),
    ],
)
def test_files_that_cannot_be_read_are_refused(tmp_path, name, text, sentence) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.object.nested_cages_import(filepath=str(tmp_path / name))
    assert not bpy.data.objects


def test_several_files_are_read_at_once(addon, tmp_path) -> None:
    """As the file browser and files dropped into the 3D view name them."""
    for name in ("one", "two"):
        (tmp_path / f"{name}.svg").write_text('<svg viewBox="0 0 9 9"><path d="M1 1H8V8H1Z"/></svg>')
    files = [{"name": "one.svg"}, {"name": "two.svg"}]
    assert bpy.ops.object.nested_cages_import(directory=str(tmp_path), files=files) == {"FINISHED"}
    assert sorted(obj.name for obj in bpy.context.selected_objects) == ["one", "two"]


def test_cages_as_grease_pencil_strokes() -> None:
    poly_curve("Drawing", [star(), circle(12, 0.3)])
    assert bpy.ops.object.nested_cages_generate(levels="24") == {"FINISHED"}
    cage = bpy.data.objects["Drawing Cage 1"]
    choose(cage)
    if bpy.app.version < (4, 3):
        with pytest.raises(RuntimeError, match=r"need Blender 4.3 or later"):
            bpy.ops.object.nested_cages_to_objects(shape="GREASE_PENCIL")
        return
    assert bpy.ops.object.nested_cages_to_objects(shape="GREASE_PENCIL") == {"FINISHED"}
    made = bpy.context.object
    assert made.type == "GREASEPENCIL" and made.name == "Drawing Cage 1 Grease Pencil"
    strokes = made.data.layers[0].frames[0].drawing.strokes
    assert [stroke.cyclic for stroke in strokes] == [True, True]
    points = np.array([point.position[:] for stroke in strokes for point in stroke.points])
    home = np.array([key.co[:] for key in cage.data.shape_keys.key_blocks[0].data])
    assert {tuple(point) for point in points} == {tuple(point) for point in home}
    assert made.active_material.grease_pencil.color[:] == pytest.approx(cage.color[:])
