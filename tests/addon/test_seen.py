"""What is made is seen: the moving copy, colours, the length, the marker, and nothing computed twice."""

from __future__ import annotations

import itertools

import bpy
import numpy as np
import pytest

from support.drawings import at_frame, circle, facts, poly_curve, polygon_area, star, wire


def generate(**properties):
    return bpy.ops.object.nested_cages_generate(**{"levels": "20, 10", **properties})


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
def test_while_it_plays_a_filled_copy_moves_in_place_of_the_original(addon, height) -> None:
    source, red = coloured("Drawing", [star(), circle(12, 0.3)])
    source.location.z = height
    bpy.context.view_layer.update()
    generate()
    copy, frames = bpy.data.objects["Drawing Moving"], addon.record.CageSet.of(source).record.frames
    first, result, _ = frames
    for frame, playing in ((first - 1, False), (first, True), (result - 1, True), (result, False), (result + 9, False)):
        at_frame(frame)
        assert source.hide_viewport is source.hide_render is playing
        assert copy.hide_viewport is copy.hide_render is not playing
    filled = area(copy, at_frame(first))
    assert filled == pytest.approx(polygon_area(star()) - polygon_area(circle(12, 0.3)), rel=1e-4)
    shrunk = facts(bpy.data.objects["Drawing Cage 1"])["reinflation_start"]
    assert area(copy, at_frame(shrunk)) < filled
    mesh = copy.evaluated_get(at_frame(first)).data
    assert [material.name for material in mesh.materials] == [red.name]
    corner = copy.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world @ mesh.vertices[0].co
    assert corner.z == pytest.approx(height, abs=1e-6)


@pytest.mark.slow
def test_the_original_is_back_when_the_animation_goes_and_while_it_is_bound(addon) -> None:
    source, _ = coloured("Drawing", [star()])
    actions = len(bpy.data.actions)
    generate()
    bpy.ops.object.nested_cages_bind()
    at_frame(3)
    assert not source.hide_viewport and "Drawing Moving" not in bpy.data.objects
    bpy.ops.object.nested_cages_unbind()
    at_frame(3)
    assert source.hide_viewport and "Drawing Moving" in bpy.data.objects
    bpy.ops.object.nested_cages_remove_animation()
    assert not source.hide_viewport and not source.hide_render
    assert "Drawing Moving" not in bpy.data.objects and source.animation_data is None
    assert len(bpy.data.actions) == actions


def test_what_hides_the_original_on_the_user_s_behalf_is_left_alone(addon) -> None:
    source = poly_curve("Drawing", [star()])
    source.keyframe_insert("hide_render", frame=5)
    generate()
    bpy.ops.object.nested_cages_remove_animation()
    source.hide_render = True
    at_frame(5)
    assert not source.hide_render


def test_an_original_that_makes_way_can_be_caged_again(addon) -> None:
    source = poly_curve("Drawing", [star()])
    generate()
    at_frame(2)
    assert not source.visible_get()
    source.select_set(False)
    assert generate(levels="12") == {"FINISHED"}
    assert len(bpy.data.collections) == 1


def test_every_drawing_and_level_has_a_colour_of_its_own(addon) -> None:
    colour = addon.scene.display.colour
    orange = np.array((1.0, 0.63, 0.16))
    shades = [np.array(colour(level, drawing)[:3]) for drawing in range(6) for level in (1, 2)]
    for one, other in itertools.combinations(shades, 2):
        assert np.abs(one - other).max() > 0.1
    assert min(np.abs(shade - orange).max() for shade in shades) > 0.3
    for x, name in ((0.0, "One"), (3.0, "Two")):
        poly_curve(name, [star()]).location.x = x
    bpy.data.objects["One"].select_set(True)
    generate()
    names = [f"{drawing} Cage {level}" for drawing in ("One", "Two") for level in (1, 2)]
    before = [tuple(bpy.data.objects[name].color) for name in names]
    assert len(set(before)) == 4
    generate()
    assert [tuple(bpy.data.objects[name].color) for name in names] == before


@pytest.mark.slow
def test_cages_have_a_width_in_renders(addon) -> None:
    poly_curve("Drawing", [star()])
    generate()
    display = addon.scene.display
    cage = bpy.data.objects["Drawing Cage 1"]
    size = np.linalg.norm(np.ptp(star(), axis=0))
    assert display.thickness_of(cage, display.AUTOMATIC_THICKNESS) == pytest.approx(
        display.AUTOMATIC_PART * size, rel=1e-4
    )
    modifier = cage.modifiers[display.AUTOMATIC_THICKNESS]
    assert modifier.show_render and not modifier.show_viewport
    bpy.ops.object.nested_cages_bind()
    assert not modifier.show_render
    bpy.ops.object.nested_cages_unbind()
    assert modifier.show_render


def test_the_animation_fits_a_length(addon) -> None:
    levels = [addon.animation.timeline.Phases(3, 40, 95), addon.animation.timeline.Phases(0, 20, 33)]
    for length in (30, 120, 400):
        timing = addon.animation.timeline.Timing(11, fit_length=True, length=length)
        spans = addon.animation.timeline.spans(levels, timing)
        assert spans[-1].end - 11 + 1 == pytest.approx(length, abs=2)
        for level, span in zip(levels, spans, strict=True):
            frames = addon.animation.timeline.step_frames(level, span, timing)
            assert (np.diff(frames) > 0.0).all()
            assert frames[[0, level.flow_end, -1]] == pytest.approx([span.flow, span.reinflation, span.end], abs=1e-9)


def test_the_scene_s_range_is_put_back_by_whichever_goes_last(addon) -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 5, 20
    for x, name in ((0.0, "One"), (3.0, "Two")):
        poly_curve(name, [star()]).location.x = x
    generate(start_frame=2, fit_length=True, length=60)
    bpy.context.view_layer.objects.active = bpy.data.objects["One"]
    bpy.data.objects["One"].select_set(True)
    bpy.data.objects["Two"].select_set(False)
    generate(fit_length=True, length=90)
    assert (scene.frame_start, scene.frame_end) == (1, 90)
    assert [(marker.name, marker.frame) for marker in scene.timeline_markers] == [("2 Drawings", 61), ("One", 90)]
    bpy.ops.object.nested_cages_remove_animation()
    assert (scene.frame_start, scene.frame_end) == (2, 61)
    bpy.context.view_layer.objects.active = bpy.data.objects["Two"]
    bpy.ops.object.nested_cages_remove_animation()
    assert (scene.frame_start, scene.frame_end) == (5, 20)
    assert not scene.nested_cages_playing.known


@pytest.mark.slow
def test_a_level_that_has_not_changed_is_not_made_again(runs) -> None:
    poly_curve("Drawing", [star()])
    for levels, made in (("20, 10", [20, 10]), ("20, 12", [12]), ("20, 10", []), ("20", []), ("18, 10", [18, 10])):
        generate(levels=levels)
        assert runs == made
        runs.clear()
    generate(levels="20, 10", clearance=0.05)
    assert runs == [20, 10]


def eight() -> np.ndarray:
    return np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])


def test_in_a_batch_what_cannot_be_done_is_skipped_and_listed(addon, capfd) -> None:
    for x in range(4):
        poly_curve(f"Glyph {x}", [star()] if x % 2 else [eight()]).location.x = 3.0 * x
    poly_curve("Open", [star()], cyclic=False)
    for obj in bpy.data.objects:
        obj.select_set(True)
    assert generate() == {"FINISHED"}
    assert {c.name for c in bpy.data.collections if "source" in facts(c)} == {"Glyph 1 Cages", "Glyph 3 Cages"}
    told = "".join(capfd.readouterr())
    for words in (
        "Skipped: 'Glyph 0' crosses or touches itself",
        "Skipped: 'Glyph 2'",
        "Skipped: 'Open' is open",
        "3 drawings",
    ):
        assert words in told


@pytest.mark.slow
def test_the_largest_clearance_is_known_before_the_work_begins(addon, core, monkeypatch) -> None:
    monkeypatch.setattr(core, "NestedCagesRun", None)
    poly_curve("Drawing", [star(), circle(12, 0.1)])
    with pytest.raises(RuntimeError, match=r"on 2 levels in a hole.*ask for less than 0.0482963"):
        generate(clearance=0.06, loops="keep")
    monkeypatch.undo()
    assert generate(clearance=0.02) == {"FINISHED"}


@pytest.mark.slow
def test_a_loose_cage_says_why_and_what_number_would_do(addon) -> None:
    poly_curve("Drawing", [star(120, 0.4, 7)])
    generate(levels="5")
    note = dict(addon.record.notes(addon.record.node_of(bpy.data.objects["Drawing Cage 1"])))["loose.enough"]
    assert 5 < note["better"] < 120 and note["good"] == 0.25
    generate(levels=str(note["better"]))
    cage = bpy.data.objects["Drawing Cage 1"]
    assert facts(cage)["excess"] < 0.25 and not facts(cage)["notes"]


def test_nothing_selected_the_wrong_kind_and_a_hidden_object_are_three_sentences(addon) -> None:
    with pytest.raises(RuntimeError, match="Nothing is selected"):
        generate()
    bpy.ops.object.camera_add()
    with pytest.raises(RuntimeError, match="'Camera' has no outline, it is of the kind camera"):
        generate()
    bpy.data.objects["Camera"].select_set(False)
    poly_curve("Drawing", [star()]).hide_set(True)
    with pytest.raises(RuntimeError, match="'Drawing' is hidden"):
        generate()


def test_select_fault_goes_to_the_spot(addon) -> None:
    crossing = wire("Eight", [eight()])
    crossing.location.x = 2.0
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="'Eight' crosses or touches itself"):
        generate(levels="3")
    assert bpy.ops.object.nested_cages_select_fault() == {"FINISHED"}
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [vertex.select for vertex in crossing.data.vertices] == [True] * 4
    np.testing.assert_allclose(bpy.context.scene.cursor.location, (2.5, 0.5, 0.0), atol=1e-6)
    bpy.ops.wm.read_homefile(use_empty=True)  # another file: session IDs begin anew
    wire("Other", [star()])
    assert not addon.operators.base.last_fault and not bpy.ops.object.nested_cages_select_fault.poll()


def test_select_fault_finds_the_ends_of_an_open_curve(addon) -> None:
    line = poly_curve("Open", [star()], cyclic=False)
    with pytest.raises(RuntimeError, match="'Open' is open"):
        generate()
    bpy.ops.object.nested_cages_select_fault()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [point.select for point in line.data.splines[0].points] == [True, *[False] * 58, True]


def test_loops_are_told_by_the_names_of_their_objects(addon, core) -> None:
    """Numbers that count through all objects mean nothing to a user."""
    convert, frame = addon.scene.convert, addon.scene.plane.Frame(np.eye(4), 0.0, 1.0, own=True)
    one = convert.Drawing("One", frame, (star(), circle(12, 0.3)), 1)
    two = convert.Drawing("Two", frame, (circle(40, 1.0, (0.9, 0.0)),), 2)
    said = core.Fault("Loops 0 and 2 cross near (0.5, 0.8).", "mesh.crossing", loops=(0, 2), place=(0.5, 0.8))
    assert convert.in_words(said, "One", [one, two]) == "'One' and 'Two' cross or touch: move them apart"
    assert convert.in_words(core.Fault("Open.", "mesh.open", loops=(7,)), "One", [one, two]) == "'One': Open."
    same = core.Fault("Loops 0 and 1 cross.", "mesh.crossing", loops=(0, 1))
    assert convert.in_words(same, "One", [one]) == "Two outlines of 'One' cross or touch: move points apart"
    spike = core.Fault("A spike.", "mesh.spike", loops=(2,))
    assert convert.in_words(spike, "One", [one, two]) == "'Two' has a line that goes back on itself: delete its tip"


@pytest.mark.slow
def test_drawings_of_one_run_share_a_collection_within_their_own(addon) -> None:
    scene = bpy.context.scene
    face, character = bpy.data.collections.new("Face"), bpy.data.collections.new("Character")
    scene.collection.children.link(character)
    character.children.link(face)
    for x, name in enumerate(("Eye", "Nose", "Mouth")):
        obj = poly_curve(name, [star()])
        obj.location.x = 3.0 * x
        face.objects.link(obj)
        scene.collection.objects.unlink(obj)
    for obj in face.objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = face.objects[0]
    assert generate() == {"FINISHED"}
    run = bpy.data.collections["Cages of 3 Drawings"]
    assert set(face.children) == {run}
    assert sorted(collection.name for collection in run.children) == ["Eye Cages", "Mouth Cages", "Nose Cages"]
    assert [marker.name for marker in scene.timeline_markers] == ["3 Drawings"]
    assert generate(levels="12") == {"FINISHED"}
    assert len(bpy.data.collections) == 6
