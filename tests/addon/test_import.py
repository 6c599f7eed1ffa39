"""Files that are read as drawings: what was exported comes back, any SVG and GeoJSON, several at once."""

import json

import bpy
import numpy as np
import pytest
import shapely

from support.blender import refused
from support.drawings import evaluated, generate, in_world, solid
from support.marks import slow_after


def test_shapes_of_any_svg_can_be_read_one_by_one(tmp_path) -> None:
    path = tmp_path / "two.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 10"><rect width="10" height="10"/>'
        '<circle id="dot" cx="12" cy="5" r="4"/><path fill="none" d="M0 0h1"/></svg>'
    )
    assert bpy.ops.object.nested_cages_import(filepath=str(path), outlines="ONE") == {"FINISHED"}
    assert len(bpy.data.objects) == 1
    assert bpy.ops.object.nested_cages_import(filepath=str(path), outlines="SEVERAL") == {"FINISHED"}
    assert sorted(obj.name for obj in bpy.data.objects) == ["dot", "rect 1", "two"]
    assert bpy.data.objects["rect 1"].dimensions.x == pytest.approx(0.1)


@pytest.mark.parametrize("shapes", slow_after(1, [1, 2]))
@pytest.mark.parametrize(("plane", "up"), [("AUTO", 2), ("FRONT", 2), ("TOP", 1)])
def test_a_drawing_stands_in_its_middle_and_several_shapes_are_parts(tmp_path, shapes, plane, up) -> None:
    drawn = ('<rect id="low" x="10" width="10" height="40" fill="red"/>', '<circle id="high" cx="30" cy="35" r="5"/>')
    path = tmp_path / "drawing.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 90 90">{"".join(drawn[:shapes])}</svg>')
    assert bpy.ops.object.nested_cages_import(filepath=str(path), plane=plane) == {"FINISHED"}
    bpy.context.view_layer.update()
    made = {obj.name: obj for obj in bpy.context.selected_objects}
    assert list(made) == (["drawing"] if shapes == 1 else ["low", "high"])
    corners = np.concatenate([in_world(obj, evaluated(obj)) for obj in made.values()])
    size = (0.1, 0.4) if shapes == 1 else (0.25, 0.4)
    for axis, extent in zip((0, up), size, strict=True):
        assert [corners[:, axis].min(), corners[:, axis].max()] == pytest.approx([-extent / 2, extent / 2], abs=1e-6)
    if shapes == 2:  # what is drawn later is above, or in front, and y goes down in the file
        above, front = made["high"].location - made["low"].location, -1.0 if up == 2 else 1.0
        assert above[up] == pytest.approx(-0.15, abs=1e-6) and above[3 - up] * front > 0.0
        assert made["low"].data.polygons and made["low"].data.materials[0].name == "Fill #FF0000"
    generate("8")


def test_drawings_are_read_from_files_and_caged(tmp_path, reports) -> None:
    overlapping = '<svg xmlns="http://www.w3.org/2000/svg"><circle r="50"/><rect width="80" height="80"/></svg>'
    (tmp_path / "logo.svg").write_text(overlapping)
    lying = {"outlines": "ONE", "plane": "TOP"}
    assert bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "logo.svg"), **lying) == {"FINISHED"}
    logo = bpy.context.active_object
    assert logo.name == "logo"
    assert min((v.co for v in logo.data.vertices), key=lambda co: co.y).x > 0.0  # the square goes down to the right
    generate("12")

    def region(name, x):
        square = shapely.geometry.mapping(shapely.box(x, 6e6, x + 9, 6e6 + 9))
        return {"type": "Feature", "properties": {"name": name}, "geometry": square}

    squares = [region("West", 5e5), region("East", 6e5)]
    spoilt = {"type": "Feature", "properties": {"name": "Spoilt"}, "geometry": {"type": "Polygon", "coordinates": 3}}
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [*squares, spoilt]}))
    assert bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "map.geojson"), scale=1.0) == {"FINISHED"}
    assert "'map.geojson'" in reports.read("Warning")  # of which a feature is spoilt
    assert {obj.name for obj in bpy.context.selected_objects} == {"West", "East"}
    assert {tuple(obj.dimensions[:2]) for obj in bpy.context.selected_objects} == {(9.0, 9.0)}


def test_points_that_float32_cannot_tell_apart_become_one(tmp_path) -> None:
    near = 1e-7
    data = f"M0 0H10V10H0Z M0 0h{near}v{-near}z M10 10h5v5h-5z M3 3h2v{near}h-2z"  # a speck, a touch, a slit
    (tmp_path / "fine.svg").write_text(f'<svg><path fill-rule="evenodd" d="{data}"/></svg>')
    assert bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "fine.svg"), scale=1.0) == {"FINISHED"}
    assert solid(bpy.context.active_object).area == pytest.approx(125.0, rel=1e-4)
    generate("6")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        *(("a.txt", ""), ("a.svg", "hello"), ("a.geojson", "{")),
        ("b.geojson", '{"type": "FeatureCollection", "features": []}'),
        ("none.svg", None),
    ],
)
def test_files_that_cannot_be_read_are_refused(tmp_path, name, text) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    with refused(name):
        bpy.ops.object.nested_cages_import(filepath=str(tmp_path / name))
    assert not bpy.data.objects
