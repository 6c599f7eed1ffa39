"""Levels within a distance or an excess: certified by shapely's buffers too, near the lower bound where shapes are
convex."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import Mesh, NestedCagesError, NestingError, Settings, Within, inner_cages, nested_cages, verify
from nestedcages_core.cache import forget
from nestedcages_core.hierarchy import Share, level_words, parse_level, wanted_levels
from nestedcages_core.tasks import drain
from nestedcages_core.tolerance import reach as reaches
from nestedcages_core.tolerance.fewest import _CountSearch
from nestedcages_core.tolerance.minimal_nested import Band
from nestedcages_core.tolerance.reach import REACH_PRECISION, beyond, reach, stays_within
from support.marks import slow_after
from support.shapes import annulus, letter_a, polygon, ring, star

slow = pytest.mark.slow

FINE_BUFFER = 256
"""Segments of a quarter circle of shapely's buffers."""


def ellipse(count: int = 120) -> Mesh:
    return Mesh.from_loops([ring(count) * [3.0, 1.0]])


def within_by_shapely(cage: Mesh, fine: Mesh, distance: float) -> bool:
    # a circle of chords is short of the circle by its sagitta
    return polygon(fine).buffer(distance * (1.0 + 1e-4), quad_segs=FINE_BUFFER).contains(polygon(cage))


@slow
@pytest.mark.parametrize("distance", [0.2, 0.03])
def test_the_bound_of_a_disc_is_the_regular_polygon(distance: float) -> None:
    fine = Mesh.from_loops([ring(720)])
    least = int(np.ceil(np.pi / np.arccos(1.0 / (1.0 + distance))))
    bound = Band(fine, 0, distance).fewest_links(0.0)
    assert least - 1 <= bound <= least
    assert min(map(len, Band(fine, 0, distance).walks(0.0))) - 1 <= least


@slow
@pytest.mark.parametrize("distance", [0.3, 0.1])
def test_a_convex_shape_ends_within_one_vertex_of_the_bound(distance: float) -> None:
    fine = ellipse()
    level = nested_cages(fine, [Within(distance=distance)]).levels[0]
    count, bound = len(level.cage.vertices), level.report.fewest
    assert bound <= count <= bound + 1
    assert verify(level.cage, fine, level.report.wanted_clearance)
    assert within_by_shapely(level.cage, fine, distance)
    assert reach(level.cage, fine) <= distance
    assert f"{count} vertices" in level.report.notes[-1]
    assert np.array_equal(level.reinflation.cage_steps[-1], level.cage.vertices)


@slow
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_the_bound_undercuts_cages_of_random_shapes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = int(rng.integers(15, 50))
    fine = Mesh.from_loops([ring(corners) * rng.uniform(rng.uniform(0.3, 0.9), 1.0, size=(corners, 1))])
    cage = nested_cages(fine, [int(rng.integers(4, corners))]).levels[0].cage
    assert Band(fine, 0, reach(cage, fine)).fewest_links(0.0) <= len(cage.vertices)


@pytest.mark.parametrize("distance", slow_after(0, [0.1, 0.3, 0.03], thorough_after=1))
@pytest.mark.parametrize("fine", [star(5, 200), letter_a(), annulus(60)])
def test_where_outlines_turn_inwards_too(fine: Mesh, distance: float) -> None:
    """Within one vertex per loop of the bound, and inside of the offset."""
    level = nested_cages(fine, [Within(distance=distance)]).levels[0]
    count, bound = len(level.cage.vertices), level.report.fewest
    assert bound <= count <= bound + len(fine.loops)
    assert verify(level.cage, fine, level.report.wanted_clearance)
    assert within_by_shapely(level.cage, fine, distance)


@slow
def test_a_corridor_by_hand() -> None:
    """Around a square with gates of length 1 on its sides: the square itself is possible, a triangle is not."""
    square = Mesh.from_loops([[[0, 0], [4, 0], [4, 4], [0, 4]]])
    assert Band(square, 0, 1.0).fewest_links(0.0) == 4
    assert min(map(len, Band(square, 0, 1.0).walks(0.0))) == 4
    assert Band(square, 0, 4.0).fewest_links(0.0) == 3
    # an L needs its inner corner where the distance is too small to fill it
    corner = Mesh.from_loops([[[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6]]])
    assert Band(corner, 0, 0.1).fewest_links(0.0) == 6
    assert min(map(len, Band(corner, 0, 0.1).walks(0.0))) == 6
    assert Band(corner, 0, 3.0).fewest_links(0.0) < 6


@slow
def test_holes_and_levels() -> None:
    fine = annulus(48)
    hierarchy = nested_cages(fine, [Within(distance=0.05), Within(excess=0.4), 6])
    counts = [len(cage.vertices) for cage in hierarchy.cages]
    assert counts == sorted(counts, reverse=True)
    first, second, _ = hierarchy.levels
    assert within_by_shapely(first.cage, fine, 0.05)
    assert first.report.fewest <= counts[0] <= first.report.fewest + 2
    assert second.cage.area / fine.area - 1.0 <= 0.4
    assert second.report.fewest is None
    assert verify(second.cage, first.cage)


def test_a_filled_bay_counts_with_its_widest_place() -> None:
    """A bottle: its mouth is 0.2 wide, its inside 2 by 2, so the middle is 1 away from the glass."""
    bottle = Mesh.from_loops(
        [[[0, 0], [4, 0], [4, 4], [2.1, 4], [2.1, 3], [3, 3], [3, 1], [1, 1], [1, 3], [1.9, 3], [1.9, 4], [0, 4]]]
    )
    lid = Mesh.from_loops([[[-0.01, -0.01], [4.01, -0.01], [4.01, 4.01], [-0.01, 4.01]]])
    measured = reach(lid, bottle)
    assert measured == pytest.approx(np.hypot(1.0, 0.0), rel=0.05)
    assert not stays_within(lid, bottle, 0.9)
    assert stays_within(lid, bottle, measured * (1.0 + 2.0 * REACH_PRECISION))


SQUARE = Mesh.from_loops([[[0, 0], [4, 0], [4, 4], [0, 4]]])
AROUND = Mesh.from_loops([[[-0.3, -0.3], [4.3, -0.3], [4.4, 4.4], [-0.3, 4.3]]])


def test_the_inside_of_a_shape_is_at_no_distance() -> None:
    """One side has many vertices, so the middle of the square is farther from its outline than a usual edge is long."""
    side = np.linspace(0.0, 10.0, 100, endpoint=False)
    fine = Mesh.from_loops([[*np.column_stack([side, 0.0 * side]), [10, 0], [10, 10], [0, 10]]])
    cage = Mesh.from_loops([[[-1, -1], [11, -1], [11, 11], [-1, 11]]])
    assert np.sqrt(2.0) <= reach(cage, fine) <= np.sqrt(2.0) * (1.0 + 1.01 * REACH_PRECISION)
    assert sorted(beyond(cage, fine, 1.2, np.inf)[1].tolist()) == sorted(cage.vertices.tolist())
    assert len(beyond(cage, fine, 1.42, np.inf)[1]) == 0
    lower = cage.moved(cage.vertices - [[0, 2], [0, 0], [0, 0], [0, 0]])
    assert beyond(lower, fine, 2.0, np.inf)[1].tolist() == [[-1.0, -3.0]]  # what is near it is left out


def test_places_that_are_too_far_are_found_in_all_bays() -> None:
    """Two bays behind mouths of 0.2: one 2 wide, one 0.5, which takes more halvings to find."""
    walls = [[0, 0], [9, 0], [9, 4], [7.1, 4], [7.1, 3], [7.25, 3], [7.25, 2], [6.75, 2], [6.75, 3], [6.9, 3], [6.9, 4]]
    bays = [*walls, [2.1, 4], [2.1, 3], [3, 3], [3, 1], [1, 1], [1, 3], [1.9, 3], [1.9, 4], [0, 4]]
    lid = Mesh.from_loops([[[-0.01, -0.01], [9.01, -0.01], [9.01, 4.01], [-0.01, 4.01]]])
    taken, places = beyond(lid, Mesh.from_loops([bays]), 0.2, np.inf)
    assert taken > 0.2
    assert {bool(x > 5.0) for x, _ in places} == {False, True}
    outline = shapely.Polygon(bays)
    assert all(outline.distance(shapely.Point(place)) > 0.2 for place in places)
    alone = beyond(lid, Mesh.from_loops([bays]), 0.9, np.inf)[1]
    assert len(alone) > 0
    assert (alone[:, 0] < 5.0).all()


def test_no_cage_within_a_distance_is_measured_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even after a round trip to the units of the solvers, nor to tell what the best one takes."""
    fine = star(7)
    distance, within = 0.01 * fine.diagonal, []

    def counted(*arguments: Any, **options: Any) -> tuple[float, Any]:
        taken, places = measure(*arguments, **options)
        if len(places) == 0:
            within.append(arguments[0].vertices)
        return taken, places

    measure = reaches._reach
    monkeypatch.setattr(reaches, "_reach", counted)
    forget()
    report = nested_cages(fine, [Within(distance=distance)]).levels[0].report
    assert len(within) > 0
    for k, one in enumerate(within):
        assert not any(one.shape == other.shape and np.allclose(one, other, atol=1e-7) for other in within[:k])
    assert 0.0 < report.notes[-1].data["taken"] <= distance


def test_what_is_measured_is_compared_with_the_limit() -> None:
    """The distance of a corner, and the excess of areas."""
    distance, excess = np.hypot(0.4, 0.4), AROUND.area / 16.0 - 1.0
    assert distance <= reach(AROUND, SQUARE) <= distance * (1.0 + 1.01 * REACH_PRECISION)
    assert Within(distance=0.7).limit == 0.7
    assert Within(excess=0.7).limit == 0.7
    assert Within(distance=1.0).measured(AROUND, SQUARE) == reach(AROUND, SQUARE)
    assert Within(excess=1.0).measured(AROUND, SQUARE) == excess
    for size in (0.999, 1.001):
        assert stays_within(AROUND, SQUARE, distance * size) == (size > 1.0)
        assert Within(distance=distance * size).is_met(AROUND, SQUARE) == (size > 1.0)
    assert Within(excess=excess).is_met(AROUND, SQUARE)
    assert not Within(excess=np.nextafter(excess, 0.0)).is_met(AROUND, SQUARE)
    notes = Within(excess=0.5).note(9, 0.4), Within(distance=0.5).note(9, 0.4), Within(distance=0.5).note(9, 0.4, 8)
    assert [each.data["on"] for each in notes] == ["excess", "distance", "bounded"]
    assert str(Within(distance=0.5)) == "within a distance of 0.5"
    assert str(Within(excess=0.25)) == "within an excess of 25 %"


def polygons_around(count: int) -> float:
    """Area of the least polygon of so many edges around the unit circle."""
    return count * np.tan(np.pi / count)


def polygons_within(count: int) -> float:
    """Area of the largest polygon of so many corners in the unit circle."""
    return 0.5 * count * np.sin(2.0 * np.pi / count)


@pytest.mark.parametrize("count", slow_after(1, [5, 4, 7, 11]))
def test_the_fewest_vertices_around_and_within_a_disc_are_those_of_the_regular_polygons(count: int) -> None:
    """By an excess and a distance that this many vertices keep, and one less don't."""
    fine = Mesh.from_loops([ring(120)])
    around, within = ([area(n) / fine.area for n in (count - 1, count)] for area in (polygons_around, polygons_within))
    far = [1.0 / np.cos(np.pi / n) - 1.0 for n in (count - 1, count)]
    deep = [1.0 - np.cos(np.pi / n) for n in (count - 1, count)]
    for make, limit in (
        (nested_cages, {"excess": np.mean(around) - 1.0}),
        (nested_cages, {"distance": np.mean(far)}),
        (inner_cages, {"excess": 1.0 - np.mean(within)}),
        (inner_cages, {"distance": np.mean(deep)}),
    ):
        level = make(fine, Within(**limit))[0]
        more = make is inner_cages and "distance" in limit  # the largest area does not reach the least distance
        assert count <= len(level.cage.vertices) <= count + more, (make, limit)
        if "excess" in limit:
            assert level.excess == pytest.approx((around if make is nested_cages else within)[1] - 1.0, abs=1e-2)


@pytest.mark.parametrize("known", [None, 38, 12])
@pytest.mark.parametrize("seed", range(4))
def test_the_search_finds_the_least_count_that_keeps_the_tolerance(seed: int, known: int | None) -> None:
    """Cages of any excess, less for each vertex more, after none or one of a known count: all counts below fail."""
    fine, limit = Mesh.from_loops([ring(40)]), 0.3
    random = np.random.default_rng(seed)
    excess = dict(enumerate(np.sort(random.uniform(0.0, 4.0 * limit, 38))[::-1], start=3))
    excess[40] = 0.5 * limit
    tried: list[int] = []

    def level_of(count: int) -> Any:
        size = np.sqrt((1.0 + excess[count]) * fine.area / Mesh.from_loops([ring(count)]).area)
        return SimpleNamespace(cage=Mesh.from_loops([size * ring(count)]))

    def build(count: int) -> Any:
        tried.append(count)
        return level_of(count)
        yield

    plan = SimpleNamespace(side=1, number=lambda mesh: len(mesh.vertices), is_free=False)
    plan.outline = SimpleNamespace(per_loop=False)
    decimation = SimpleNamespace(decimation=None)
    search = _CountSearch(
        Within(excess=limit), fine, SimpleNamespace(fine=fine, plan=plan, settings=decimation, build=build)
    )
    least = next(count for count in sorted(excess) if excess[count] <= limit)
    if known is not None:
        search.best = level_of(max(known, least))
    drain(search.try_counts())
    assert len(search.best.cage.vertices) == least
    assert len(tried) <= 14 and len(set(tried)) == len(tried)


WRONG = [{}, {"distance": 1.0, "excess": 1.0}]
WRONG += [{name: value} for name in ("distance", "excess") for value in (-1.0, 0.0, np.nan, np.inf, -np.inf, "2", True)]


@pytest.mark.parametrize("wrong", WRONG, ids=str)
def test_wrong_limits_are_rejected(wrong: dict[str, Any]) -> None:
    with pytest.raises(
        NestedCagesError, match="Within needs either" if len(wrong) != 1 else "Within: a .*number above 0"
    ):
        Within(**wrong)


@slow
def test_an_impossible_excess_is_said() -> None:
    with pytest.raises(NestingError, match="ask for more"):
        nested_cages(ellipse(40), [Within(excess=1e-9)])


@slow
@pytest.mark.parametrize("need", [Within(distance=0.1), Within(excess=0.2)], ids=str)
def test_inner_cages_within_a_tolerance(need: Within) -> None:
    fine = star(5)
    (level,) = inner_cages(fine, [need]).levels
    taken = reach(fine, level.cage) if need.distance is not None else -level.report.excess
    assert taken <= need.limit
    assert level.report.fewest is None  # the bound is for cages around
    with_one_less = inner_cages(fine, [len(level.cage.vertices) - 1]).levels[0]
    assert (reach(fine, with_one_less.cage) if need.distance is not None else -with_one_less.report.excess) > need.limit


def test_a_hole_smaller_than_the_distance() -> None:
    """In an outline around which the first polygon goes too far; the cage is not tightened beyond the distance."""
    angle = 2.0 * np.pi * np.arange(400) / 400
    radius = 1.0 + 0.1 * np.cos(7.0 * angle) + 0.06 * np.cos(23.0 * angle + 1.0) + 0.02 * np.cos(41.0 * angle)
    fine = Mesh.from_loops([ring(400) * radius[:, None], 0.01 * ring(8)])
    distance = 0.01 * fine.diagonal
    (level,) = nested_cages(fine, [Within(distance=distance)]).levels
    assert within_by_shapely(level.cage, fine, distance) and stays_within(level.cage, fine, distance)
    assert level.report.fewest <= len(level.cage.vertices) <= level.report.fewest + 4


def test_levels_as_people_write_them() -> None:
    texts = ("32, 8 %; 2 px, 0.5u + 25 %", "32 8% 2px .5U +25%", "32,8%,2PX,5e-1 u,+25 %")
    for text in texts:
        levels = [parse_level(word) for word in level_words(text)]
        assert wanted_levels(levels, annulus(48)) == [
            32, 8, Within(distance=2.0), Within(distance=0.5), Within(excess=0.25)
        ]  # fmt: skip
    assert level_words("2 m 3 mm 4m", {"m": 1.0, "mm": 1e-3}) == ["2m", "3mm", "4m"]
    assert level_words("2,5 px 0,5% +1,5% 64,24,8%") == ["2.5px", "0.5%", "+1.5%", "64", "24", "8%"]
    with pytest.raises(NestedCagesError, match="may be one level or two; write 12"):
        parse_level(*level_words("12,5 %"))
    assert parse_level("3mm", {"m": 1.0, "mm": 1e-3}) == Within(distance=0.003)
    for word in ("0", "2.5", "+25", "-2px", "px", "+%", "+3px", "nan", "infpx", "101%", "2m", "1e3", "+", "0px", "."):
        with pytest.raises(NestedCagesError, match=r"such as 2px, or more area such as \+25%;"):
            parse_level(word)
    with pytest.raises(NestedCagesError, match="a distance such as 2m, or"):
        parse_level("x", {"m": 1.0})


@slow
def test_percentages_rise_to_the_least() -> None:
    fine = Mesh.from_loops([4.0 * ring(40), 3.9 * ring(40), 3.8 * ring(40)])  # triangles would cross each other
    level, alike = (
        nested_cages(fine, given, loops="keep").levels[0] for given in (Share(0.02), wanted_levels([Share(0.02)], fine))
    )
    (note,) = (note for note in level.report.notes if note.data.get("on") == "least")
    assert note.data["asked"] == 4 < note.data["given"] == len(level.cage.vertices) == len(alike.cage.vertices)
    assert f"the cage has {note.data['given']}" in note
    with pytest.raises(NestingError, match=f"ask for at least {note.data['given']}"):
        nested_cages(fine, [12], loops="keep")


@slow
def test_a_level_near_another_mesh_than_the_one_inside() -> None:
    fine, inner = ellipse(60), nested_cages(ellipse(60), [24]).cages[0]
    (level,) = nested_cages(inner, [Within(distance=0.2)], Settings(about=fine)).levels
    assert verify(level.cage, inner)
    assert reach(level.cage, fine) <= 0.2
    assert reach(inner, fine) < reach(level.cage, fine)
    with pytest.raises(NestingError, match="does not lie in the fine one"):
        nested_cages(inner, [Within(distance=0.2)], Settings(about=level.cage))
    with pytest.raises(NestingError, match="does not lie around the fine one"):
        inner_cages(fine, [12], Settings(about=inner_cages(fine, [24]).cages[0]))
    with pytest.raises(NestedCagesError, match="about must be a Mesh, not str"):
        Settings(about="fine")  # type: ignore[arg-type]


@slow
@settings(max_examples=3, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_reaches_are_those_of_samples(seed: int) -> None:
    """Around bays and two loops too; a sample is at most half the diagonal of a cell from the farthest place."""
    rng = np.random.default_rng(seed)
    outline = ring(60) * rng.uniform(rng.uniform(0.3, 0.9), 1.0, size=(60, 1))
    fine = Mesh.from_loops([outline, 0.2 * ring(12)])
    cage = nested_cages(fine, [int(rng.integers(10, 40))]).levels[0].cage
    found, step = reach(cage, fine), 0.01
    axis = np.arange(-3.0, 3.0, step)
    points = shapely.points(*np.meshgrid(axis, axis))
    inside = points[shapely.contains(polygon(cage), points)]
    sampled = shapely.distance([*inside, *shapely.points(cage.vertices)], polygon(fine)).max()  # tips are thin
    assert sampled <= found <= (sampled + step) * (1.0 + REACH_PRECISION)
    for size in (0.999, 1.001):
        assert stays_within(cage, fine, size * found) == (size > 1.0)
