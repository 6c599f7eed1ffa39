"""Handles move the corners of a bound cage, one each; only its outline is seen."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from support.drawings import circle, evaluated, poly_curve, star


@pytest.fixture
def cage():
    """The coarsest cage of a bound drawing that is not at the origin."""
    drawing = poly_curve("Drawing", [star(), circle(12, 0.3)])
    drawing.location, drawing.rotation_euler = (2.0, 1.0, 0.5), (0.0, 0.0, 0.7)
    bpy.context.view_layer.update()
    bpy.ops.object.nested_cages_generate(levels="24, 12")
    assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
    return bpy.data.objects["Drawing Cage 2"]


@pytest.mark.slow
def test_bound_cages_show_their_outline_alone(addon, cage) -> None:
    assert len(cage.data.polygons) and cage.display_type == "WIRE" and not cage.show_all_edges
    bpy.context.view_layer.update()
    found = {tuple(stroke.colour[:3]): stroke for stroke in addon.ui.overlay.strokes(bpy.context)}
    assert len(found) == 2
    coarsest = [stroke for stroke in found.values() if len(stroke.handles)]
    assert [len(stroke.ends) for stroke in coarsest] == [2 * len(cage.data.vertices)]
    assert len(coarsest[0].handles) == len(cage.data.vertices)
    corners = np.array([cage.matrix_world @ vertex.co for vertex in cage.data.vertices])
    np.testing.assert_allclose(coarsest[0].handles, corners, atol=1e-5)
    assert coarsest[0].width > addon.ui.overlay.WIDTH  # it is selected
    drawn = list(addon.ui.overlay.together(stroke._replace(width=2.0) for stroke in found.values()))
    assert [(kind, len(points)) for kind, _, points, _ in drawn] == [
        ("LINES", sum(len(stroke.ends) for stroke in found.values())),
        ("POINTS", len(corners)),
    ]
    assert {tuple(colour[:3]) for *_, colours in drawn for colour in colours} == {tuple(np.float32(c)) for c in found}
    before = tuple(look for _, look in addon.ui.overlay.looks(bpy.context))
    assert [look.handles for look in before] == [False, True]
    addon.ui.overlay._known[before] = []
    cage.location.x += 1.0
    bpy.context.view_layer.update()
    assert not addon.ui.overlay._known  # drawn anew
    cage.hide_set(True)
    assert len(list(addon.ui.overlay.strokes(bpy.context))) == 1


@pytest.mark.slow
def test_each_handle_moves_its_corner_and_the_drawing_follows(addon, cage) -> None:
    fine = bpy.data.objects["Drawing Fine"]
    before, drawing = evaluated(cage), evaluated(fine)
    assert bpy.ops.object.nested_cages_add_handles() == {"FINISHED"}
    assert bpy.context.mode == "POSE"
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    np.testing.assert_allclose(evaluated(cage), before, atol=1e-5)
    names = addon.binding.handles.names(cage)
    assert len(names) == len(before) and names[0] == "Drawing Cage 2 Corner 01"
    (rig,) = addon.binding.handles.handles_of(cage)
    assert [bone.name for bone in rig.data.bones] == names
    assert [len(group.bones) for group in rig.data.collections] == [len(names)]
    matrix = rig.pose.bones[names[3]].matrix.copy()
    matrix.translation.x += 0.25
    rig.pose.bones[names[3]].matrix = matrix
    bpy.context.view_layer.update()
    moved = evaluated(cage) - before
    np.testing.assert_allclose(moved[3], (0.25, 0.0, 0.0), atol=1e-5)
    np.testing.assert_allclose(np.delete(moved, 3, axis=0), 0.0, atol=1e-5)
    assert np.abs(evaluated(fine) - drawing).max() > 0.01


@pytest.mark.slow
def test_handles_are_for_bound_cages_and_added_once(cage) -> None:
    assert bpy.ops.object.nested_cages_add_handles() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = cage
    assert not bpy.ops.object.nested_cages_add_handles.poll()
    bpy.ops.object.nested_cages_unbind()
    assert not bpy.ops.object.nested_cages_add_handles.poll()
