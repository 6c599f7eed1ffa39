"""At most so many vertices, always: more than the drawing has, fewer than its loops need, shared between loops."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import Mesh, NestedCagesError, Settings, Share, Within, inner_cages, nested_cages, verify
from support.families import simple
from support.judging import codes, note, rejected
from support.marks import slow_after
from support.shapes import annulus, assert_nested, islands, letter_a, ring, star


@pytest.mark.parametrize("levels", [[64], [64, 500], [12, 16]])
def test_more_vertices_than_what_is_enclosed_has_are_as_many(levels: list[int]) -> None:
    inside = 16
    for level, count in zip(nested_cages(annulus(8), levels), sorted(levels, reverse=True), strict=True):
        assert_nested(level.cage, level.fine)
        assert len(level.cage.vertices) <= min(count, inside) and verify(level.cage, annulus(8))
        if count > inside:
            data = note(level, "note.count").data
            assert (data["asked"], data["given"]) == (count, len(level.cage.vertices))
        else:
            assert len(level.cage.vertices) == count and "note.count" not in codes(level)
        inside = len(level.cage.vertices)


def test_a_mesh_of_ones_own_may_have_more_vertices_than_the_drawing() -> None:
    level = nested_cages(Mesh.from_loops([ring(8)]), Mesh.from_loops([ring(24, 1.3)]))[0]
    assert len(level.cage.vertices) == 24
    assert_nested(level.cage, level.fine)


def test_vertices_are_shared_between_loops_so_that_the_area_is_least() -> None:
    """Of two discs of radii 2 and 1, each with the regular polygon around it."""
    fine = Mesh.from_loops([ring(200, 2.0), ring(200, 1.0) + np.array([5.0, 0.0])])
    for count in (8, 14):
        areas = {
            k: 4.0 * k * np.tan(np.pi / k) + (count - k) * np.tan(np.pi / (count - k)) for k in range(3, count - 2)
        }
        level = nested_cages(fine, count, clearance=1e-6, loops="keep")[0]
        assert level.cage.area == pytest.approx(min(areas.values()), rel=2e-3)
        best = min(areas, key=lambda k: areas[k])
        assert sorted(len(loop) for loop in level.cage.loops) == sorted([best, count - best])


@pytest.mark.parametrize("made", [nested_cages, inner_cages], ids=["around", "inside"])
@pytest.mark.parametrize(
    ("level", "code"),
    [(2, "count.too_small"), (0, "count.too_small"), (-3, "count.too_small"), (12.5, "level.invalid"),
     ("x", "level.invalid"), ([], "level.invalid"), (None, "level.invalid"), (["12", "2.5"], "level.invalid"),
     (True, "setting.invalid")],
)  # fmt: skip
def test_what_is_no_level_is_refused(made: object, level: object, code: str) -> None:
    with rejected(code):
        made(star(), level)  # type: ignore[operator]


def test_levels_as_people_write_them() -> None:
    """Counts, shares of the vertices, distances and excesses, with any separators."""
    fine = annulus(48)
    for text in ("24, 10 %; +40 %", "24 10% +40%"):
        hierarchy = nested_cages(fine, text)
        plain = nested_cages(fine, [24, Share(0.1), Within(excess=0.4)])
        assert [len(cage.vertices) for cage in hierarchy.cages] == [len(cage.vertices) for cage in plain.cages]
        assert [level.cage.area for level in hierarchy] == pytest.approx([level.cage.area for level in plain])
    assert len(nested_cages(fine, "24")[0].cage.vertices) == 24 == len(nested_cages(fine, "25%")[0].cage.vertices)
    near = nested_cages(fine, "0.2u")[0]
    assert note(near, "note.tolerance").data["limit"] == 0.2 >= note(near, "note.tolerance").data["taken"]
    for word in (
        "0",
        "2.5",
        "+25",
        "-2px",
        "px",
        "+%",
        "+3px",
        "nan",
        "infpx",
        "101%",
        "1e3",
        "+",
        "0px",
        ".",
        "12,5 %",
    ):
        with rejected("level.invalid"):
            nested_cages(fine, word)


@pytest.mark.slow
def test_shares_are_of_the_vertices_and_at_least_what_the_loops_need() -> None:
    assert len(nested_cages(letter_a(), Share(0.1))[0].cage.vertices) == round(0.1 * len(letter_a().vertices))
    assert len(nested_cages(star(), [Share(1.0)])[0].cage.vertices) == len(star().vertices)
    few = nested_cages(islands(), Share(0.01))[0]
    assert len(few.cage.vertices) >= 3 and few.report.strict


def test_levels_come_in_any_order_and_each_encloses_the_one_before() -> None:
    one, other = nested_cages(star(), [8, 30, 15]), nested_cages(star(), [30, 15, 8])
    assert [len(level.cage.vertices) for level in one] == [30, 15, 8]
    for mine, yours in zip(one, other, strict=True):
        assert mine.cage == yours.cage and verify(mine.cage, mine.fine)
    assert one[1].fine == one[0].cage and one[2].fine == one[1].cage
    areas = [level.cage.area for level in one]
    assert areas == sorted(areas)


@pytest.mark.parametrize("seed", slow_after(0, range(20), thorough_after=3))
def test_every_small_count_has_a_cage_that_is_no_looser_than_with_fewer_vertices(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = simple(random, 10, 60)
    areas = []
    for count in (3, 4, 5, 6, 7, 9):
        level = nested_cages(fine, count)[0]
        assert len(level.cage.vertices) <= count and verify(level.cage, fine, level.report.wanted_clearance)
        areas.append(level.cage.area)
    assert all(after <= 1.005 * min(areas[:k]) for k, after in enumerate(areas) if k)


@pytest.mark.slow
def test_the_least_count_around_blocking_loops_is_named_and_works() -> None:
    with pytest.raises(NestedCagesError) as caught:
        nested_cages(islands(), 15, loops="keep")
    least = caught.value.data["least"]
    assert caught.value.code == "count.too_small" and 15 < least < 20
    level = nested_cages(islands(), least, Settings(loops="keep"))[0]
    assert len(level.cage.vertices) == least and len(level.cage.loops) == 5
