"""Cages as files: read back and compared with what is displayed, by shapely."""

import json
import re
from xml.etree import ElementTree as ET

import bpy
import numpy as np
import pytest
import shapely

from support.blender import refused
from support.drawings import (
    at_frame,
    choose,
    circle,
    end_of,
    evaluated,
    generate,
    in_world,
    made,
    poly_curve,
    solid,
    star,
)

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(("kind", "count"), [("SVG", 3), ("GEOJSON", 3)])
def test_it_says_how_many_outlines_were_written(cages, tmp_path, reports, kind, count) -> None:
    choose(cages[0])
    bpy.ops.object.nested_cages_export(filepath=str(tmp_path / "file"), kind=kind)
    told = reports.read("Info")
    assert re.findall(r"\d+", told) == [str(count)] and "file" in told


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


def test_a_file_that_cannot_be_written_is_a_sentence(cages, tmp_path) -> None:
    choose(cages[0])
    with refused("cages.svg"):
        bpy.ops.object.nested_cages_export(filepath=str(tmp_path / "missing" / "cages.svg"))


@pytest.mark.parametrize(("kind", "flip_y"), [("SVG", True), ("GEOJSON", False)])
def test_what_is_exported_comes_back_the_same(cages, core, tmp_path, kind, flip_y) -> None:
    source, _, _ = cages
    source.matrix_world.identity()
    bpy.context.view_layer.update()
    generate("24, 12", loops="keep")
    both = [bpy.data.objects[f"Drawing Cage {number}"] for number in (1, 2)]
    choose(both[-1])
    path = tmp_path / f"a.{kind.lower()}"
    options = {"kind": kind, "flip_y": flip_y, "world": True, "scale": 64.0}
    assert bpy.ops.object.nested_cages_export(filepath=str(path), **options) == {"FINISHED"}
    assert bpy.ops.object.nested_cages_import(filepath=str(path), scale=1 / 64) == {"FINISHED"}
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
    path = str(tmp_path / "a.geojson")
    options = {"kind": "GEOJSON", "flip_y": False, "world": True, "scale": 100.0}
    assert bpy.ops.object.nested_cages_export(filepath=path, **options) == {"FINISHED"}
    found = core.read_geojson(path)
    expected = in_world(source, evaluated(source))[:, [0, 2]] * 100.0
    assert found.vertices.min(axis=0) == pytest.approx(expected.min(axis=0), abs=1e-3)
    assert found.vertices.max(axis=0) == pytest.approx(expected.max(axis=0), abs=1e-3)
    source.rotation_euler = (0.4, 0.0, 0.0)
    with refused("'Drawing'"):
        bpy.ops.object.nested_cages_export(filepath=path, **options)


def test_files_of_several_drawings_hold_their_cages(tmp_path) -> None:
    parts = [poly_curve(f"Part {k}", [circle(40, 0.5, (2.0 * k, 0.0))]) for k in range(3)]
    choose(*parts)
    generate("12, 6")
    path = tmp_path / "cages.geojson"
    for frame in (bpy.context.scene.frame_current, 1):  # before the result too
        bpy.context.scene.frame_set(frame)
        for obj in parts:
            obj.hide_viewport = False
        choose(*parts)
        assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="GEOJSON", pieces=4) == {"FINISHED"}
        found = [each["properties"] for each in json.loads(path.read_text())["features"]]
        assert [each["level"] for each in found if "piece" not in each] == [0, 1, 2] * 3
        assert {each["name"] for each in found if each["level"] == 0} == {f"{part.name} Fine" for part in parts}
        assert all(each["level"] > 0 for each in found if "piece" in each)
    bpy.context.scene.frame_set(9000)
    choose(*parts)
    assert bpy.ops.object.nested_cages_export(filepath=str(tmp_path / "cages.svg")) == {"FINISHED"}
    assert (tmp_path / "cages.svg").read_text().count("<path") == 9


def test_cages_around_and_inside_are_exported_with_one_drawing(tmp_path) -> None:
    poly_curve("Drawing", [star()])
    generate("16", inside=True)
    for levels, count in (("", 2), ("20", 3)):
        if levels:
            generate(levels)
        path = tmp_path / "both.svg"
        bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG")
        written = path.read_text()
        assert written.count("<path") == count
    places = [written.index(name) for name in ("Drawing Cage 1", "Drawing Fine", "Drawing Inner Cage 1")]
    assert places == sorted(places)
    assert re.findall(r'class="([\w-]+)"', written) == ["level-1", "level-0", "inner-1"]


def test_geojson_has_pieces(tmp_path, core) -> None:
    poly_curve("Drawing", [star(), circle(30, 0.3)])
    path = tmp_path / "outline.geojson"
    options = {"filepath": str(path), "kind": "GEOJSON", "scale": 10.0}
    for asked, most in ((6, 6), (1, 3)):
        bpy.ops.object.nested_cages_export(**options, pieces=asked)
        outline, *pieces = core.features_from_geojson(path.read_bytes())
        assert max(len(each.mesh.vertices) for each in pieces) <= most
        assert sum(each.mesh.area for each in pieces) == pytest.approx(outline.properties["area"])
        assert [each.properties["piece"] for each in pieces] == [*range(1, len(pieces) + 1)]
    assert bpy.ops.object.nested_cages_import(filepath=str(path)) == {"FINISHED"}
    assert len(bpy.context.selected_objects) == 1
    bpy.ops.object.nested_cages_export(**options)
    assert len(core.features_from_geojson(path.read_bytes())) == 1


def test_faces_that_blender_fills_play_the_steps() -> None:
    """As the guide says: a copy of a playing cage, filled in Edit Mode, for formats that drop loose edges."""
    poly_curve("Drawing", [star(), circle(20, 0.4)])
    generate("24, 12", frames_per_step=3)
    cage = made()[2]
    choose(cage)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.fill()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(copy.data.polygons) > 0 and not len(cage.data.polygons)
    for frame in range(1, end_of(cage) + 1, 7):
        depsgraph = at_frame(frame)
        np.testing.assert_array_equal(evaluated(copy, depsgraph), evaluated(cage, depsgraph))
