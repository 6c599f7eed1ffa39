"""When steps play, and the length of the animation."""

from __future__ import annotations

import itertools

import bpy
import numpy as np
import pytest

from support.drawings import at_frame, evaluated, facts, lines, poly_curve, star


def generate(**properties):
    assert bpy.ops.object.nested_cages_generate(**{"levels": "20, 10", **properties}) == {"FINISHED"}
    collection = bpy.data.collections["Drawing Cages"]
    fine, *cages = sorted(collection.objects, key=lambda obj: facts(obj)["level"])
    return collection, fine, cages


def test_a_cage_stays_home_until_its_own_flow_begins_out_of_sight() -> None:
    poly_curve("Drawing", [star()])
    _, _, cages = generate(decimation="ARC_LENGTH", show_flow=False)
    end = facts(cages[0])["end"]
    home = evaluated(cages[0], at_frame(9000))
    np.testing.assert_array_equal(evaluated(cages[0], at_frame(end)), home)


@pytest.mark.slow
def test_the_length_is_known_for_other_timings(addon) -> None:
    poly_curve("Drawing", [star()])
    generate()
    cage_set = addon.record.CageSet.of(bpy.data.objects["Drawing"])
    for timing, show_flow in itertools.product((1, 3), (True, False)):
        wanted = addon.animation.timeline.Timing(5, timing, show_flow)
        told = addon.generation.output.duration(cage_set, wanted)
        bpy.context.scene.frame_end = 6
        generate(start_frame=5, frames_per_step=timing, show_flow=show_flow)
        assert bpy.context.scene.frame_end == 5 + told - 1


def test_thousands_of_frames_play_to_the_end() -> None:
    poly_curve("Drawing", [star()])
    collection, fine, cages = generate(frames_per_step=500)
    end = facts(collection)["end"]
    assert end > 5000
    home = evaluated(fine, at_frame(end + 1))
    np.testing.assert_array_equal(evaluated(fine, at_frame(end)), home)
    for frame in np.linspace(facts(cages[-1])["reinflation_start"], end, 25):
        depsgraph = at_frame(frame)
        assert not lines(cages[0], depsgraph).intersects(lines(cages[1], depsgraph))


def test_the_drawing_shrinks_visibly_and_the_cages_are_the_same_without() -> None:
    poly_curve("Drawing", [star()])
    cages = {}
    for shrink in (True, False):
        _, fine, made = generate(shrink=shrink)
        home = fine.data.shape_keys.reference_key
        points = np.array([[point.co[:2] for point in key.data] for key in fine.data.shape_keys.key_blocks])
        travel = np.linalg.norm(points - [point.co[:2] for point in home.data], axis=2).max() / 2.0
        assert (travel > 0.05) == shrink
        assert not shrink or len(points) > 12
        cages[shrink] = [evaluated(cage, at_frame(9000)) for cage in made]
    for with_it, without in zip(cages[True], cages[False], strict=True):
        np.testing.assert_array_equal(with_it, without)
