"""Silhouettes: what several objects paint, as one outline; and letters that are united before they are caged."""

from typing import Any

import bpy
import numpy as np
import pytest
import shapely

from support import drawings
from support.blender import refused
from support.drawings import apart, circle, evaluated, faces_of, generate, poly_curve, silhouette, solid, star, wire
from support.marks import slow_after


def filled(made: Any) -> Any:
    """The faces of a flat mesh object in its own x and y, united."""
    return faces_of(made, drawings.base(made)[:, :2])


def disc(radius: float, middle: tuple[float, float] = (0.0, 0.0), count: int = 48) -> Any:
    return shapely.Polygon(circle(count, radius, middle))


def test_layers_in_different_depths_that_cross_are_one_outline() -> None:
    one, two, three = (
        wire("One", [circle(48)]),
        poly_curve("Two", [circle(48, 1.0, (0.9, 0.0))]),
        wire("Far", [circle(48, 0.5, (5.0, 0.0))]),
    )
    two.location.z, three.location.z = 0.001, 2.0
    made = silhouette(one, two, three)
    assert made.name == "Far Silhouette" and len(made.data.polygons) > 0
    assert apart(filled(made), disc(1.0) | disc(1.0, (0.9, 0.0)) | disc(0.5, (5.0, 0.0))) < 1e-6
    generate("30")


def test_coordinates_stay_where_nothing_crosses() -> None:
    made = silhouette(wire("Star", [star()]))
    there = {tuple(point) for point in np.array([v.co[:2] for v in made.data.vertices])}
    assert there == {tuple(point) for point in star().astype(np.float32).astype(float)}


def test_holes_are_kept_filled_or_hidden_by_other_layers() -> None:
    ring, spot = wire("Ring", [circle(48), circle(24, 0.5)]), wire("Spot", [circle(24, 0.2)])
    bpy.context.view_layer.objects.active = ring
    assert apart(filled(silhouette(ring, spot)), (disc(1.0) - disc(0.5, count=24)) | disc(0.2, count=24)) < 1e-6
    assert apart(filled(silhouette(ring, spot, holes=False)), disc(1.0)) < 1e-6


def test_a_solid_seen_from_each_side() -> None:
    bpy.ops.mesh.primitive_cube_add(size=2.0, scale=(1.0, 2.0, 3.0))
    cube = bpy.context.object
    for plane, wanted in (("TOP", 8.0), ("FRONT", 12.0), ("RIGHT", 24.0)):
        bpy.ops.object.select_all(action="DESELECT")
        bpy.context.view_layer.objects.active = cube
        made = silhouette(cube, plane=plane)
        assert filled(made).area == pytest.approx(wanted)


def test_gaps_are_joined_if_asked() -> None:
    one, two = wire("One", [circle(48)]), wire("Two", [circle(48, 1.0, (2.05, 0.0))])
    assert len(filled(silhouette(one, two)).buffer(1e-5).geoms) == 2
    assert filled(silhouette(one, two, gap=0.2)).buffer(1e-5).geom_type == "Polygon"


def test_a_thick_curve_counts_with_its_width() -> None:
    line = poly_curve("Line", [np.array([[0.0, 0.0], [2.0, 0.0]])], cyclic=False, dimensions="3D")
    line.data.bevel_depth = 0.25
    assert filled(silhouette(line)).area == pytest.approx(1.0, rel=0.02)


def test_an_open_line_without_a_width_is_told_and_skipped(reports) -> None:
    line = poly_curve("Line", [np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])], cyclic=False, dimensions="3D")
    with refused("'Line'"):
        silhouette(line)
    reports.read()
    assert apart(filled(silhouette(line, wire("Ring", [circle(48)]))), disc(1.0)) < 1e-6
    assert "'Line'" in reports.read("Warning")


@pytest.mark.parametrize("body", slow_after(2, ["Q", "€", "π", "__", "AVA"]))
def test_letters_that_touch_or_overlap_are_united(body: str) -> None:
    obj = drawings.text("Text", body)
    if body == "AVA":
        obj.data.space_character = 0.7
    generate("40%")
    fine = bpy.data.objects["Text Fine"]
    assert solid(fine).is_valid and solid(fine).area > 0.0
    assert body != "__" or solid(fine).geom_type == "Polygon"


@pytest.mark.slow
def test_letters_that_do_not_touch_keep_their_coordinates() -> None:
    obj = drawings.text("Text", "Ag&")
    obj.data.fill_mode = "NONE"
    bpy.context.view_layer.update()
    shown = {tuple(point) for point in evaluated(obj).tolist()}
    obj.data.fill_mode = "FRONT"
    generate("40%")
    assert {tuple(point) for point in drawings.base(bpy.data.objects["Text Fine"]).tolist()} == shown
