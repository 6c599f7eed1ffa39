"""Verify Cages: finds what was broken by editing, and only that."""

import re

import bpy
import numpy as np
import pytest

from support.blender import new_file, refused
from support.drawings import bind, certificate, checked, circle, generate, holds, poly_curve, star, verify, wire


@pytest.fixture
def cages():
    """A star with two cages, on the last frame, the star's curve being active."""
    poly_curve("Drawing", [star()])
    generate("20, 10")
    return [bpy.data.objects[f"Drawing {name}"] for name in ("Fine", "Cage 1", "Cage 2")]


def selected(obj):
    return [vertex.index for vertex in obj.data.vertices if vertex.select]


def move(obj, index, place):
    """Edits a vertex of the result: of the mesh and of its Basis."""
    obj.data.vertices[index].co = place
    obj.data.shape_keys.key_blocks[0].points[index].co = place
    obj.data.update()


def test_untouched_cages_hold(cages) -> None:
    assert verify(*cages[1:])
    for cage in cages[1:]:
        assert checked(cage) == [bpy.context.scene.frame_current] and f"'{cage.name}'" in certificate(cage).finding
    assert not any(selected(obj) for obj in cages)
    assert bpy.context.view_layer.objects.active.name == "Drawing"


def test_a_cage_that_was_pushed_in_is_found_with_its_vertices(cages) -> None:
    fine, inner, outer = cages
    move(inner, 3, (0.0, 0.0, 0.0))
    assert not verify(inner) and checked(inner) == [bpy.context.scene.frame_current]
    assert "'Drawing Fine'" in certificate(inner).finding
    assert 3 in selected(inner)
    assert len(selected(inner)) < 8
    assert selected(fine)
    assert not selected(outer)
    assert set(bpy.context.selected_objects) == {fine, inner}


def test_a_cage_that_crosses_itself_is_found() -> None:
    inner = wire("Inner", [circle(12)])
    # The edges 2-3 and 4-5 cross above the circle.
    outer = wire("Outer", [np.array([(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-1.0, 4.0), (1.0, 4.0), (-3.0, 3.0)])])
    inner.select_set(True)
    bpy.ops.object.nested_cages_verify()
    assert selected(outer) == [2, 3, 4, 5]
    assert not selected(inner)


def test_what_is_in_a_hole_of_a_cage_or_outside_is_at_fault_and_nothing_else() -> None:
    islands = [circle(12, 0.2), circle(12, 0.1, (0.9, 0.0)), circle(12, 0.1, (3.0, 0.0))]
    inner = wire("Inner", islands)  # in the hole, in the cage, and outside
    wire("Outer", [circle(24, 1.3), circle(16, 0.5)])
    inner.select_set(True)
    bpy.ops.object.nested_cages_verify()
    assert selected(inner) == [*range(12), *range(24, 36)]


def test_cages_whose_level_has_not_begun_are_left_out(cages) -> None:
    bpy.context.scene.frame_set(certificate(cages[1]).frames[1])
    bpy.ops.object.nested_cages_verify()
    assert holds(cages[1]) is not None
    assert holds(cages[2]) is None


@pytest.fixture
def keyed():
    """A star and a cage with room, of which a vertex moves into the star from frame 1 to frame 20; it is frame 3.5."""
    poly_curve("Drawing", [star()])
    generate("12", clearance=0.02)
    bind()
    fine, cage = (bpy.data.objects[f"Drawing {name}"] for name in ("Fine", "Cage 1"))
    cage.shape_key_add(name="Basis")
    key = cage.shape_key_add(name="Fold")
    far = max(range(12), key=lambda index: key.points[index].co.x)
    key.points[far].co.x *= -0.9
    for frame, value in ((1, 0.0), (20, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 20
    scene.frame_set(3, subframe=0.5)
    return fine, cage


@pytest.mark.slow
def test_the_first_frame_with_a_fault_is_found(keyed) -> None:
    fine, cage = keyed
    scene = bpy.context.scene
    verdicts, wrong = [], []
    for frame in range(1, 21):
        scene.frame_set(frame)
        verdicts.append(verify(cage))
        wrong.append((selected(fine), selected(cage)))
    first = next(frame for frame, verdict in enumerate(verdicts, 1) if not verdict)
    assert 2 < first < 20

    scene.frame_set(3, subframe=0.5)
    assert not verify(cage, whole=True) and checked(cage) == [first]
    assert str(first) in certificate(cage).finding and f"'{cage.name}'" in certificate(cage).finding
    assert (selected(fine), selected(cage)) == wrong[first - 1]
    assert (scene.frame_current, scene.frame_subframe) == (3, 0.5)

    scene.frame_end = first - 1
    assert verify(cage, whole=True) and checked(cage) == [1, first - 1]
    assert not selected(fine) and not selected(cage)


def test_the_least_clearance_of_all_frames_is_told(reports) -> None:
    inner = wire("Inner", [circle(12, 0.5)])
    outer = wire("Outer", [circle(4, 2.0)])  # a square whose sides are sqrt(2) from its middle
    inner.select_set(True)
    for frame, x in ((1, 0.0), (5, 0.4), (9, 0.0)):
        outer.location.x = x
        outer.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 9
    reports.read()
    verify(whole=True)
    told = [float(number) for number in re.findall(r"\d+\.\d+", reports.read("Info"))]
    corners = circle(12, 0.5) - (0.4, 0.0)
    gap = (2.0 - np.abs(corners).sum(axis=1).max()) / np.sqrt(2.0)
    assert any(number == pytest.approx(gap, rel=0.01) for number in told)


def test_a_frame_that_cannot_be_read_is_named() -> None:
    inner = wire("Inner", [circle(12, 0.5)])
    outer = wire("Outer", [circle(8, 2.0)])
    inner.select_set(True)
    for frame, turn in ((6, 0.0), (7, 0.5)):
        outer.rotation_euler.y = turn
        outer.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_set(3)
    with refused("'Outer'"):
        bpy.ops.object.nested_cages_verify(whole=True)
    assert bpy.context.scene.frame_current == 3


@pytest.mark.slow
def test_steps_that_cross_on_purpose_are_no_fault(cages) -> None:
    scene = bpy.context.scene
    before = scene.frame_current
    with refused("'Drawing Cages'"):
        bpy.ops.object.nested_cages_verify(whole=True)
    assert scene.frame_current == before
    bpy.ops.object.nested_cages_remove_animation()
    scene.frame_end = 8
    bpy.ops.object.nested_cages_verify(whole=True)
    for cage in cages[1:]:
        assert holds(cage) and checked(cage) == [scene.frame_start, scene.frame_end]


@pytest.mark.slow
def test_thickness_is_for_renders_only() -> None:
    source = poly_curve("Drawing", [star()])
    source.scale = (2.0, 2.0, 2.0)
    generate("20, 10", thickness=0.1)
    cage = bpy.data.objects["Drawing Cage 1"]
    modifier = cage.modifiers["Nested Cages Thickness"]
    assert modifier.show_render and not modifier.show_viewport
    modifier.show_viewport = True
    tube = cage.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points = np.array([vertex.co for vertex in tube.vertices])
    assert len(points) == 20 * 8
    assert points[:, 2].max() == pytest.approx(0.025, rel=1e-3)
    modifier.show_viewport = False
    generate("20, 10", thickness=0.0)
    (automatic,) = cage.modifiers
    assert automatic.name == "Nested Cages Automatic Thickness" and automatic.show_render
    assert not automatic.show_viewport
    for seen in (False, True):
        assert bpy.ops.object.nested_cages_bind() == {"FINISHED"} and automatic.show_render is seen


EIGHT = np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])


def test_select_fault_goes_to_the_spot() -> None:
    crossing = wire("Eight", [EIGHT])
    crossing.location.x = 2.0
    bpy.context.view_layer.update()
    with refused("'Eight'"):
        generate("3")
    assert bpy.ops.object.nested_cages_select_fault() == {"FINISHED"}
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [vertex.select for vertex in crossing.data.vertices] == [True] * 4
    np.testing.assert_allclose(bpy.context.scene.cursor.location, (2.5, 0.5, 0.0), atol=1e-6)
    new_file()  # another file: session IDs begin anew
    wire("Other", [star()])
    assert not bpy.ops.object.nested_cages_select_fault.poll()


def test_select_fault_finds_the_ends_of_an_open_curve() -> None:
    line = poly_curve("Open", [star()], cyclic=False)
    with refused("'Open'"):
        bpy.ops.object.nested_cages_generate()
    bpy.ops.object.nested_cages_select_fault()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [point.select for point in line.data.splines[0].points] == [True, *[False] * 58, True]
