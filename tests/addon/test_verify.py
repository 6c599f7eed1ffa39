"""Verify Cages: finds what was broken by editing, and only that."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from drawings import circle, poly_curve, star, wire


@pytest.fixture
def cages(addon):
    """A star with two cages, on the last frame, the star's curve being active."""
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20, 10")
    return [bpy.data.objects[f"Drawing {name}"] for name in ("Fine", "Cage 1", "Cage 2")]


def selected(obj):
    return [vertex.index for vertex in obj.data.vertices if vertex.select]


def move(obj, index, place):
    """Edits a vertex of the result: of the mesh and of its Basis."""
    obj.data.vertices[index].co = place
    obj.data.shape_keys.key_blocks[0].points[index].co = place
    obj.data.update()


def test_untouched_cages_hold(cages) -> None:
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    for cage in cages[1:]:
        assert cage["nested_cages_check"].startswith("Holds on frame")
        assert cage["nested_cages_finding"].startswith(f"'{cage.name}' encloses")
    assert not any(selected(obj) for obj in cages)
    assert bpy.context.view_layer.objects.active.name == "Drawing"


def test_a_cage_that_was_pushed_in_is_found_with_its_vertices(cages) -> None:
    fine, inner, outer = cages
    move(inner, 3, (0.0, 0.0, 0.0))
    bpy.ops.object.nested_cages_verify()
    assert inner["nested_cages_check"].startswith("Broken on frame")
    assert "does not enclose 'Drawing Fine'" in inner["nested_cages_finding"]
    assert 3 in selected(inner)
    assert len(selected(inner)) < 8
    assert selected(fine)
    assert not selected(outer)
    assert set(bpy.context.selected_objects) == {fine, inner}


def test_a_cage_that_crosses_itself_is_found(addon) -> None:
    inner = wire("Inner", [circle(12)])
    # The edges 2-3 and 4-5 cross above the circle.
    outer = wire("Outer", [np.array([(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-1.0, 4.0), (1.0, 4.0), (-3.0, 3.0)])])
    inner.select_set(True)
    bpy.ops.object.nested_cages_verify()
    assert selected(outer) == [2, 3, 4, 5]
    assert not selected(inner)


def test_any_two_objects_can_be_checked(addon) -> None:
    wire("Inner", [circle(12, 0.5)])
    wire("Outer", [circle(8, 1.0, (0.7, 0.0))])
    bpy.data.objects["Inner"].select_set(True)
    bpy.ops.object.nested_cages_verify()
    inner, outer = bpy.data.objects["Inner"], bpy.data.objects["Outer"]
    assert {0, 1, 11}.isdisjoint(selected(inner))
    assert 6 in selected(inner)
    assert "nested_cages_check" not in outer
    outer.location.x = -0.7
    bpy.ops.object.nested_cages_verify()
    assert not selected(inner) and not selected(outer)


def test_it_says_what_to_select(addon) -> None:
    poly_curve("Drawing", [star()])
    with pytest.raises(RuntimeError, match="Select a drawing with its cages"):
        bpy.ops.object.nested_cages_verify()


def test_cages_whose_level_has_not_begun_are_left_out(cages) -> None:
    bpy.context.scene.frame_set(cages[1]["nested_cages_reinflation_start"])
    bpy.ops.object.nested_cages_verify()
    assert "nested_cages_check" in cages[1]
    assert "nested_cages_check" not in cages[2]


def test_thickness_is_for_renders_only(addon) -> None:
    source = poly_curve("Drawing", [star()])
    source.scale = (2.0, 2.0, 2.0)
    bpy.ops.object.nested_cages_generate(levels="20, 10", thickness=0.1)
    cage = bpy.data.objects["Drawing Cage 1"]
    modifier = cage.modifiers["Nested Cages Thickness"]
    assert modifier.show_render and not modifier.show_viewport
    modifier.show_viewport = True
    tube = cage.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points = np.array([vertex.co for vertex in tube.vertices])
    assert len(points) == 20 * 8
    assert points[:, 2].max() == pytest.approx(0.025, rel=1e-3)
    modifier.show_viewport = False
    bpy.ops.object.nested_cages_generate(levels="20, 10", thickness=0.0)
    assert not cage.modifiers
