"""The operator from end to end: against the core's own result, and as Blender evaluates what it wrote."""

from __future__ import annotations

import itertools

import bpy
import numpy as np
import pytest
import shapely

from support.drawings import (
    at_frame,
    bezier_circle,
    choose,
    circle,
    evaluated,
    facts,
    in_world,
    lines,
    nurbs_circle,
    poly_curve,
    raised,
    snapshot,
    solid,
    star,
    text,
    wire,
)
from support.marks import slow_after

LEVELS = "20, 10"


def generate(**properties):
    return bpy.ops.object.nested_cages_generate(**{"levels": LEVELS, **properties})


def output(name="Drawing"):
    """The collection, the fine mesh and the cages."""
    collection = bpy.data.collections[f"{name} Cages"]
    fine, *cages = sorted(collection.objects, key=lambda obj: facts(obj)["level"])
    return collection, fine, cages


def letter():
    """A square letter with a hole, a second component and an island in the hole."""
    outer = np.array([(0, 0), (4, 0), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
    outer = np.concatenate(
        [np.linspace(a, b, 6, endpoint=False) for a, b in zip(outer, np.roll(outer, -1, 0), strict=True)]
    )
    return [outer, circle(12, 0.2, (0.5, 2.0)), star(40) * 0.5 + (5.5, 1.0)]


@pytest.mark.slow
@pytest.mark.parametrize("decimation", slow_after(1, ["ON_CURVE", "OUTER_HULL", "ARC_LENGTH"]))
def test_no_cage_crosses_what_it_encloses_on_any_frame(addon, decimation) -> None:
    poly_curve("Drawing", letter())
    generate(levels="48, 20", decimation=decimation, frames_per_step=2)
    _, fine, cages = output()
    for inner, cage in itertools.pairwise([fine, *cages]):
        begin, end = facts(cage)["reinflation_start"], facts(cage)["end"]
        for half in range(2 * begin, 2 * end + 1):
            depsgraph = at_frame(half / 2)
            assert not lines(inner, depsgraph).intersects(lines(cage, depsgraph)), (cage.name, half / 2)
        depsgraph = at_frame(end)
        assert solid(cage, depsgraph).contains(solid(inner, depsgraph))
        assert lines(inner, depsgraph).distance(lines(cage, depsgraph)) > 0.0
        assert len(solid(cage, depsgraph).geoms) == 2


def test_the_animation_begins_and_ends_with_the_source(addon) -> None:
    source = bezier_circle("Drawing", radius=2.0, resolution=16)
    generate()
    collection, fine, cages = output()
    first = facts(cages[0])["flow_start"]
    assert facts(cages[0])["reinflation_start"] > first
    source.data.dimensions = "3D"
    expected = evaluated(source)
    for frame in (first, first - 10, facts(collection)["end"], 4000):
        np.testing.assert_array_equal(evaluated(fine, at_frame(frame)), expected)
    assert np.abs(evaluated(fine, at_frame(facts(cages[0])["reinflation_start"])) - expected).max() > 1e-3
    assert fine.matrix_world == source.matrix_world


def test_levels_appear_one_after_the_other_with_what_is_known_of_them(addon) -> None:
    scene = bpy.context.scene
    scene.frame_end = 10
    poly_curve("Drawing", [star()])
    generate(start_frame=101, frames_per_step=3)
    collection, fine, cages = output()
    for number, cage in enumerate(cages, 1):
        assert (facts(cage)["level"], facts(cage)["vertices"]) == (number, len(cage.data.vertices))
        assert facts(cage)["certificate"].startswith("Certified as stored") and facts(cage)["seconds"] > 0.0
        for before in (True, False):
            at_frame(facts(cage)["flow_start"] - before)
            assert cage.hide_viewport == cage.hide_render == before
    assert not fine.hide_viewport and facts(cages[1])["flow_start"] > facts(cages[0])["end"]
    assert scene.frame_end == facts(collection)["end"] == facts(cages[-1])["end"]
    markers = {marker.name: marker.frame for marker in scene.timeline_markers}
    assert markers == {"Drawing": facts(collection)["end"]}
    assert (facts(cages[0])["reinflation_start"] - 101) % 3 == 0


def test_without_the_flow_the_drawing_is_inside_from_the_start(addon) -> None:
    poly_curve("Drawing", [star()])
    generate(levels="20", show_flow=False, decimation="ARC_LENGTH")
    _, fine, (cage,) = output()
    assert facts(cage)["flow_start"] == facts(cage)["reinflation_start"] == 1
    for half in range(2, 2 * facts(cage)["end"] + 1):
        depsgraph = at_frame(half / 2)
        assert not lines(fine, depsgraph).intersects(lines(cage, depsgraph))


@pytest.mark.parametrize("clearance", slow_after(1, [0.02, 1e-3]))
def test_the_clearance_is_a_length_of_the_scene(addon, clearance) -> None:
    obj = poly_curve("Drawing", [star()])
    obj.scale = (3.0, 3.0, 3.0)
    generate(clearance=clearance)
    _, fine, cages = output()
    depsgraph = at_frame(5000)
    for inner, cage in itertools.pairwise([fine, *cages]):
        measured = 3.0 * lines(inner, depsgraph).distance(lines(cage, depsgraph))
        assert clearance * (1.0 - 1e-9) <= measured <= 1.05 * clearance
        assert facts(cage)["clearance"] == pytest.approx(measured, rel=1e-6)


ORDINARY = {
    "Bezier circle": lambda: bezier_circle("Drawing"),
    "NURBS circle": lambda: nurbs_circle("Drawing"),
    "mesh circle": lambda: wire("Drawing", [circle(32)]),
    "square": lambda: wire("Drawing", [circle(4)]),
    "triangle": lambda: wire("Drawing", [circle(3)]),
    "text": lambda: text("Drawing", "Ab"),
    "letter": lambda: poly_curve("Drawing", letter()),
    "many parts": lambda: wire("Drawing", [circle(5, 0.3, (x, 0.0)) for x in range(12)]),
}


@pytest.mark.parametrize("name", slow_after(4, ORDINARY))
def test_the_default_works_on_any_ordinary_drawing(addon, name) -> None:
    ORDINARY[name]()
    assert bpy.ops.object.nested_cages_generate() == {"FINISHED"}
    _, fine, cages = output()
    assert len(cages) == 2
    assert len(fine.data.vertices) >= len(cages[0].data.vertices) >= len(cages[1].data.vertices)


def test_selected_objects_become_the_levels(addon) -> None:
    finer = wire("Finer", [circle(24, 1.4)])
    coarser = poly_curve("Coarser", [circle(9, 1.5)])
    source = poly_curve("Drawing", [star()])
    for obj in (finer, coarser):
        obj.location = (0.05, 0.0, 0.0)
        obj.select_set(True)
    assert generate(use_selected_as_levels=True) == {"FINISHED"}
    _, fine, cages = output()
    assert [len(cage.data.vertices) for cage in cages] == [24, 9]
    assert len(fine.data.vertices) == 60
    assert bpy.context.view_layer.objects.active is source
    start = evaluated(cages[0], at_frame(facts(cages[0])["reinflation_start"]))
    np.testing.assert_allclose(start[:, :2], circle(24, 1.4, (0.05, 0.0)), atol=1e-6)
    assert len(bpy.data.collections) == 1


@pytest.mark.slow
def test_all_selected_drawings_in_common_cages(addon, core) -> None:
    """Two drawings in objects of their own, each with its transform, and a hole that is an object too."""
    one, two, hole = poly_curve("One", [star()]), wire("Two", [circle(40)]), wire("Hole", [circle(12, 0.3)])
    two.location, two.rotation_euler = (3.0, 0.5, 0.0), (0.0, 0.0, 0.4)
    for obj in (one, two, hole):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = one
    bpy.context.view_layer.update()
    assert generate(levels="30", together=True) == {"FINISHED"}
    (collection,) = [c for c in bpy.data.collections if "source" in facts(c)]
    assert facts(collection)["source"] == one and collection.name == "One Cages"
    fine, cage = sorted(collection.objects, key=lambda obj: facts(obj)["level"])
    depsgraph = at_frame(facts(cage)["end"])
    moved = in_world(two, evaluated(two, depsgraph))[:, :2]
    expected = shapely.Polygon(star(), [circle(12, 0.3)]).union(shapely.Polygon(moved))
    assert solid(fine, depsgraph).symmetric_difference(expected).area < 1e-5
    assert solid(cage, depsgraph).contains(solid(fine, depsgraph))
    assert len(solid(cage, depsgraph).geoms) == 2
    once = snapshot()
    generate(levels="30", together=True)
    assert snapshot() == once


def test_drawings_in_common_cages_are_united_where_they_cross_and_flattened_where_they_are_layers(addon) -> None:
    poly_curve("One", [star()])
    two = wire("Two", [circle(40, 1.0, (0.9, 0.0))])
    two.location.z = 0.01
    bpy.data.objects["One"].select_set(True)
    assert generate(levels="30", together=True) == {"FINISHED"}
    (collection,) = [c for c in bpy.data.collections if "source" in facts(c)]
    fine, cage = sorted(collection.objects, key=lambda obj: facts(obj)["level"])
    depsgraph = at_frame(facts(cage)["end"])
    expected = shapely.Polygon(star()).union(shapely.Polygon(circle(40, 1.0, (0.9, 0.0))))
    assert solid(fine, depsgraph).symmetric_difference(expected).area < 1e-5
    assert solid(cage, depsgraph).contains(solid(fine, depsgraph))


def test_drawings_in_common_cages_must_be_parallel(addon) -> None:
    poly_curve("One", [star()])
    wire("Two", [circle(40, 1.0, (4.0, 0.0))])
    bpy.data.objects["One"].rotation_euler.x = 0.1
    bpy.data.objects["One"].select_set(True)
    with pytest.raises(RuntimeError, match="'One' does not lie in one plane with the drawing"):
        generate(together=True)


@pytest.mark.slow
def test_output_that_is_selected_with_its_drawing_is_replaced_not_caged(addon) -> None:
    poly_curve("Drawing", [star()])
    generate()
    for obj in bpy.data.objects:
        obj.hide_viewport = False
        obj.select_set(True)
    generate()
    assert len(bpy.data.collections) == 1 and len(bpy.data.objects) == 5
    cage = output()[2][0]
    choose(cage)
    generate(levels="8")  # a cage that is selected on its own is a drawing like any other
    assert "Drawing Cage 1 Cages" in bpy.data.collections


@pytest.mark.slow
def test_a_second_run_replaces_what_the_first_made(addon) -> None:
    poly_curve("Drawing", [star()])
    generate()
    collection, fine, cages = output()
    modifier = cages[0].modifiers.new("Mine", "SKIN")
    generate(frames_per_step=6)
    once = snapshot()
    generate(frames_per_step=6)
    assert snapshot() == once
    again = output()
    assert again[0] == collection and again[1] == fine and again[2] == cages
    assert modifier.name in cages[0].modifiers
    generate(levels="12")
    assert len(output()[2]) == 1
    assert len(bpy.data.objects) == 4 and len(bpy.data.meshes) == 3 and len(bpy.data.shape_keys) == 2
    assert len({marker.name for marker in bpy.context.scene.timeline_markers}) == len(
        bpy.context.scene.timeline_markers
    )


def seen_on(frame):
    """The objects that are not hidden on a frame."""
    at_frame(frame)
    return [obj for obj in bpy.context.scene.objects if not obj.hide_viewport]


def everything():
    """The scene, and what is seen of it on some frames."""
    scene = bpy.context.scene
    frames = (scene.frame_start, scene.frame_end // 2, scene.frame_end)
    shown = [
        (frame, obj.name, obj.matrix_world.copy(), evaluated(obj, at_frame(frame)).tobytes())
        for frame in frames
        for obj in seen_on(frame)
        if obj.type == "MESH"
    ]
    at_frame(1)
    owners = (*bpy.data.collections, *bpy.data.objects)
    return snapshot(), shown, {owner.name: own_properties(owner) for owner in owners}


def own_properties(owner):
    """Custom properties as text, without registered groups, which Blender before 5.0 lists among them."""
    return {key: str(value) for key, value in owner.items() if not hasattr(value, "to_dict")}


@pytest.mark.parametrize("before", slow_after(0, ["keyed", "plain", "thick"], thorough_after=1))
@pytest.mark.parametrize(
    "place", ["first level", "second level", "second drawing", "markers", "thickness", "moving copy"]
)
def test_undo_takes_a_fault_while_replacing_back(addon, monkeypatch, before, place) -> None:
    for x, name in ((0.0, "One"), (3.0, "Two")):
        poly_curve(name, [star()]).location.x = x
    bpy.data.objects["One"].select_set(True)
    generate(thickness=0.02 * (before == "thick"))
    if before == "keyed":
        bpy.data.objects["Two Cage 1"].keyframe_insert("location", frame=5)
        bpy.context.scene.timeline_markers.new("Mine", frame=3)

    def at_the_result() -> None:
        """Selects both drawings where the animation does not hide them."""
        bpy.context.scene.frame_set(facts(bpy.data.collections["One Cages"])["end"])
        for obj in bpy.data.objects:
            obj.select_set(obj.name in {"One", "Two"})

    at_the_result()
    once = everything()
    at_the_result()
    bpy.ops.ed.undo_push(message="before")
    room, name, calls = {
        "first level": (addon.animation.shape_keys, "add_steps", 1),
        "second level": (addon.animation.visibility, "hide_until", 2),
        "second drawing": (addon.animation.shape_keys, "add_steps", 4),
        "markers": (addon.animation.timeline, "settle", 1),
        "thickness": (addon.scene.display, "set_thickness", 4),
        "moving copy": (addon.animation.visibility, "make_copy", 2),
    }[place]
    real, countdown = getattr(room, name), itertools.count(1)

    def fault(*arguments, **named):
        if next(countdown) == calls:
            raise MemoryError("no room")
        return real(*arguments, **named)

    monkeypatch.setattr(room, name, fault)
    with pytest.raises(RuntimeError, match="no room"):
        generate(levels="12", thickness=0.01, start_frame=40)
    monkeypatch.undo()
    bpy.ops.ed.undo_push(message="fault")  # as Blender in a window does itself
    bpy.ops.ed.undo()
    assert everything() == once
    at_the_result()
    assert generate(levels="12") == {"FINISHED"}


def test_a_renamed_drawing_keeps_its_output(addon) -> None:
    source = poly_curve("Drawing", [star()])
    generate()
    collection, fine, cages = output()
    cages[1].name = "My own name"
    source.name = "Picture"
    poly_curve("Drawing", [circle(30)]).select_set(False)
    source.select_set(True)
    bpy.context.view_layer.objects.active = source
    generate()
    assert (collection.name, fine.name) == ("Picture Cages", "Picture Fine")
    assert [cage.name for cage in cages] == ["Picture Cage 1", "My own name"]
    assert len(bpy.data.collections) == 1 and len(bpy.data.objects) == 6
    bpy.context.view_layer.objects.active = fine
    assert bpy.ops.object.nested_cages_remove_animation.poll()


def test_the_user_s_own_animation_of_a_cage_stays(addon) -> None:
    poly_curve("Drawing", [star()])
    generate()
    _, _, (cage, other) = output()
    cage.location.x = 0.5
    cage.keyframe_insert("location", frame=5)
    other.driver_add("location", 2)
    generate()
    cage.location.x = 0.0
    at_frame(5)
    assert cage.location.x == 0.5
    assert len(other.animation_data.drivers) == 1
    at_frame(1)
    assert other.hide_viewport


def test_a_drawing_that_is_deleted_meanwhile_is_refused(addon) -> None:
    source = poly_curve("Drawing", [star()])
    drawing = addon.scene.convert.fine_drawing(addon.scene.convert.read(bpy.context, source))
    assert drawing.source == source
    bpy.ops.ed.undo_push(message="read")
    source.name = "Other"
    assert drawing.source == source
    bpy.ops.ed.undo_push(message="renamed")
    bpy.ops.ed.undo()
    assert drawing.source == bpy.data.objects["Drawing"]
    bpy.data.objects.remove(bpy.data.objects["Drawing"])
    assert drawing.source is None


def test_the_source_stays_selected_active_and_as_it_was(addon) -> None:
    source = poly_curve("Drawing", [star()])
    source.data.bevel_depth = 0.1

    def state():
        return source.data.bevel_depth, source.data.dimensions, source.matrix_world.copy(), set(own_properties(source))

    before = state()
    generate()
    assert state() == before
    assert bpy.context.selected_objects == [source]
    assert bpy.context.view_layer.objects.active is source


def test_the_frame_jumps_to_the_result_or_stays(addon) -> None:
    poly_curve("Drawing", [star()])
    generate(show_result=False)
    assert bpy.context.scene.frame_current == 1
    generate()
    assert bpy.context.scene.frame_current == facts(output()[0])["end"]


def levels_out_of_plane():
    wire("Tilted", [circle(12, 1.5)]).rotation_euler = (0.3, 0.0, 0.0)
    poly_curve("Drawing", [star()])
    bpy.data.objects["Tilted"].select_set(True)


def not_a_number():
    loop = raised(star())
    loop[3, 0] = np.nan
    return wire("Broken", [loop])


REFUSALS = {
    "duplicate loops": (lambda: poly_curve("Twice", [star(), star()]), {}, "of 'Twice' cross"),
    "loops that touch": (
        lambda: poly_curve("Touch", [circle(4), np.array([(1.0, 0.0), (2.0, -1.0), (3.0, 0.0), (2.0, 1.0)])]),
        {},
        "Two outlines of 'Touch' cross or touch: move points apart",
    ),
    "loops a rounding apart": (
        lambda: poly_curve("Touch", [circle(4), circle(4, 1.0, (2.0, 0.0))]),
        {"loops": "keep"},
        "'Touch', cage 1: There is no room for a cage near (1, ",
    ),
    "no numbers": (not_a_number, {}, "'Broken'"),
    "no room": (
        lambda: poly_curve("Drawing", [star(), circle(12, 0.1)]),
        {"clearance": 0.2, "loops": "keep"},
        "0.2 on 2 levels in a hole",
    ),
    "closed surface": (lambda: bpy.ops.mesh.primitive_cube_add(), {}, "'Cube' is a solid"),
    "crossing loops": (lambda: poly_curve("Two", [circle(20), circle(20, 1.0, (1.0, 0.0))]), {}, "of 'Two' cross"),
    "no levels selected": (
        lambda: poly_curve("Drawing", [star()]), {"use_selected_as_levels": True}, "'Selected as Cages' needs"
    ),
    "level out of plane": (levels_out_of_plane, {"use_selected_as_levels": True}, "'Tilted' does not lie in one plane"),
    "impossible clearance": (
        lambda: poly_curve("Drawing", [star(), circle(12, 0.1)]),
        {"clearance": 5.0, "loops": "keep"},
        "'Drawing': No cage keeps",
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", REFUSALS)
def test_a_refusal_is_a_sentence_and_changes_nothing(addon, name) -> None:
    make, properties, sentence = REFUSALS[name]
    make()
    bpy.context.view_layer.update()
    before = snapshot()
    with pytest.raises(RuntimeError) as caught:
        generate(**properties)
    assert sentence in str(caught.value)
    assert snapshot() == before


def test_undo_and_redo(addon) -> None:
    poly_curve("Drawing", [star()])
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="before")
    before = snapshot()
    generate()
    bpy.ops.ed.undo_push(message="after")
    after = snapshot()
    bpy.ops.ed.undo()
    assert snapshot() == before
    bpy.ops.ed.redo()
    assert snapshot() == after
