"""Cages as curves, faces and prisms, cages as files, and outlines of images: against shapely and pixel by pixel."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest
import shapely

from drawings import circle, evaluated, in_world, poly_curve, solid, star

SIDE = 40


@pytest.fixture
def cages():
    """A drawing with a hole and its cages: the source, the fine mesh, the cages."""
    source = poly_curve("Drawing", [star() * 2.0, circle(20, 0.5)])
    source.location = (1.0, 2.0, 0.5)
    source.rotation_euler = (0.3, 0.2, 0.1)
    source.scale = (2.0, 2.0, 2.0)
    assert bpy.ops.object.nested_cages_generate(levels="24, 12") == {"FINISHED"}
    members = [obj for obj in bpy.data.objects if "nested_cages_level" in obj]
    fine, *found = sorted(members, key=lambda obj: obj["nested_cages_level"])
    return source, fine, found


def choose(*objects):
    for obj in bpy.data.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[-1]


def test_faces_fill_the_cage(cages) -> None:
    _, _, (inner, _) = cages
    choose(inner)
    assert bpy.ops.object.nested_cages_to_objects(shape="FILLED") == {"FINISHED"}
    made = bpy.context.active_object
    bpy.context.view_layer.update()
    assert made.matrix_world == inner.matrix_world
    assert sum(face.area for face in made.data.polygons) == pytest.approx(solid(inner).area, rel=1e-5)
    assert all(face.normal.z > 0.999 for face in made.data.polygons)


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


def test_a_drawing_goes_to_svg_with_all_its_cages(cages, core, tmp_path) -> None:
    source, fine, both = cages
    choose(source)
    path = tmp_path / "cages.svg"
    assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG", flip_y=False) == {"FINISHED"}
    for obj in (fine, *both):
        back = core.exchange.read_svg(path, element=obj.name)
        assert shapely.equals(shapely.normalize(shapely.geometry.shape(back)), shapely.normalize(solid(obj)))


def test_geojson_comes_back_certified(cages, core, tmp_path) -> None:
    source, _, _ = cages
    choose(source)
    path = tmp_path / "cages.geojson"
    assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="GEOJSON") == {"FINISHED"}
    fine, inner, outer = (f.mesh for f in core.exchange.features_from_geojson(path.read_bytes()))
    assert core.verify(inner, fine).holds
    assert core.verify(outer, inner).holds


def test_the_engine_gets_the_outermost(cages, core, tmp_path) -> None:
    source, _, both = cages
    choose(source)
    path = tmp_path / "cages.json"
    assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="ENGINE", triangles=True) == {"FINISHED"}
    document = json.loads(path.read_text())
    assert len(document["points"]) == len(both[-1].data.vertices)
    back = core.exchange.from_engine_json(path.read_text(), flip_y=0.0)
    assert shapely.geometry.shape(back).area == pytest.approx(solid(both[-1]).area)


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
