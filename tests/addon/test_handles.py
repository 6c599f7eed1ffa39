"""Handles move the corners of a bound cage, one each; only its outline is seen."""

import bpy
import numpy as np
import pytest

from support.drawings import circle, evaluated, poly_curve, set_of, star


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
def test_each_handle_moves_its_corner_and_the_drawing_follows(cage) -> None:
    assert len(cage.data.polygons) and cage.display_type == "WIRE" and not cage.show_all_edges
    fine = set_of(cage).fine
    before, drawing = evaluated(cage), evaluated(fine)
    assert bpy.ops.object.nested_cages_add_handles() == {"FINISHED"}
    assert bpy.context.mode == "POSE"
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    np.testing.assert_allclose(evaluated(cage), before, atol=1e-5)
    rig = next(modifier.object for modifier in cage.modifiers if modifier.type == "ARMATURE")
    assert len(rig.pose.bones) == len(before)
    corners = np.array([(cage.matrix_world.inverted() @ rig.matrix_world @ bone.head)[:] for bone in rig.pose.bones])
    np.testing.assert_allclose(corners, before, atol=1e-5)
    assert [len(group.bones) for group in rig.data.collections] == [len(before)]
    bone = rig.pose.bones[3]
    matrix = bone.matrix.copy()
    matrix.translation.x += 0.25
    bone.matrix = matrix
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
