"""Levels by what they may cost, and cages inside the drawing: certified as stored, animated, verified, made again."""

from __future__ import annotations

import re

import bpy
import pytest
import shapely
from examples.check_animation import Played, check_animation
from mathutils import Matrix

from support.drawings import at_frame, circle, facts, poly_curve, set_in, solid, star


def outputs():
    return {c.name: c for c in bpy.data.collections if "source" in facts(c)}


def made(collection):
    found = [obj for obj in outputs()[collection].objects if "level" in facts(obj)]
    return sorted(found, key=lambda obj: facts(obj)["level"])


def taken(addon, cage):
    """What is noted of the distance or excess of a cage."""
    return dict(addon.record.notes(addon.record.node_of(cage))).get("note.tolerance")


def farthest(cage, fine):
    """Hausdorff distance from the cage's solid to the drawing's, by shapely."""
    return shapely.hausdorff_distance(cage, fine, densify=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1.0, *(pytest.param(scale, marks=pytest.mark.slow) for scale in (1000.0, 0.001))])
def test_a_distance_is_kept_in_units_of_the_scene(addon, scale) -> None:
    obj = poly_curve("Drawing", [circle(90)])
    obj.scale = (scale, scale, scale)
    assert bpy.ops.object.nested_cages_generate(levels=f"{0.03 * scale:.9g}u, {0.1 * scale:.9g} u") == {"FINISHED"}
    fine, finer, coarser = made("Drawing Cages")
    depsgraph = at_frame(9000)
    shapes = [solid(each, depsgraph) for each in (fine, finer, coarser)]
    assert shapes[1].contains_properly(shapes[0])
    assert shapes[2].contains_properly(shapes[1])
    for cage, shape, most in ((finer, shapes[1], 0.03), (coarser, shapes[2], 0.1)):
        assert farthest(shape, shapes[0]) <= most * (1 + 1e-5)
        need, count = taken(addon, cage), len(cage.data.vertices)
        assert need["count"] == count and need["taken"] <= need["limit"] == pytest.approx(most * scale)
        assert need["fewest"] <= count <= need["fewest"] + (1 if cage is finer else 3)
    assert len(coarser.data.vertices) < len(finer.data.vertices)


@pytest.mark.slow
def test_units_of_the_scene_are_understood() -> None:
    bpy.context.scene.unit_settings.scale_length = 0.01
    poly_curve("Drawing", [circle(60, 100.0)])
    assert bpy.ops.object.nested_cages_generate(levels="50 mm") == {"FINISHED"}
    cage = made("Drawing Cages")[1]
    assert "within 5 of the shape" in facts(cage)["need"]


@pytest.mark.slow
def test_an_excess_is_of_the_drawing_on_every_level(addon) -> None:
    poly_curve("Drawing", [star()])
    assert bpy.ops.object.nested_cages_generate(levels="40, +20%, +50 %") == {"FINISHED"}
    fine, *cages = made("Drawing Cages")
    depsgraph = at_frame(9000)
    area = solid(fine, depsgraph).area
    excesses = [solid(cage, depsgraph).area / area - 1.0 for cage in cages]
    assert excesses[1] <= 0.2 + 1e-7
    assert excesses[2] <= 0.5 + 1e-7
    assert [len(cage.data.vertices) for cage in cages] == sorted((len(c.data.vertices) for c in cages), reverse=True)
    assert not taken(addon, cages[0]) and taken(addon, cages[2])["limit"] == 0.5


@pytest.mark.slow
def test_an_excess_that_cannot_be_is_refused() -> None:
    poly_curve("Drawing", [star()])
    for levels, sentence in (("+0.00001%", "ask for more"), ("1e-9u", "No cage within a distance of 1e-09")):
        with pytest.raises(RuntimeError, match=sentence):
            bpy.ops.object.nested_cages_generate(levels=levels)
    assert not outputs()


@pytest.mark.slow
def test_what_was_made_is_remembered_by_its_need(runs) -> None:
    poly_curve("Drawing", [star()])
    counts = []
    for levels in ("+20%", "+60%", "+20%"):
        bpy.ops.object.nested_cages_generate(levels=levels)
        counts.append(len(made("Drawing Cages")[1].data.vertices))
    assert counts[0] == counts[2] > counts[1]
    assert len(runs) == 2


def test_the_panel_says_what_levels_come_to(addon) -> None:
    poly_curve("Drawing", [circle(60, 2.0)])
    settings = bpy.context.scene.nested_cages
    settings.levels = "20%, 5 cm, +25%, 12"
    bpy.context.view_layer.update()
    said = addon.ui.doors.counts(bpy.context).split(", ")
    assert sorted(said) == ["0.884 % of the size", "1.25 times the area", "20 % = 12 vertices"]
    settings.levels = "12"
    assert addon.ui.doors.counts(bpy.context) == "of 60 vertices"
    settings.levels = "12 apples"
    assert addon.ui.doors.counts(bpy.context) == ""


@pytest.mark.slow
def test_inner_cages_lie_inside_and_play(core) -> None:
    obj = poly_curve("Drawing", [star(80)])
    assert bpy.ops.object.nested_cages_generate(levels="24, 10", inside=True) == {"FINISHED"}
    fine, first, second = made("Drawing Inner Cages")
    names = [f"Drawing Inner {name}" for name in ("Fine", "Cage 1", "Cage 2")]
    assert [each.name for each in (fine, first, second)] == names
    scene = bpy.context.scene
    assert scene.frame_current == facts(outputs()["Drawing Inner Cages"])["end"]
    found = set_in(outputs()["Drawing Inner Cages"])
    frames = [certificate.frames for certificate in found.certificates]
    outcome = check_animation(scene, [Played(found.name, found.source, found.fine, found.cages, frames, inside=True)])
    assert outcome.problems == ()
    assert outcome.poses > 10
    depsgraph = at_frame(9000)
    excesses = [
        solid(inner, depsgraph).area / solid(outer, depsgraph).area - 1.0
        for outer, inner in ((fine, first), (first, second))
    ]
    for cage, excess in zip((first, second), excesses, strict=True):
        assert facts(cage)["excess"] == pytest.approx(excess, abs=1e-5)
        assert -1.0 < excess < 0.0
        assert facts(cage)["inside"]
    assert "strictly inside level 0" in facts(first)["certificate"]
    assert obj.visible_get()
    # the first shape of a cage is looser than the last one
    assert len(first.data.shape_keys.key_blocks) > 2


@pytest.mark.slow
def test_cages_around_and_inside_are_kept_side_by_side_and_replaced_each_by_its_own(addon) -> None:
    obj = poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20")
    outer = made("Drawing Cages")
    bpy.ops.object.nested_cages_generate(levels="16, 10", inside=True)
    assert made("Drawing Cages") == outer
    inner = made("Drawing Inner Cages")
    bpy.ops.object.nested_cages_generate(levels="12", inside=True)
    assert made("Drawing Inner Cages") == inner[:2]
    assert len(inner[1].data.vertices) == 12
    bpy.ops.object.nested_cages_generate(levels="18")
    assert made("Drawing Cages") == outer
    assert len(outer[1].data.vertices) == 18
    assert len(outputs()) == 2
    colours = [set_in(collection).record.colours for collection in outputs().values()]
    assert len(set(colours)) == 2
    for frame in (1, 9000):
        at_frame(frame)
        shown = [each for each in (inner[1], inner[0], outer[1]) if not each.hide_viewport]
        if frame == 9000:
            assert shown == [inner[1], inner[0], outer[1]]
    assert obj.visible_get()
    assert [facts(o)["inside"] for o in addon.record.CageSet.all_of(obj)] == [False, True]


@pytest.mark.slow
def test_inner_cages_are_verified(addon) -> None:
    obj = poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20")
    bpy.ops.object.nested_cages_generate(levels="16, 10", inside=True)
    _, first, second = made("Drawing Inner Cages")
    bpy.ops.object.nested_cages_remove_animation()
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    holds = f"Holds on frame {bpy.context.scene.frame_current}"
    assert facts(first)["check"] == facts(second)["check"] == holds
    assert facts(made("Drawing Cages")[1])["check"].startswith("Holds")
    for each in bpy.context.selected_objects:
        each.select_set(False)
    bpy.context.view_layer.objects.active = first
    bpy.ops.object.nested_cages_remove_animation()
    first.data.transform(Matrix.Scale(1.2, 4))
    first.data.update()
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert facts(first)["check"].startswith("Broken")
    assert "'Drawing Inner Fine' does not enclose 'Drawing Inner Cage 1'" in facts(first)["finding"]
    assert first.select_get()


@pytest.mark.slow
def test_selected_cages_of_both_sides_are_one_chain() -> None:
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20")
    bpy.ops.object.nested_cages_generate(levels="16, 10", inside=True)
    at_frame(9000)
    around, (_, first, second) = made("Drawing Cages")[1], made("Drawing Inner Cages")
    for each in bpy.context.selected_objects:
        each.select_set(False)
    for each in (second, around, first):
        each.select_set(True)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert "'Drawing Cage 1' encloses 'Drawing Inner Cage 1'" in facts(around)["finding"]
    assert "'Drawing Inner Cage 1' encloses 'Drawing Inner Cage 2'" in facts(second)["finding"]


@pytest.mark.slow
def test_inner_cages_move_nothing_and_say_so(addon) -> None:
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="16", inside=True)
    for operator in ("bind", "add_handles", "live"):
        assert not getattr(bpy.ops.object, f"nested_cages_{operator}").poll()
    with pytest.raises(RuntimeError, match="Inner cages do not contain the drawing, so they cannot move it"):
        bpy.ops.object.nested_cages_bind()
    with pytest.raises(RuntimeError, match="lie around the drawing: leave 'Cage Inside' off"):
        bpy.ops.object.nested_cages_follow(levels="16", inside=True)
    with pytest.raises(RuntimeError, match="leave distances and areas such as"):
        bpy.ops.object.nested_cages_follow(levels="2u")
    with pytest.raises(RuntimeError, match="Inner cages have vertex counts: leave distances and areas such as"):
        bpy.ops.object.nested_cages_generate(levels="20, +5%", inside=True)


@pytest.mark.slow
def test_scripts_get_inner_cages_and_needs(addon, core) -> None:
    obj = poly_curve("Drawing", [star()])
    ((first, second),) = addon.api.cages([obj], [20, 0.15], inside=True)
    assert first.name == "Drawing Inner Cage 1"
    assert len(second.data.vertices) == 9
    ((near, wide),) = addon.api.cages([obj], [core.Within(distance=0.05), core.Within(excess=0.5)])
    assert "within 0.05 of the shape" in facts(near)["need"]
    assert "50 % was allowed" in facts(wide)["need"]


def test_both_sides_are_exported_with_one_drawing(tmp_path) -> None:
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="16", inside=True)
    obj = bpy.data.objects["Drawing"]
    path = tmp_path / "one.svg"
    bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG")
    assert path.read_text().count("<path") == 2
    bpy.ops.object.nested_cages_generate(levels="20")
    path = tmp_path / "both.svg"
    bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG")
    text = path.read_text()
    assert text.count("<path") == 3
    places = [text.index(name) for name in ("Drawing Cage 1", "Drawing Fine", "Drawing Inner Cage 1")]
    assert places == sorted(places)
    assert re.findall(r'class="([\w-]+)"', text) == ["level-1", "level-0", "inner-1"]
    assert obj.select_get()
