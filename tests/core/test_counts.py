"""At most so many vertices, always: more than the drawing has, fewer than its loops need, shared between loops."""

from collections.abc import Callable

import numpy as np
import pytest

from nestedcages_core import Mesh, NestingError, Share, excess_by_count, inner_cages, nested_cages, verify
from support.families import blob, simple
from support.judging import codes, never_rises, note, rejected
from support.marks import slow_after
from support.shapes import annulus, islands, letter_a, ring, star


@pytest.mark.parametrize("levels", [[64], [64, 500], [12, 16]])
def test_more_vertices_than_what_is_enclosed_has_are_as_many(levels: list[int]) -> None:
    inside = 16
    for level, count in zip(nested_cages(annulus(8), levels), sorted(levels, reverse=True), strict=True):
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


OWN = Mesh.from_loops([ring(9, 2.0)])
WORDS = "24x 5mm 0 2.5 +25 -2px px +% +3px nan infpx 101% 1e3 + 0px . x"
NO_LEVELS: dict[str, list[object]] = {
    "count.too_small": [2, 0, -3, [OWN, 2]],
    "setting.invalid": [True, [True]],
    "level.invalid": [12.5, [], None, ["12", "2.5"], ["many"], [24, ""], "12,5 %", *WORDS.split(" ")],
}


@pytest.mark.parametrize("made", [nested_cages, inner_cages], ids=["around", "inside"])
@pytest.mark.parametrize(("code", "levels"), NO_LEVELS.items(), ids=NO_LEVELS)
def test_what_is_no_level_is_refused(made: object, code: str, levels: list[object]) -> None:
    for level in levels:
        with rejected(code):
            made(star(), level)  # type: ignore[operator]
    with rejected("count.too_small", NestingError, total=2, least=3):
        nested_cages([ring(200), ring(20, 0.4)], [OWN, 2])


@pytest.mark.slow
def test_shares_are_of_the_vertices_and_at_least_what_the_loops_need() -> None:
    assert len(nested_cages(letter_a(), Share(0.1))[0].cage.vertices) == round(0.1 * len(letter_a().vertices))
    assert len(nested_cages(star(), [Share(1.0)])[0].cage.vertices) <= len(star().vertices)
    few = nested_cages(islands(), Share(0.01))[0]
    assert len(few.cage.vertices) >= 3 and few.report.strict


@pytest.mark.parametrize("seed", slow_after(0, range(100), thorough_after=3))
def test_every_count_has_a_cage_that_is_no_looser_than_with_fewer_vertices(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = blob(random, int(random.integers(20, 160))) if seed % 4 == 3 else simple(random, 10, 60)
    areas = []
    for count in (3, 4, 5, 6, 7, 9, *((13, 17, 24, 40) if seed > 2 else ())):
        level = nested_cages(fine, count)[0]
        assert len(level.cage.vertices) <= count and verify(level.cage, fine, level.report.wanted_clearance)
        areas.append(level.cage.area)
    assert all(after <= 1.005 * min(areas[:k]) for k, after in enumerate(areas) if k)


@pytest.mark.parametrize("shape", slow_after(1, [star, islands, letter_a]), ids=lambda shape: shape.__name__)
def test_the_excess_by_count_is_about_that_of_the_cages(shape: Callable[[], Mesh]) -> None:
    fine = shape()
    curve = excess_by_count(fine, 20)
    assert set(curve) >= set(range(4, 21)) and never_rises(list(curve.values()), 0.0)
    for count in (4, 9, 20):
        assert curve[count] == pytest.approx(nested_cages(fine, count)[0].excess, rel=0.1)


def test_the_excess_by_count_needs_a_triangle_and_keeps_a_clearance() -> None:
    square = Mesh.from_loops([ring(4)])
    assert excess_by_count(square, 4, clearance=0.1)[4] == pytest.approx(0.3, abs=0.02)
    for most in (2, 4.0, True):
        with rejected("setting.invalid", name="most"):
            excess_by_count(square, most)  # type: ignore[arg-type]
