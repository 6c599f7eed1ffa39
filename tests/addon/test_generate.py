"""Levels as the user writes them, and the refusals before anything is computed."""

from __future__ import annotations

import bpy
import pytest

from support.drawings import circle, facts, poly_curve, star
from support.drawings import text as word

UNITS = {"m": 1.0, "mm": 0.001, "u": 1.0}


@pytest.mark.parametrize(
    ("text", "levels"),
    [
        ("64, 24", (64, 24)),
        ("64 24", (64, 24)),
        (" 64;24 ", (64, 24)),
        ("64, *", (64, "*")),
        ("7", (7,)),
        ("64,, 24,", (64, 24)),
        ("24, 64", (64, 24)),  # the finest comes first
        ("24, *, 64", (24, "*", 64)),
    ],
)
def test_levels_are_counts_or_own_objects(addon, text, levels) -> None:
    assert addon.generation.levels.parse_levels(text, UNITS) == levels


def test_levels_are_percentages_distances_and_excesses(addon, core) -> None:
    found = addon.generation.levels.parse_levels("12.5 %, 5 mm 2u;+25%", UNITS)
    within = core.Within
    assert found == (
        core.hierarchy.Share(0.125), within(distance=0.005), within(distance=2.0), within(excess=0.25)
    )  # fmt: skip


@pytest.mark.parametrize("text", ["", "  ", "x", "64, x", "-3", "1.5", "%", ",", "1e3", "0", "120%", "2 px", "+2m"])
def test_other_texts_are_refused(addon, text) -> None:
    kinds = r"a number of vertices such as 24, a share .* 8%, a distance such as 2m, or more area such as \+25%"
    with pytest.raises(addon.errors.UserError, match=rf"A level is {kinds};"):
        addon.generation.levels.parse_levels(text, UNITS)


def request(addon, loops, name="Drawing"):
    return addon.generation.generate.Request(
        addon.scene.convert.fine_drawing(addon.scene.convert.read(bpy.context, poly_curve(name, loops)))
    )


@pytest.mark.parametrize(
    ("levels", "counts"),
    [("24, 9", (24, 9)), ("50%, 10%", (30, 8)), ("1%", (8,)), ("100%, 60", (60, 60)), ("5", (6,))],
)
def test_percentages_are_of_the_drawing_and_leave_enough_vertices_per_loop(addon, levels, counts) -> None:
    fine = request(addon, [circle(48), circle(12, 0.3)]).fine.mesh()
    asked = addon.generation.levels.parse_levels(levels, UNITS)
    found = addon.generation.levels.wanted_levels(asked, fine, (), "Drawing")
    assert tuple(wanted.level for wanted in found) == counts


@pytest.mark.parametrize(
    ("levels", "counts", "note"),
    [
        ("61", [60], ("note.count", {"asked": 61, "given": 60, "on": "mesh"})),
        ("20%, 21", [12, 12], ("level.order", {"level": 2, "asked": 21, "given": 12})),
        ("2", [3], ("level.small", {"asked": 2, "given": 3})),
        ("1%", [3], ("level.share", {"share": 1.0, "total": 60, "given": 3})),
    ],
)
def test_levels_are_clamped_to_what_is_possible_with_a_note(addon, levels, counts, note) -> None:
    options = addon.generation.generate.Options(levels=addon.generation.levels.parse_levels(levels, UNITS))
    generation = addon.generation.generate.Generation([request(addon, [circle(48), circle(12, 0.3)])], options)
    for _ in generation:
        pass
    (result,) = generation.results
    assert [len(level.vertices) for level in result.levels] == counts
    assert note in [(each.code, each.data) for each in result.levels[-1].report.notes]


@pytest.mark.slow
def test_a_count_holds_where_loops_are_in_each_others_way_unless_all_are_kept(addon) -> None:
    generate, levels = addon.generation.generate, addon.generation.levels.parse_levels("12", UNITS)
    fine = [request(addon, [circle(40, size) for size in (4.0, 3.9, 3.8)])]
    generation = generate.Generation(fine, generate.Options(levels=levels))
    assert list(generation)
    (level,) = generation.results[0].levels
    (note,) = (note for note in level.report.notes if note.code == "note.loops")
    assert len(level.vertices) <= 12 and "hole is filled" in note
    keeping = generate.Options(levels=levels, rules=addon.generation.rules.Rules(loops="keep"))
    with pytest.raises(addon.errors.UserError, match="ask for at least"):
        list(generate.Generation(fine, keeping))


def test_without_levels_there_is_nothing_to_do(addon) -> None:
    with pytest.raises(addon.errors.UserError, match="Enter a number of vertices"):
        addon.generation.generate.Generation([request(addon, [circle(48)])], addon.generation.generate.Options())


def test_progress_goes_up_to_one_over_all_drawings(addon) -> None:
    requests = [request(addon, [circle(24)], "One"), request(addon, [circle(30)], "Two")]
    generation = addon.generation.generate.Generation(requests, addon.generation.generate.Options(levels=(8, 4)))
    fractions, messages = zip(*((p.fraction, p.message) for p in generation), strict=True)
    assert list(fractions) == sorted(fractions)
    assert fractions[0] >= 0.0
    assert fractions[-1] == 1.0
    assert {message.partition(":")[0] for message in messages} == {
        "One, cage 1",
        "One, cage 2",
        "Two, cage 1",
        "Two, cage 2",
    }
    assert [result.drawing.name for result in generation.results] == ["One", "Two"]


def test_a_drawing_far_from_its_origin_is_certified_as_stored(addon, core) -> None:
    """At a thousand times its size away, float32 leaves some 1e-4 of the size between two numbers."""
    generation = addon.generation.generate.Generation(
        [request(addon, [star() + 2000.0])], addon.generation.generate.Options(levels=(16,))
    )
    for _ in generation:
        pass
    (level,) = generation.results[0].levels
    fine = generation.results[0].drawing.mesh()
    assert core.verify(level.cage, fine, 1e-6 * fine.diagonal).holds


@pytest.mark.slow
def test_letters_that_interlock_leave_room_for_the_next_cage() -> None:
    word("Word", "Hifly")
    assert bpy.ops.object.nested_cages_generate() == {"FINISHED"}
    assert [facts(obj)["level"] for obj in bpy.data.collections["Word Cages"].objects] == [0, 1, 2]
