"""What cages must be, apart from tight, as stored: on a grid, convex, symmetric, finer where it matters."""

from itertools import pairwise

import bpy
import numpy as np
import pytest
import shapely

from support import drawings
from support.blender import refused
from support.drawings import (
    armature,
    at_frame,
    certificate,
    circle,
    generate,
    made,
    poly_curve,
    solid,
    star,
    weigh,
    wire,
)

pytestmark = pytest.mark.slow


def cages():
    return made()[1:]


def points(cage):
    """(m, 2) vertices as stored."""
    return drawings.base(cage)[:, :2]


def assert_nested():
    depsgraph = at_frame(9000)
    shapes = [solid(obj, depsgraph) for obj in made()]
    for inner, outer in pairwise(shapes):
        assert outer.contains_properly(inner)
    return shapes


def test_every_level_is_on_the_grid() -> None:
    poly_curve("Drawing", [star(60, 0.3)])
    generate("24, 12", grid=0.125)
    assert_nested()
    for cage in cages():
        assert (points(cage) % 0.125 == 0.0).all()
    bpy.data.objects["Drawing"].scale = (2.0, 2.0, 2.0)
    generate("24", grid=0.125)
    assert (points(cages()[0]) % 0.0625 == 0.0).all()
    assert (points(cages()[0]) % 0.125 != 0.0).any()


def test_convex_cages_have_so_many_vertices_around_each_part() -> None:
    poly_curve("Drawing", [star(), circle(30, 0.3), circle(20, 0.5, (4.0, 0.0))])
    generate("6, 4", convex=True)
    depsgraph = at_frame(9000)
    fine = solid(bpy.data.objects["Drawing Fine"], depsgraph)
    for cage, count in zip(cages(), (6, 4), strict=True):
        shape = solid(cage, depsgraph)
        parts = list(shape.geoms)
        assert len(parts) == 2
        for part in parts:
            assert len(part.exterior.coords) - 1 == count
            assert part.convex_hull.area == pytest.approx(part.area, rel=1e-6)
        assert shape.contains_properly(fine)
    with refused():
        generate("6", convex=True, inside=True)


@pytest.mark.parametrize("symmetry", ["MIRROR_X", "FOUND"])
def test_mirrored_vertices_are_mirrored_to_the_last_bit(symmetry) -> None:
    loop = star(61, 0.2, 3)[:, ::-1]  # symmetric about the y axis only
    poly_curve("Drawing", [loop])
    generate("18, 9", symmetry=symmetry)
    assert_nested()
    for cage in cages():
        found = {tuple(point) for point in points(cage).tolist()}
        mirrored = {(-x, y) for x, y in found}
        if symmetry == "MIRROR_X":
            assert found == mirrored
        else:
            gaps = [min(max(abs(x - u), abs(y - v)) for u, v in found) for x, y in mirrored]
            assert max(gaps) < 1e-5
    assert bool(certificate(cages()[0]).notes) or symmetry == "MIRROR_X"  # what was found is said


def test_rotations_and_mirrors_of_a_drawing_away_from_the_origin() -> None:
    poly_curve("Drawing", [star(60, 0.25, 5) + np.array([7.0, 3.0])])
    generate("15", symmetry="ROTATION", symmetry_order=5)
    assert_nested()
    middle = 0.5 * (star(60).min(axis=0) + star(60).max(axis=0)) + np.array([7.0, 3.0])
    away = np.linalg.norm(points(cages()[0]) - middle, axis=1)
    values, counts = np.unique(np.round(away, 4), return_counts=True)
    assert (counts % 5 == 0).all(), values
    generate("16", symmetry="MIRROR_Y")
    y = np.sort(points(cages()[0])[:, 1] - 3.0)
    assert np.abs(y + y[::-1]).max() < 1e-5


def test_rules_that_exclude_each_other_are_refused() -> None:
    poly_curve("Drawing", [star()])
    for rules in (
        {"symmetry": "ROTATION", "symmetry_order": 5, "grid": 0.1},
        {"min_angle": 0.5, "convex": True},
        {"symmetry": "FOUND", "as_published": True},
    ):
        with refused():
            generate("16", **rules)
    assert "Drawing Cages" not in bpy.data.collections


def test_a_symmetry_and_a_grid_go_together() -> None:
    poly_curve("Drawing", [star()])
    generate("16", symmetry="MIRROR_Y", grid=0.1)
    assert_nested()
    found = np.round(points(cages()[0]) / 0.1, 4)
    assert np.array_equal(found, np.round(found))
    assert {tuple(point) for point in found.tolist()} == {(x, -y) for x, y in found.tolist()}


def test_painted_weights_draw_vertices() -> None:
    obj = wire("Drawing", [star(120, 0.2, 9)])
    generate("20, 14")
    right = [(points(cage)[:, 0] > 0.0).sum() for cage in cages()]
    weigh(obj, "Matters", np.where(star(120, 0.2, 9)[:, 0] > 0.0, 1.0, 0.05))
    generate("20, 14", weight_group="Matters")
    assert_nested()
    weighted = [(points(cage)[:, 0] > 0.0).sum() for cage in cages()]
    assert all(after > before for before, after in zip(right, weighted, strict=True))


def test_pins_of_a_vertex_group_are_kept_on_every_level() -> None:
    loop = star(120, 0.25, 5)
    obj = wire("Drawing", [loop])
    obj.location, obj.rotation_euler.z = (5.0, 1.0, 0.0), 1.0
    bpy.context.view_layer.update()
    tips = [24, 48]
    weigh(obj, "Pins", [1.0 if k in tips else 0.3 for k in range(120)])
    generate("20, 10", pin_group="Pins")
    assert_nested()
    for cage in cages():
        for tip in tips:
            assert np.linalg.norm(points(cage) - loop[tip], axis=1).min() < 0.01
    assert not certificate(cages()[0]).notes


def test_bones_are_joints() -> None:
    bar = np.array([(x, y) for x, y in shapely.box(-2.0, -0.3, 2.0, 0.3).segmentize(0.1).exterior.coords[:-1]])
    wire("Drawing", [bar])
    armature("Rig", Arm=((-1.0, 0.0, 0.0), (0.5, 0.0, 0.0)))
    drawings.choose(bpy.data.objects["Drawing"])
    generate("8", joint_armature="Rig")
    found = points(cages()[0])
    for joint in ((-1.0, 0.3), (-1.0, -0.3), (0.5, 0.3), (0.5, -0.3)):
        assert np.linalg.norm(found - joint, axis=1).min() < 0.02
    with refused("'Nobody'"):
        generate("8", joint_armature="Nobody")


def test_short_edges_and_sharp_angles_are_avoided() -> None:
    poly_curve("Drawing", [star(120, 0.3, 7)])
    generate("20", min_edge=0.2, min_angle=np.radians(50.0))
    (shape,) = assert_nested()[1:]
    corners = np.array(shape.exterior.coords)
    assert np.linalg.norm(np.diff(corners, axis=0), axis=1).min() > 0.2 * (1 - 1e-5)


@pytest.mark.parametrize(("directions", "turns"), [("AXES", 90.0), ("TRANSIT", 45.0)])
def test_edges_have_few_directions(directions: str, turns: float) -> None:
    poly_curve("Drawing", [star(120, 0.3, 7)])
    generate("24", directions=directions)
    (shape,) = assert_nested()[1:]
    edge = np.diff(np.array(shape.exterior.coords), axis=0)
    angle = np.degrees(np.arctan2(edge[:, 1], edge[:, 0]))
    assert np.abs((angle + 0.5 * turns) % turns - 0.5 * turns).max() < 1e-3


def test_parts_share_one_loop() -> None:
    poly_curve("Drawing", [circle(40), circle(40) + np.array([2.1, 0.0])])
    generate("5", loops="one")
    assert len(points(cages()[0])) == 5
    assert not certificate(cages()[0]).keeps_loops and certificate(cages()[0]).notes
    with refused():
        generate("12", loops="one", symmetry="FOUND")


def test_a_group_that_is_not_there_is_named() -> None:
    wire("Drawing", [star()])
    generate("16", weight_group="Nothing")
    assert certificate(cages()[0]).notes


def test_cages_with_rules_do_not_follow() -> None:
    poly_curve("Drawing", [star()])
    generate("16", grid=0.1)
    with refused():
        bpy.ops.object.nested_cages_live()
    with refused():
        bpy.ops.object.nested_cages_follow(levels="16", symmetry="FOUND")
    generate("16")
    assert bpy.ops.object.nested_cages_live.poll()


def test_inner_cages_keep_rules_too() -> None:
    poly_curve("Drawing", [star(61, 0.2, 3)[:, ::-1]])
    generate("16, 10", symmetry="MIRROR_X", inside=True)
    for cage in made(inside=True)[1:]:
        found = {tuple(point) for point in points(cage).tolist()}
        assert found == {(-x, y) for x, y in found}
