"""The animation of how cages form: keys and frames, the moving copy, visibility, length, range, and life without it."""

import bpy
import numpy as np
import pytest
import shapely

from support import drawings
from support.drawings import at_frame, certificate, circle, end_of, evaluated, generate, lines, made, poly_curve, star
from support.marks import slow_after

slotted = pytest.mark.skipif(bpy.app.version < (4, 4, 0), reason="actions have no slots")


@pytest.mark.parametrize("which", [0, 1, 2])
def test_each_step_is_on_its_frame_and_the_motion_is_linear(which: int) -> None:
    poly_curve("Drawing", [star()])
    generate(frames_per_step=4)
    obj = made()[which]
    frames, steps = drawings.keyed_steps(obj)
    assert len(frames) > 5 and len(obj.data.shape_keys.key_blocks) <= len(steps) + 1
    rounding = 8.0 * np.finfo(np.float32).eps * np.abs(steps).max()
    for k, frame in enumerate(frames):
        np.testing.assert_allclose(evaluated(obj, at_frame(frame)), steps[k], rtol=0.0, atol=rounding)
        if k and frames[k] == frames[k - 1] + 4:
            for part in (0.25, 0.5, 0.875):
                wanted = steps[k - 1].astype(float) * (1.0 - part) + steps[k].astype(float) * part
                found = evaluated(obj, at_frame(frames[k - 1] + 4 * part))
                np.testing.assert_allclose(found, wanted, rtol=0.0, atol=rounding)
    for frame in (end_of(made()[-1]), 5000):
        np.testing.assert_array_equal(evaluated(obj, at_frame(frame)), drawings.base(obj))


@pytest.mark.parametrize("length", slow_after(1, [120, 30, 400]))
def test_the_animation_fits_a_length(length: int) -> None:
    poly_curve("Drawing", [star()])
    generate(start_frame=11, length=length)
    assert end_of(made()[-1]) - 11 + 1 == pytest.approx(length, abs=2)
    assert bpy.context.scene.frame_end >= end_of(made()[-1])
    for obj in made():
        assert (np.diff(drawings.keyed_steps(obj)[0]) > 0.0).all()


def test_markers_of_the_same_name_are_the_user_s() -> None:
    scene = bpy.context.scene
    poly_curve("Drawing", [star()])
    generate()
    end = end_of(made()[-1])
    assert [(marker.name, marker.frame) for marker in scene.timeline_markers] == [("Drawing", end)]
    scene.timeline_markers.new("Drawing", frame=end)
    bpy.ops.object.nested_cages_remove_animation()
    assert [(marker.name, marker.frame) for marker in scene.timeline_markers] == [("Drawing", end)]


def test_a_cage_stays_home_until_its_own_flow_begins_out_of_sight() -> None:
    poly_curve("Drawing", [star()])
    generate(decimation="ARC_LENGTH", show_flow=False)
    cages = made()[1:]
    end = end_of(cages[0])
    home = evaluated(cages[0], at_frame(9000))
    np.testing.assert_array_equal(evaluated(cages[0], at_frame(end)), home)


def test_thousands_of_frames_play_to_the_end() -> None:
    poly_curve("Drawing", [star()])
    generate(frames_per_step=500)
    fine, *cages = made()
    end = end_of(cages[-1])
    assert end > 5000
    home = evaluated(fine, at_frame(end + 1))
    np.testing.assert_array_equal(evaluated(fine, at_frame(end)), home)
    for frame in np.linspace(certificate(cages[-1]).frames[1], end, 25):
        depsgraph = at_frame(frame)
        assert not lines(cages[0], depsgraph).intersects(lines(cages[1], depsgraph))


def test_the_drawing_shrinks_visibly_and_the_cages_are_the_same_without() -> None:
    poly_curve("Drawing", [star()])
    cages = {}
    for shown in (True, False):
        generate(show_flow=shown)
        cages[shown] = [evaluated(cage, at_frame(9000)) for cage in made()[1:]]
        if not shown:
            continue
        fine = made()[0]
        home = fine.data.shape_keys.reference_key
        points = np.array([[point.co[:2] for point in key.data] for key in fine.data.shape_keys.key_blocks])
        travel = np.linalg.norm(points - [point.co[:2] for point in home.data], axis=2).max() / 2.0
        assert travel > 0.05 and len(points) > 12
    for with_it, without in zip(cages[True], cages[False], strict=True):
        np.testing.assert_array_equal(with_it, without)


@pytest.fixture
def cages():
    """The fine mesh and the cages of two levels."""
    poly_curve("Drawing", [star()])
    generate()
    return made()


@slotted
def test_all_cages_of_a_drawing_share_one_action(cages) -> None:
    fine, *others = cages
    action = bpy.data.actions["Drawing Cages"]
    # What hides the drawing while it plays, and its moving copy afterwards, is in another one.
    assert {other.name for other in bpy.data.actions if other != action} == {"Drawing"}
    owners = [fine.data.shape_keys, *others, *(cage.data.shape_keys for cage in others)]
    assert all(owner.animation_data.action == action for owner in owners)
    slots = {owner.animation_data.action_slot.identifier for owner in owners}
    assert len(slots) == len(action.slots) == len(owners)  # the fine mesh is never hidden
    at_frame(end_of(others[-1]))
    others[0].keyframe_insert("location", frame=5)
    generate("20, 10")
    own = others[0].animation_data.action
    assert {action.name for action in bpy.data.actions} == {"Drawing Cages", "Drawing", own.name}
    assert len(own.slots) == 1 and len(bpy.data.actions["Drawing Cages"].slots) == len(owners) - 1
    assert others[1].animation_data.action == bpy.data.actions["Drawing Cages"]


@pytest.mark.slow
def test_without_the_animation_the_cages_stay(cages) -> None:
    scene = bpy.context.scene
    objects = cages
    end = end_of(cages[-1])
    depsgraph = at_frame(end)
    home, edges = [evaluated(obj, depsgraph) for obj in objects], [drawings.edges_of(obj) for obj in objects]
    objects[1].keyframe_insert("location", frame=1)
    at_frame(7)
    assert bpy.ops.object.nested_cages_remove_animation() == {"FINISHED"}
    for frame in (-3, 7, end, end + 100):
        depsgraph = at_frame(frame)
        for obj, points, pairs in zip(objects, home, edges, strict=True):
            np.testing.assert_array_equal(evaluated(obj, depsgraph), points)
            np.testing.assert_array_equal(drawings.edges_of(obj), pairs)
            assert not obj.hide_viewport and not obj.hide_render
            assert obj.data.shape_keys is None
    assert [obj.animation_data is not None for obj in objects] == [False, True, False]
    assert len(bpy.data.actions) == 1
    assert not scene.timeline_markers
    assert scene.frame_end == 250
    assert not bpy.ops.object.nested_cages_remove_animation.poll()
    assert drawings.verify(*cages[1:])
    bpy.data.objects["Drawing"].select_set(True)  # Blender deselects what an animation hides
    generate("20, 10")


def coloured(name: str, loops):
    """A filled curve with a red material."""
    obj = poly_curve(name, loops)
    obj.data.fill_mode = "BOTH"
    red = bpy.data.materials.new("Red")
    obj.data.materials.append(red)
    return obj, red


def area(obj, depsgraph) -> float:
    """Area of the evaluated faces, and the materials on them."""
    shape = obj.evaluated_get(depsgraph)
    mesh = shape.to_mesh()
    found = sum(polygon.area for polygon in mesh.polygons)
    shape.to_mesh_clear()
    return found


@pytest.mark.slow
@pytest.mark.parametrize("height", [0.0, 0.5])
def test_while_it_plays_a_filled_copy_moves_in_place_of_the_original(height) -> None:
    source, red = coloured("Drawing", [star(), circle(12, 0.3)])
    source.location.z = height
    bpy.context.view_layer.update()
    generate(frames_per_step=7)
    generate()  # what the first animation hid longer is shown
    copy = bpy.data.objects["Drawing Moving"]
    first, result = certificate(made()[1]).frames[0], end_of(made()[-1])
    for frame, playing in ((first - 1, False), (first, True), (result - 1, True), (result, False), (result + 9, False)):
        at_frame(frame)
        assert source.hide_viewport is source.hide_render is playing
        assert copy.hide_viewport is copy.hide_render is not playing
    filled = area(copy, at_frame(first))
    assert filled == pytest.approx(shapely.Polygon(star(), [circle(12, 0.3)]).area, rel=1e-4)
    shrunk = certificate(bpy.data.objects["Drawing Cage 1"]).frames[1]
    assert area(copy, at_frame(shrunk)) < filled
    mesh = copy.evaluated_get(at_frame(first)).data
    assert [material.name for material in mesh.materials] == [red.name]
    corner = copy.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world @ mesh.vertices[0].co
    assert corner.z == pytest.approx(height, abs=1e-6)


@pytest.mark.slow
def test_the_original_is_back_when_the_animation_goes_and_while_it_is_bound() -> None:
    source, _ = coloured("Drawing", [star()])
    actions = len(bpy.data.actions)
    generate()
    drawings.bind()
    at_frame(3)
    assert not source.hide_viewport and "Drawing Moving" not in bpy.data.objects
    bpy.ops.object.nested_cages_bind(action="UNBIND")
    at_frame(3)
    assert source.hide_viewport and "Drawing Moving" in bpy.data.objects
    bpy.ops.object.nested_cages_remove_animation()
    assert not source.hide_viewport and not source.hide_render
    assert "Drawing Moving" not in bpy.data.objects and source.animation_data is None
    assert len(bpy.data.actions) == actions


def test_what_hides_the_original_on_the_user_s_behalf_is_left_alone() -> None:
    source = poly_curve("Drawing", [star()])
    source.keyframe_insert("hide_render", frame=5)
    generate()
    bpy.ops.object.nested_cages_remove_animation()
    source.hide_render = True
    at_frame(5)
    assert not source.hide_render


def test_an_original_that_makes_way_can_be_caged_again() -> None:
    source = poly_curve("Drawing", [star()])
    generate()
    at_frame(2)
    assert not source.visible_get()
    source.select_set(False)
    generate("12")
    assert len(bpy.data.collections) == 1


@pytest.mark.slow
def test_every_drawing_and_level_has_a_colour_of_its_own_that_stays() -> None:
    for x, name in ((0.0, "One"), (3.0, "Two")):
        poly_curve(name, [star()]).location.x = x
    bpy.data.objects["One"].select_set(True)
    generate()
    names = [f"{drawing} Cage {level}" for drawing in ("One", "Two") for level in (1, 2)]
    before = [tuple(bpy.data.objects[name].color) for name in names]
    assert len(set(before)) == 4
    generate()
    assert [tuple(bpy.data.objects[name].color) for name in names] == before


def test_the_scene_s_range_is_put_back_by_whichever_goes_last() -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 5, 20
    for x, name in ((0.0, "One"), (3.0, "Two")):
        poly_curve(name, [star()]).location.x = x
    generate(start_frame=2, length=60)
    bpy.context.view_layer.objects.active = bpy.data.objects["One"]
    bpy.data.objects["One"].select_set(True)
    bpy.data.objects["Two"].select_set(False)
    generate(length=90)
    assert (scene.frame_start, scene.frame_end) == (1, 90)
    assert [(marker.name, marker.frame) for marker in scene.timeline_markers] == [("2 Drawings", 61), ("One", 90)]
    bpy.ops.object.nested_cages_remove_animation()
    assert (scene.frame_start, scene.frame_end) == (2, 61)
    bpy.context.view_layer.objects.active = bpy.data.objects["Two"]
    bpy.ops.object.nested_cages_remove_animation()
    assert (scene.frame_start, scene.frame_end) == (5, 20)
