"""Which loops a cage has: holes are filled and parts joined where that adds the least area, and all of it is named."""

import sys
import warnings
from collections.abc import Iterator
from contextlib import suppress
from itertools import product
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import AxisAligned, Mesh, Mirror, NestedCagesError, Settings, Share, check, nested_cages, verify
from support.families import drawing
from support.judging import codes, note, rejected
from support.marks import slow_after
from support.shapes import islands, polygon, ring

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def at(x: float, y: float = 0.0) -> np.ndarray:
    return np.array([x, y])


ROW = Mesh.from_loops([SQUARE, SQUARE + at(1.2), SQUARE + at(3.2)])
"""Three unit squares, 0.2 and 1 apart."""
HOLES = (1.0, 2.0, 3.0)
PLATE = Mesh.from_loops([10.0 * SQUARE, SQUARE + at(1, 1), 2.0 * SQUARE + at(1, 6), 3.0 * SQUARE + at(5, 3)])
"""A square of 100 with square holes of 1, 4 and 9."""


def bell() -> Mesh:
    """Two weights of two discs each and the bar between them, each with a dent: parts that only just do not touch."""
    rings = [ring(24, 0.5) + at(x, y) for x, y in ((0.0, 0.0), (0.0, 1.1), (3.0, 0.0), (3.0, 1.1))]
    return Mesh.from_loops([*rings, np.array([[0.7, 0.45], [2.3, 0.45], [2.3, 0.65], [0.7, 0.65]])])


def target() -> Mesh:
    """A ring around a disc with a hole, off its middle."""
    return Mesh.from_loops([ring(40, 2.0), ring(40, 1.5), ring(30, 0.6) + at(0.3, 0.2), ring(20, 0.2) + at(0.3, 0.2)])


def cloud() -> Mesh:
    """A disc with forty small holes."""
    angle = np.arange(40) * 2.4
    places = (0.1 + 0.02 * np.arange(40))[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Mesh.from_loops([ring(60), *(ring(6, 0.01) + place for place in places)])


SHAPES = {"bell": bell(), "target": target(), "cloud": cloud(), "islands": islands()}


# The least area of all choices


def splits(count: int, parts: int) -> Iterator[tuple[int, ...]]:
    return (each for each in product((3, 4), repeat=parts) if sum(each) <= count)


def least_row(count: int) -> float:
    """Of all ways to join neighbours, each part by its smallest triangle (twice as large) or itself."""
    ways = ((1.0, 1.0, 1.0), (2.2, 1.0), (1.0, 3.0), (4.2,))
    return min(
        sum(area * (2 if k == 3 else 1) for area, k in zip(way, split, strict=True))
        for way in ways
        for split in splits(count, len(way))
    )


def least_plate(count: int) -> float:
    """Of all ways to keep holes, each by its largest triangle (half as large) or itself; the outline has 4 vertices."""
    kept = [[side for side, keep in zip(HOLES, way, strict=True) if keep] for way in product((0, 1), repeat=3)]
    return min(
        100.0 - sum(side**2 / (2 if k == 3 else 1) for side, k in zip(way, split, strict=True))
        for way in kept
        for split in splits(count - 4, len(way))
    )


@pytest.mark.parametrize("count", slow_after(2, [7, 11, 8, 12, 4, 6], thorough_after=4))
def test_parts_are_joined_as_the_best_of_all_choices_joins_them(count: int) -> None:
    level = nested_cages(ROW, count, clearance=1e-6)[0]
    assert 3.0 < level.cage.area <= (1.0 + 1e-4) * least_row(count)  # notches may be left at a join
    joined = {12: ()}.get(count, ((0, 1, 2),) if count < 8 else ((0, 1),))
    assert level.report.lost.joined == joined and level.report.lost.filled == ()
    assert ("note.loops" in codes(level)) == bool(joined)


@pytest.mark.parametrize("count", slow_after(2, [7, 13, 8, 16, 4, 11, 15], thorough_after=5))
def test_holes_are_filled_as_the_best_of_all_choices_fills_them(count: int) -> None:
    level = nested_cages(PLATE, count, clearance=1e-6)[0]
    assert level.cage.area == pytest.approx(least_plate(count), rel=1e-4)
    filled = {4: (1, 2, 3), 5: (1, 2, 3), 7: (1, 2), 8: (1, 2), 15: (), 16: ()}.get(count, (1,))
    assert level.report.lost.filled == filled and level.report.lost.joined == ()
    verdict = check(PLATE, level)
    assert verdict and len(verdict.lost) == len(filled)
    if filled:
        said = note(level, "note.loops")
        assert said.data["filled"] == filled and said.data["joined"] == ()


@pytest.mark.slow
def test_the_choice_is_tight_around_curved_parts() -> None:
    """Around specks one loop, around a frame with something in it a middle, around a cheap hole nothing of it."""
    specks = nested_cages(cloud(), 24)[0]
    assert len(specks.cage.loops) <= 3 and specks.excess < 0.05
    weights, keep = (nested_cages(bell(), 16, loops=loops)[0] for loops in ("auto", "keep"))
    assert weights.excess < 0.6 * keep.excess and 1 < len(weights.cage.loops) < 5
    rings, whole = (nested_cages(target(), 40, loops=loops)[0] for loops in ("auto", "one"))
    assert len(rings.cage.loops) > 1 and rings.cage.area < 0.9 * whole.cage.area


# The count is a promise


@pytest.mark.parametrize("count", slow_after(1, [5, 8, 3, 12, 17], thorough_after=2))
@pytest.mark.parametrize("name", SHAPES)
def test_no_cage_has_more_vertices_than_asked_for(name: str, count: int) -> None:
    fine = SHAPES[name]
    level = nested_cages(fine, count)[0]
    assert len(level.cage.vertices) <= count and polygon(level.cage).contains(polygon(fine))
    certificate = verify(level.cage, fine, level.report.wanted_clearance, same_loops=False)
    assert certificate and certificate.lost == level.report.lost
    assert len(check(fine, level).lost) == len(certificate.lost.filled) + len(certificate.lost.joined)


def mirror() -> Mirror:
    return Mirror((1.5, 0.55), (0.0, 1.0))


WITH: dict[str, dict[str, Any]] = {
    **{name: {name: value} for name, value in (("clearance", 0.02), ("grid", 0.05), ("symmetry", mirror()))},
    "float32": {"stored": np.float32},
    "weights": {"weights": np.linspace(0.5, 2.0, 100)},
    "pins": {"pins": [0, 50]},
    "edges": {"min_edge": 0.1},
    "angles": {"min_angle": 20.0},
    "no fallback": {"fallback": None},
}


@pytest.mark.parametrize("name", slow_after(1, WITH, thorough_after=4))
def test_the_count_holds_together_with(name: str) -> None:
    for count in (6, 12):
        level = nested_cages(bell(), count, **WITH[name])[0]
        assert len(level.cage.vertices) <= count and len(level.cage.loops) < 5
        assert check(bell(), level, symmetry=WITH[name].get("symmetry"))
    if name == "grid":
        assert level.report.grid == 0.05 and level.report.lost.joined


@pytest.mark.slow
def test_the_count_holds_on_every_level() -> None:
    levels = nested_cages(bell(), [24, 10, 5])
    assert [len(level.cage.vertices) for level in levels] == [24, 10, 5] and check(bell(), levels)
    assert [len(level.cage.loops) for level in levels] == sorted(
        (len(each.cage.loops) for each in levels), reverse=True
    )


@pytest.mark.parametrize("angle", slow_after(0, [1.0, 0.3, 1.9, 2.8, 4.4], thorough_after=2))
def test_the_same_loops_are_chosen_at_any_angle(angle: float) -> None:
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    for fine, count in ((bell(), 16), (target(), 14)):
        plain, turned = (nested_cages(Mesh(x, fine.edges), count)[0] for x in (fine.vertices, fine.vertices @ turn))
        assert plain.report.lost == turned.report.lost
        assert plain.cage.area == pytest.approx(turned.cage.area, rel=0.03)


# All loops, or one


@pytest.mark.slow
def test_keep_is_the_promise_of_each_loop() -> None:
    with rejected("count.too_small", least=15):
        nested_cages(bell(), 14, loops="keep")
    level = nested_cages(bell(), 15, loops="keep")[0]
    assert [len(loop) for loop in level.cage.loops] == [3] * 5 and verify(level.cage, bell())
    many = nested_cages(bell(), 60)[0]
    assert many.cage == nested_cages(bell(), 60, loops="keep")[0].cage and not check(bell(), many).lost
    with rejected("setting.invalid"):
        Settings(loops="some")


@pytest.mark.parametrize("sides", slow_after(1, [5, 7, 12]))
def test_the_least_count_that_an_error_names_has_a_cage_and_one_less_has_none(sides: int) -> None:
    fine = Mesh.from_loops([radius * ring(sides) for radius in (1.0, 0.9, 0.8, 0.7)])
    with pytest.raises(NestedCagesError) as caught:
        nested_cages(fine, 12, loops="keep")
    least = caught.value.data["least"]
    assert caught.value.code == "count.too_small" and least > 12
    assert len(nested_cages(fine, least, loops="keep")[0].cage.vertices) == least
    with pytest.raises(NestedCagesError):
        nested_cages(fine, least - 1, loops="keep")


@pytest.mark.slow
def test_percentages_rise_to_the_least_count() -> None:
    fine = Mesh.from_loops([4.0 * ring(40), 3.9 * ring(40), 3.8 * ring(40)])  # triangles would cross each other
    level = nested_cages(fine, Share(0.02), loops="keep")[0]
    (data,) = (each.data for each in level.report.notes if each.data.get("on") == "least")
    assert data["asked"] == 4 < data["given"] == len(level.cage.vertices)
    with rejected("count.too_small", least=data["given"]):
        nested_cages(fine, 12, loops="keep")


def test_one_is_a_silhouette() -> None:
    for fine, least in ((bell(), polygon(bell()).convex_hull.area), (target(), np.pi * 4.0)):
        level = nested_cages(fine, 20, loops="one")[0]
        assert len(level.cage.loops) == 1 and verify(level.cage, fine, same_loops=False)
        assert level.cage.area < 1.05 * least
    with rejected("setting.conflict"):
        nested_cages(bell(), 20, loops="one", symmetry=mirror())


def test_without_shapely_holes_are_filled_and_parts_share_a_hull(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "shapely", None)
    assert nested_cages(PLATE, 8, clearance=1e-6)[0].cage.area == pytest.approx(91.0, rel=1e-4)
    level = nested_cages(bell(), 12)[0]
    assert len(level.cage.vertices) <= 12 and len(level.cage.loops) == 1 and check(bell(), level)


@pytest.mark.slow
def test_loops_are_kept_inside_and_around_meshes_of_ones_own() -> None:
    level = core.inner_cages(bell(), 15)[0]
    assert len(level.cage.loops) == 5 and verify(bell(), level.cage)
    rings = bell().rings[:2]
    own = Mesh.from_loops([1.05 * (each - each.mean(axis=0)) + each.mean(axis=0) for each in rings])
    assert len(nested_cages(Mesh.from_loops(rings), own)[0].cage.loops) == 2


def test_the_checker_and_the_certificate_name_alike_what_is_lost_and_see_what_is_left_out() -> None:
    cage = Mesh.from_loops([ring(40, 2.2), ring(20, 0.7) * (0.3, 1.0) + at(-1.05)])
    fine = Mesh.from_loops([ring(40, 2.0), ring(40, 1.5), ring(30, 0.6)])
    lost = verify(cage, fine, same_loops=False).lost
    assert (lost.filled, lost.joined) == ((), ((1, 2),)) and len(check(fine, cage, same_loops=False).lost) == 1
    for wrong in ([ring(20, 2.2), ring(20, 0.4)], [ring(20, 1.0)], [ring(20, 2.2), ring(20, 1.0)]):
        cage = Mesh.from_loops(wrong)
        assert not verify(cage, target(), same_loops=False) and not check(target(), cage, same_loops=False)


# Specks


def sprite() -> Mesh:
    """A disc with a small hole and eight specks around it."""
    places = 1.15 * np.stack([np.cos(0.7 * np.arange(8)), np.sin(0.7 * np.arange(8))], axis=1)
    return Mesh.from_loops([ring(60), 0.05 * ring(12) + 0.3, *(ring(5, 0.02) + place for place in places)])


def test_a_sprite_with_specks_gets_one_outline() -> None:
    fine = sprite()
    level = nested_cages(fine, 16, loops="one")[0]
    assert (len(level.cage.loops), len(level.cage.vertices)) == (1, 16) and level.excess < 0.15
    assert verify(level.cage, fine, level.report.clearance, same_loops=False) and "note.loops" in codes(level)
    assert (level.reinflation.fine_steps[-1] == fine.vertices).all()
    with rejected("count.too_small", least=30):
        nested_cages(fine, 16, loops="keep")
    few = nested_cages(islands(), Share(0.01))[0]
    assert len(few.cage.vertices) == 3


# Details that are nearly nothing


@pytest.mark.parametrize("size", slow_after(0, [1e-155, 1e-170, 1e-165], thorough_after=1))
def test_parts_too_small_to_tell_apart_lead_to_a_cage_or_an_error_with_a_code(size: float) -> None:
    tiny = [ring(6, size), ring(6, size, 0.0, (4.0 * size, 0.0)), ring(12, 1.0, 0.0, (3.0, 0.0))]
    for options in ({}, {"pins": [0]}, {"weights": np.arange(24) + 1.0}):
        try:
            assert nested_cages(Mesh.from_loops(tiny), 9, **options)[0].report.strict
        except NestedCagesError as error:
            assert error.code not in {"unknown", "solver.not_finite"}


def test_parts_that_are_flat_next_to_round_off_join_without_a_warning() -> None:
    loops = [[(-1.0, 1.0), (0.0, 0.0), (-1.0, 0.0)], [(0.0, 1.552746739039523e-151), (1.0, 0.0), (2.0, 0.0)]]
    with warnings.catch_warnings(), suppress(NestedCagesError):
        warnings.simplefilter("error")
        nested_cages(Mesh.from_loops(loops), 6)


# Families


@pytest.mark.parametrize("seed", slow_after(0, range(12), thorough_after=2))
def test_random_drawings_have_cages_of_any_count(seed: int) -> None:
    fine = drawing(300 + seed)
    for count in (3, 4, 9, 24):
        level = nested_cages(fine, count)[0]
        assert len(level.cage.vertices) <= count
        assert verify(level.cage, fine, level.report.wanted_clearance, same_loops=False)
    box = nested_cages(fine, 4, constraints=[AxisAligned()])[0]
    assert box.cage.area <= (1.0 + 1e-3) * float(np.prod(np.ptp(fine.vertices, axis=0)))
