"""The operator from end to end: against the core's own result, and as Blender evaluates what it wrote."""

import itertools
import re

import bpy
import numpy as np
import pytest
import shapely

from support import drawings
from support.blender import refused
from support.drawings import at_frame, certificate, circle, end_of, generate, lines, poly_curve, snapshot, solid, star
from support.marks import slow_after


def output(name="Drawing"):
    """The collection, the fine mesh and the cages."""
    fine, *cages = drawings.made(name)
    return bpy.data.collections[f"{name} Cages"], fine, cages


def letter():
    """A square letter with a hole, a second component and an island in the hole."""
    outer = np.array([(0, 0), (4, 0), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
    outer = np.concatenate(
        [np.linspace(a, b, 6, endpoint=False) for a, b in zip(outer, np.roll(outer, -1, 0), strict=True)]
    )
    return [outer, circle(12, 0.2, (0.5, 2.0)), star(40) * 0.5 + (5.5, 1.0)]


@pytest.mark.slow
@pytest.mark.parametrize("decimation", slow_after(1, ["ON_CURVE", "OUTSIDE", "ARC_LENGTH"]))
def test_no_cage_crosses_what_it_encloses_on_any_frame(decimation) -> None:
    poly_curve("Drawing", letter())
    generate("48, 20", decimation=decimation, frames_per_step=2)
    _, fine, cages = output()
    for inner, cage in itertools.pairwise([fine, *cages]):
        begin, end = certificate(cage).frames[1], end_of(cage)
        for half in range(2 * begin, 2 * end + 1):
            depsgraph = at_frame(half / 2)
            assert not lines(inner, depsgraph).intersects(lines(cage, depsgraph)), (cage.name, half / 2)
        depsgraph = at_frame(end)
        assert solid(cage, depsgraph).contains(solid(inner, depsgraph))
        assert lines(inner, depsgraph).distance(lines(cage, depsgraph)) > 0.0
        assert len(solid(cage, depsgraph).geoms) == 2


def test_the_animation_begins_and_ends_with_the_source() -> None:
    source = drawings.bezier_circle("Drawing", radius=2.0, resolution=16)
    generate()
    collection, fine, cages = output()
    first = certificate(cages[0]).frames[0]
    assert certificate(cages[0]).frames[1] > first
    source.data.dimensions = "3D"
    expected = drawings.evaluated(source)
    for frame in (first, first - 10, end_of(collection), 4000):
        np.testing.assert_array_equal(drawings.evaluated(fine, at_frame(frame)), expected)
    assert np.abs(drawings.evaluated(fine, at_frame(certificate(cages[0]).frames[1])) - expected).max() > 1e-3
    assert fine.matrix_world == source.matrix_world


def test_levels_appear_one_after_the_other_with_what_is_known_of_them() -> None:
    scene = bpy.context.scene
    scene.frame_end = 10
    poly_curve("Drawing", [star()])
    generate(start_frame=101, frames_per_step=3)
    collection, fine, cages = output()
    for number, cage in enumerate(cages, 1):
        assert len(cage.data.vertices) == (20, 10)[number - 1]
        assert not certificate(cage).edited and certificate(cage).seconds > 0.0
        for before in (True, False):
            at_frame(certificate(cage).frames[0] - before)
            assert cage.hide_viewport == cage.hide_render == before
    assert not fine.hide_viewport and certificate(cages[1]).frames[0] > end_of(cages[0])
    assert scene.frame_end == end_of(collection) == end_of(cages[-1])
    markers = {marker.name: marker.frame for marker in scene.timeline_markers}
    assert markers == {"Drawing": end_of(collection)}
    assert all((frame - 101) % 3 == 0 for cage in cages for frame in certificate(cage).frames)


def test_without_the_flow_the_drawing_is_inside_from_the_start() -> None:
    poly_curve("Drawing", [star()])
    generate("20", show_flow=False, decimation="ARC_LENGTH")
    _, fine, (cage,) = output()
    assert certificate(cage).frames[0] == certificate(cage).frames[1] == 1
    for half in range(2, 2 * end_of(cage) + 1):
        depsgraph = at_frame(half / 2)
        assert not lines(fine, depsgraph).intersects(lines(cage, depsgraph))


@pytest.mark.parametrize("clearance", slow_after(1, [0.02, 1e-3]))
def test_the_clearance_is_a_length_of_the_scene(clearance) -> None:
    obj = poly_curve("Drawing", [star()])
    obj.scale = (3.0, 3.0, 3.0)
    generate(clearance=clearance)
    _, fine, cages = output()
    depsgraph = at_frame(5000)
    for inner, cage in itertools.pairwise([fine, *cages]):
        measured = 3.0 * lines(inner, depsgraph).distance(lines(cage, depsgraph))
        assert clearance * (1.0 - 1e-9) <= measured <= 1.05 * clearance
        assert certificate(cage).clearance == pytest.approx(measured, rel=1e-6)


def test_selected_objects_become_the_levels() -> None:
    finer = drawings.wire("Finer", [circle(24, 1.4)])
    coarser = poly_curve("Coarser", [circle(9, 1.5)])
    source = poly_curve("Drawing", [star()])
    for obj in (finer, coarser):
        obj.location = (0.05, 0.0, 0.0)
        obj.select_set(True)
    generate(use_selected_as_levels=True)
    _, fine, cages = output()
    assert [len(cage.data.vertices) for cage in cages] == [24, 9]
    assert len(fine.data.vertices) == 60
    assert bpy.context.view_layer.objects.active is source
    start = drawings.evaluated(cages[0], at_frame(certificate(cages[0]).frames[1]))
    np.testing.assert_allclose(start[:, :2], circle(24, 1.4, (0.05, 0.0)), atol=1e-6)
    assert len(bpy.data.collections) == 1


@pytest.mark.slow
def test_all_selected_drawings_in_common_cages() -> None:
    """Two drawings in objects of their own, each with its transform, and a hole that is an object too."""
    one, two, hole = (
        poly_curve("One", [star()]),
        drawings.wire("Two", [circle(40)]),
        drawings.wire("Hole", [circle(12, 0.3)]),
    )
    two.location, two.rotation_euler = (3.0, 0.5, 0.0), (0.0, 0.0, 0.4)
    for obj in (one, two, hole):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = one
    bpy.context.view_layer.update()
    generate("30", together=True)
    fine, cage = drawings.made("One")
    depsgraph = at_frame(end_of(cage))
    moved = drawings.in_world(two, drawings.evaluated(two, depsgraph))[:, :2]
    expected = shapely.Polygon(star(), [circle(12, 0.3)]).union(shapely.Polygon(moved))
    assert solid(fine, depsgraph).symmetric_difference(expected).area < 1e-5
    assert solid(cage, depsgraph).contains(solid(fine, depsgraph))
    assert len(solid(cage, depsgraph).geoms) == 2
    once = snapshot()
    generate("30", together=True)
    assert snapshot() == once


def test_drawings_in_common_cages_are_united_where_they_cross_and_flattened_where_they_are_layers() -> None:
    poly_curve("One", [star()])
    two = drawings.wire("Two", [circle(40, 1.0, (0.9, 0.0))])
    two.location.z = 0.01
    bpy.data.objects["One"].select_set(True)
    generate("30", together=True)
    fine, cage = drawings.made("One")
    depsgraph = at_frame(end_of(cage))
    expected = shapely.Polygon(star()).union(shapely.Polygon(circle(40, 1.0, (0.9, 0.0))))
    assert solid(fine, depsgraph).symmetric_difference(expected).area < 1e-5
    assert solid(cage, depsgraph).contains(solid(fine, depsgraph))
    two.rotation_euler.x = 0.1
    drawings.choose(two, bpy.data.objects["One"])
    with refused("'One'"):
        generate(together=True)


@pytest.mark.slow
def test_output_that_is_selected_with_its_drawing_is_replaced_not_caged() -> None:
    poly_curve("Drawing", [star()])
    generate()
    for obj in bpy.data.objects:
        obj.hide_viewport = False
        obj.select_set(True)
    generate()
    assert len(bpy.data.collections) == 1 and len(bpy.data.objects) == 5
    cage = output()[2][0]
    drawings.choose(cage)
    generate("8")  # a cage that is selected on its own is a drawing like any other
    assert "Drawing Cage 1 Cages" in bpy.data.collections


@pytest.mark.slow
def test_a_second_run_replaces_what_the_first_made() -> None:
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
    generate("12")
    assert len(output()[2]) == 1
    assert len(bpy.data.objects) == 4 and len(bpy.data.meshes) == 3 and len(bpy.data.shape_keys) == 2
    markers = [marker.name for marker in bpy.context.scene.timeline_markers]
    assert len({*markers}) == len(markers)


def test_a_renamed_drawing_keeps_its_output() -> None:
    source = poly_curve("Drawing", [star()])
    generate()
    collection, fine, cages = output()
    cages[1].name = "My own name"
    source.name = "Picture"
    poly_curve("Drawing", [circle(30)]).select_set(False)
    drawings.choose(source)
    generate()
    assert (collection.name, fine.name) == ("Picture Cages", "Picture Fine")
    assert [cage.name for cage in cages] == ["Picture Cage 1", "My own name"]
    assert len(bpy.data.collections) == 1 and len(bpy.data.objects) == 6
    bpy.context.view_layer.objects.active = fine
    assert bpy.ops.object.nested_cages_remove_animation.poll()


def test_the_source_stays_selected_active_and_as_it_was() -> None:
    source = poly_curve("Drawing", [star()])
    source.data.bevel_depth = 0.1

    def state():  # without registered groups, which Blender before 5.0 lists among the properties
        own = {key for key, value in source.items() if not hasattr(value, "to_dict")}
        return source.data.bevel_depth, source.data.dimensions, source.matrix_world.copy(), own

    before = state()
    generate()
    assert state() == before
    assert bpy.context.selected_objects == [source]
    assert bpy.context.view_layer.objects.active is source


def test_the_frame_jumps_to_the_result_or_stays(extension) -> None:
    extension.cages([poly_curve("Drawing", [star()])])
    assert bpy.context.scene.frame_current == 1
    generate()
    assert bpy.context.scene.frame_current == end_of(output()[0])


def test_own_levels_that_are_missing_or_out_of_plane_are_refused() -> None:
    poly_curve("Drawing", [star()])
    with refused():
        generate("20", use_selected_as_levels=True)
    drawings.wire("Tilted", [circle(12, 1.5)]).rotation_euler = (0.3, 0.0, 0.0)
    drawings.choose(bpy.data.objects["Tilted"], bpy.data.objects["Drawing"])
    with refused("'Tilted'"):
        generate("20", use_selected_as_levels=True)


def test_undo_and_redo() -> None:
    poly_curve("Drawing", [star()])
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="before")
    before = snapshot()
    generate()
    bpy.ops.ed.undo_push(message="after")
    after = snapshot()
    bpy.ops.ed.undo()
    assert snapshot() == before and not drawings.sets().everywhere()
    bpy.ops.ed.redo()
    assert snapshot() == after and len(drawings.sets().everywhere()) == 1


ENERGIES = ["SHAPE_KEEPING", "INITIAL_DISPLACEMENT", "STEP_DISPLACEMENT", "BOUNDARY_ARAP", "INTERIOR_ARAP"]


@pytest.mark.parametrize("energy", slow_after(2, ENERGIES))
def test_each_energy_gives_its_own_certified_cage_looser_than_the_tightest(energy) -> None:
    poly_curve("Drawing", [star()])
    shapes = []
    for wanted in ("AREA", energy):
        generate("16", energy=wanted)
        fine, cage = drawings.made()
        depsgraph = at_frame(9000)
        assert solid(cage, depsgraph).contains(solid(fine, depsgraph))
        shapes.append((drawings.evaluated(cage, depsgraph), certificate(cage).excess))
    (tight, least), (other, more) = shapes
    assert np.abs(tight - other).max() > 1e-4
    assert more > least


WAYS = [("decimation", key) for key in ("ON_CURVE", "OUTSIDE", "ARC_LENGTH")]


@pytest.mark.parametrize(("name", "key"), [*WAYS, pytest.param("as_published", True, marks=pytest.mark.slow)])
def test_each_way_to_start_makes_the_core_s_certified_cage(core, name, key) -> None:
    poly_curve("Drawing", [star(24)])
    generate("10", **{name: key})
    fine, cage = drawings.made()
    assert not certificate(cage).edited
    depsgraph = at_frame(end_of(cage))
    assert solid(cage, depsgraph).contains(solid(fine, depsgraph))
    assert lines(cage, depsgraph).distance(lines(fine, depsgraph)) > 0.0
    starts = {"ON_CURVE": core.LineCycles, "OUTSIDE": core.LineCycles, "ARC_LENGTH": core.ArcLength}
    if key in starts:
        mesh = core.Mesh.from_loops([star(24).astype(np.float32).astype(float)])
        settings = core.Settings(decimation=starts[key]())
        (level,) = core.nested_cages(mesh, [10], settings, stored=np.float32).levels
        assert solid(cage, depsgraph).area == pytest.approx(level.cage.area, rel=1e-3)


def eight() -> np.ndarray:
    return np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])


def test_in_a_batch_what_cannot_be_done_is_skipped_and_listed(reports) -> None:
    for x in range(4):
        poly_curve(f"Glyph {x}", [star()] if x % 2 else [eight()]).location.x = 3.0 * x
    poly_curve("Open", [star()], cyclic=False)
    drawings.choose(*bpy.data.objects)
    generate()
    assert {each.name for each in bpy.data.collections if "Glyph" in each.name} == {"Glyph 1 Cages", "Glyph 3 Cages"}
    told = reports.read("Warning").splitlines()
    assert re.findall(r"\d+", told[-1]) == ["3"]
    assert all(any(f"'{name}'" in line for line in told) for name in ("Glyph 0", "Glyph 2", "Open"))
    assert not any(f"'Glyph {number}'" in line for number in (1, 3) for line in told)


def test_the_largest_clearance_is_told() -> None:
    poly_curve("Drawing", [star(), circle(12, 0.1)])
    with refused("0.0482963"):  # for two levels in a hole
        generate("20, 10", clearance=0.06, loops="keep")
    generate(clearance=0.02)


@pytest.mark.slow
def test_drawings_of_one_run_share_a_collection_within_their_own() -> None:
    scene = bpy.context.scene
    parts = [poly_curve(name, [star() + 3.0 * x]) for x, name in enumerate(("Eye", "Nose", "Mouth"))]
    face = drawings.gathered("Face", *parts, home=drawings.gathered("Character"))
    drawings.choose(*reversed(parts))
    generate()
    run = bpy.data.collections["Cages of 3 Drawings"]
    assert set(face.children) == {run}
    assert sorted(collection.name for collection in run.children) == ["Eye Cages", "Mouth Cages", "Nose Cages"]
    assert [marker.name for marker in scene.timeline_markers] == ["3 Drawings"]
    generate("12")
    assert len(bpy.data.collections) == 6


@pytest.mark.slow
@pytest.mark.parametrize("change", [{"levels": "12"}, {"frames_per_step": 9}, {"energy": "SHAPE_KEEPING"}])
def test_the_redo_panel_leaves_nothing_of_the_first_result(change) -> None:
    """What Blender does when a setting is changed there: it undoes the operator and executes it anew."""
    poly_curve("Drawing", [star()])
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="before")
    generate(**change)
    expected = snapshot()
    bpy.ops.ed.undo_push(message="directly")
    bpy.ops.ed.undo()
    generate()
    bpy.ops.ed.undo_push(message="first")
    bpy.ops.ed.undo()
    generate(**change)
    assert snapshot() == expected
