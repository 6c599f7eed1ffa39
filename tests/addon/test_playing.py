"""One action for all cages of a drawing, and cages without their animation."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from support.drawings import at_frame, edges_of, evaluated, facts, poly_curve, set_in, star

slotted = pytest.mark.skipif(bpy.app.version < (4, 4, 0), reason="actions have no slots")


@pytest.fixture
def cages():
    """The collection, the fine mesh and the cages of two levels."""
    poly_curve("Drawing", [star()])
    assert bpy.ops.object.nested_cages_generate(levels="20, 10") == {"FINISHED"}
    collection = bpy.data.collections["Drawing Cages"]
    return collection, *sorted(collection.objects, key=lambda obj: facts(obj)["level"])


@pytest.mark.slow
def test_the_drawing_is_hidden_as_long_as_the_new_animation_plays(cages) -> None:
    collection, *_ = cages
    end = facts(collection)["end"]
    at_frame(end)
    bpy.data.objects["Drawing"].select_set(True)
    bpy.ops.object.nested_cages_generate(levels="20, 10", frames_per_step=1)
    assert facts(collection)["end"] < end and set_in(collection).record.parts[0].hidden
    for frame in (facts(collection)["end"] - 1, facts(collection)["end"]):
        at_frame(frame)
        assert bpy.data.objects["Drawing"].hide_viewport == (frame < facts(collection)["end"])
    bpy.ops.object.nested_cages_remove_animation()
    assert bpy.data.objects["Drawing"].animation_data is None


@slotted
def test_all_cages_of_a_drawing_share_one_action(cages) -> None:
    collection, fine, *others = cages
    action = bpy.data.actions["Drawing Cages"]
    # What hides the drawing while it plays, and its moving copy afterwards, is in another one.
    assert {other.name for other in bpy.data.actions if other != action} == {"Drawing"}
    owners = [fine.data.shape_keys, *others, *(cage.data.shape_keys for cage in others)]
    assert all(owner.animation_data.action == action for owner in owners)
    slots = {owner.animation_data.action_slot.identifier for owner in owners}
    assert len(slots) == len(action.slots) == len(owners)  # the fine mesh is never hidden
    at_frame(facts(collection)["end"])
    others[0].keyframe_insert("location", frame=5)
    bpy.ops.object.nested_cages_generate(levels="20, 10")
    own = others[0].animation_data.action
    assert {action.name for action in bpy.data.actions} == {"Drawing Cages", "Drawing", own.name}
    assert len(own.slots) == 1 and len(bpy.data.actions["Drawing Cages"].slots) == len(owners) - 1
    assert others[1].animation_data.action == bpy.data.actions["Drawing Cages"]


@pytest.mark.slow
def test_without_the_animation_the_cages_stay(cages) -> None:
    scene = bpy.context.scene
    collection, *objects = cages
    end = facts(collection)["end"]
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
