"""One action for everything, and cages without their animation: what is seen stays as it was."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from drawings import at_frame, edges_of, evaluated, poly_curve, star

slotted = pytest.mark.skipif(bpy.app.version < (4, 4, 0), reason="actions have no slots")


@pytest.fixture
def cages():
    """The collection, the fine mesh and the cages of two levels."""
    poly_curve("Drawing", [star()])
    assert bpy.ops.object.nested_cages_generate(levels="20, 10", ease=True, loop_back=True) == {"FINISHED"}
    collection = bpy.data.collections["Drawing Cages"]
    return collection, *sorted(collection.objects, key=lambda obj: obj["nested_cages_level"])


def poses(collection, frames):
    return [
        [(obj.hide_viewport, evaluated(obj, depsgraph)) for obj in collection.objects]
        for depsgraph in map(at_frame, frames)
    ]


def assert_same(before, after) -> None:
    for pose, other in zip(before, after, strict=True):
        for (hidden, points), (still_hidden, others) in zip(pose, other, strict=True):
            assert hidden == still_hidden
            np.testing.assert_array_equal(points, others)


@pytest.mark.slow
@slotted
def test_one_action_plays_what_many_did(cages) -> None:
    collection, *objects = cages
    frames = np.linspace(1, bpy.context.scene.frame_end + 3, 40)
    before = poses(collection, frames)
    assert bpy.ops.object.nested_cages_bake_action() == {"FINISHED"}
    assert_same(before, poses(collection, frames))
    action = bpy.data.actions["Drawing Cages"]
    # What hides the drawing while it plays, and its moving copy afterwards, is no part of it.
    assert {other.name for other in bpy.data.actions if other != action} == {"Drawing", "Drawing Moving"}
    for obj in objects[1:]:
        assert obj.animation_data.action == obj.data.shape_keys.animation_data.action == action
    assert len(action.slots) == 2 * len(objects) - 1  # the fine mesh is never hidden


@pytest.mark.slow
@slotted
def test_one_action_survives_binding_and_goes_with_new_cages(cages) -> None:
    collection, *_ = cages
    frames = np.linspace(1, bpy.context.scene.frame_end, 20)
    bpy.ops.object.nested_cages_bake_action()
    before = poses(collection, frames)
    assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
    assert not bpy.ops.object.nested_cages_bake_action.poll()
    assert not bpy.ops.object.nested_cages_remove_animation.poll()
    assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
    assert_same(before, poses(collection, frames))
    at_frame(collection["nested_cages_end"])
    for obj in bpy.data.objects:
        obj.select_set(obj.name == "Drawing")
    bpy.ops.object.nested_cages_generate(levels="20, 10")
    assert "Drawing Cages" not in bpy.data.actions


@pytest.mark.slow
def test_without_the_animation_the_cages_stay(cages) -> None:
    scene = bpy.context.scene
    collection, *objects = cages
    end = collection["nested_cages_end"]
    depsgraph = at_frame(end)
    home, edges = [evaluated(obj, depsgraph) for obj in objects], [edges_of(obj) for obj in objects]
    objects[1].keyframe_insert("location", frame=1)
    at_frame(7)
    assert bpy.ops.object.nested_cages_remove_animation() == {"FINISHED"}
    for frame in (-3, 7, end, end + 100):
        depsgraph = at_frame(frame)
        for obj, points, lines in zip(objects, home, edges, strict=True):
            np.testing.assert_array_equal(evaluated(obj, depsgraph), points)
            np.testing.assert_array_equal(edges_of(obj), lines)
            assert not obj.hide_viewport and not obj.hide_render
            assert obj.data.shape_keys is None
    assert [obj.animation_data is not None for obj in objects] == [False, True, False]
    assert len(bpy.data.actions) == 1
    assert not scene.timeline_markers
    assert scene.frame_end == 250
    assert not bpy.ops.object.nested_cages_remove_animation.poll()
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    bpy.data.objects["Drawing"].select_set(True)  # Blender deselects what an animation hides
    assert bpy.ops.object.nested_cages_generate(levels="20, 10") == {"FINISHED"}


@slotted
def test_curves_modifiers_are_not_lost(cages) -> None:
    _, _, cage, _ = cages
    cage.keyframe_insert("location", index=0, frame=1)
    action = cage.animation_data.action
    curve = next(c for c in action.layers[0].strips[0].channelbags[0].fcurves if c.data_path == "location")
    curve.modifiers.new("NOISE")
    with pytest.raises(RuntimeError, match="'Drawing Cage 1' have modifiers"):
        bpy.ops.object.nested_cages_bake_action()
    assert "Drawing Cages" not in bpy.data.actions
