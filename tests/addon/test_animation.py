"""Steps to keyframes: evaluated through the dependency graph, on and between frames, against the steps themselves."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from support.drawings import at_frame, circle, evaluated, wire

FLOW_END, STEPS, PER_STEP = 3, 9, 4


@pytest.fixture
def level(addon):
    """A level whose fine mesh shrinks and comes home while the cage stands and then grows."""
    fine, cage = circle(20), circle(8, 1.3)
    shrink = np.array([1.0, 0.9, 0.8, 0.7, 0.75, 0.8, 0.9, 1.0, 1.0])
    grow = np.array([0.8, 0.8, 0.8, 0.8, 0.85, 0.9, 1.0, 1.1, 1.0])
    return SimpleNamespace(
        phases=addon.animation.timeline.Phases(FLOW_END, 7, STEPS - 1),
        fine_steps=(fine[None] * shrink[:, None, None]).astype(np.float32),
        cage_steps=(cage[None] * grow[:, None, None]).astype(np.float32),
    )


@pytest.mark.slow
def test_levels_play_one_after_the_other(addon, level) -> None:
    timing = addon.animation.timeline.Timing(start_frame=10, frames_per_step=PER_STEP)
    first, second = addon.animation.timeline.spans([level.phases] * 2, timing)
    assert (first.flow, first.reinflation, first.tightening, first.end) == (10, 22, 38, 42)
    assert second.flow == first.end + PER_STEP
    assert second.end - second.flow == first.end - first.flow


def test_without_the_flow_the_animation_starts_at_the_reinflation(addon, level) -> None:
    (span,) = addon.animation.timeline.spans(
        [level.phases], addon.animation.timeline.Timing(5, PER_STEP, show_flow=False)
    )
    assert (span.flow, span.reinflation, span.end) == (5, 5, 5 + (STEPS - 1 - FLOW_END) * PER_STEP)


@pytest.mark.parametrize("which", ["fine_steps", "cage_steps"])
def test_each_step_is_on_its_frame_and_the_motion_is_linear(addon, level, which) -> None:
    steps = getattr(level, which)
    obj = wire("Object", [steps[-1]])
    frames = 1 + np.arange(STEPS) * PER_STEP
    addon.animation.shape_keys.add_steps(obj, steps, frames, "Level 1")
    rounding = 4.0 * np.finfo(np.float32).eps * np.abs(steps).max()
    for step, frame in enumerate(frames):
        found = evaluated(obj, at_frame(frame))[:, :2]
        np.testing.assert_allclose(found, steps[step], rtol=0.0, atol=rounding)
        if step + 1 < STEPS:
            for part in (0.25, 0.5, 0.875):
                found = evaluated(obj, at_frame(frame + part * PER_STEP))[:, :2]
                expected = steps[step].astype(float) * (1.0 - part) + steps[step + 1].astype(float) * part
                np.testing.assert_allclose(found, expected, rtol=0.0, atol=rounding)
    np.testing.assert_array_equal(evaluated(obj, at_frame(frames[-1]))[:, :2], steps[-1])
    np.testing.assert_array_equal(evaluated(obj, at_frame(500))[:, :2], steps[-1])
    np.testing.assert_allclose(evaluated(obj, at_frame(-50))[:, :2], steps[0], rtol=0.0, atol=rounding)


def test_a_mesh_that_stands_still_has_one_key_for_it(addon, level) -> None:
    obj = wire("Object", [level.cage_steps[-1]])
    addon.animation.shape_keys.add_steps(obj, level.cage_steps, 1 + np.arange(STEPS) * PER_STEP, "Level 1")
    # The Basis, the coarse mesh during the flow, and four steps; step 6 and the last one are the Basis themselves.
    assert len(obj.data.shape_keys.key_blocks) == 1 + 1 + 3


def test_without_its_animation_an_object_shows_the_result(addon, level) -> None:
    obj = wire("Object", [level.fine_steps[-1]])
    addon.animation.shape_keys.add_steps(obj, level.fine_steps, 1 + np.arange(STEPS) * PER_STEP, "Level 1")
    at_frame(13)
    addon.animation.shape_keys.remove_animation(obj.data.shape_keys)
    for key in obj.data.shape_keys.key_blocks:
        key.value = 0.0
    np.testing.assert_array_equal(evaluated(obj)[:, :2], level.fine_steps[-1])
    assert not bpy.data.actions


def test_two_levels_on_one_object_do_not_mix(addon, level) -> None:
    obj = wire("Object", [level.fine_steps[-1]])
    addon.animation.shape_keys.add_steps(obj, level.fine_steps, 1 + np.arange(STEPS) * PER_STEP, "Level 1")
    addon.animation.shape_keys.add_steps(obj, level.fine_steps, 101 + np.arange(STEPS) * PER_STEP, "Level 2")
    for step in range(STEPS):
        first = evaluated(obj, at_frame(1 + step * PER_STEP))
        second = evaluated(obj, at_frame(101 + step * PER_STEP))
        np.testing.assert_array_equal(first, second)


def test_markers_are_taken_back_once_each(addon) -> None:
    scene = bpy.context.scene
    mine = ("Drawing", 30)
    scene.timeline_markers.new(mine[0], frame=mine[1])
    addon.animation.timeline.settle(scene, [], [mine, mine])
    assert [(marker.name, marker.frame) for marker in scene.timeline_markers] == [mine]
    scene.timeline_markers.new(mine[0], frame=mine[1])
    addon.animation.timeline.settle(scene, [mine, mine])
    assert [(marker.name, marker.frame) for marker in scene.timeline_markers] == [mine]


def test_many_keys_are_written_in_bulk(addon) -> None:
    """200 steps of 2,000 points: the keyframes are all there and linear."""
    rng = np.random.default_rng(1)
    steps = (circle(2000)[None] * (1.0 - 0.5 * rng.random((200, 1, 1)))).astype(np.float32)
    obj = wire("Object", [steps[-1]])
    addon.animation.shape_keys.add_steps(obj, steps, 1 + np.arange(200), "Level 1")
    keys = obj.data.shape_keys
    assert len(keys.key_blocks) == 200
    curves = addon.animation.shape_keys.curves_of(keys)
    assert len(curves) == 199
    assert {point.interpolation for curve in curves for point in curve.keyframe_points} == {"LINEAR"}
