"""Levels within a distance or an excess, by shapely's buffers, near the lower bound where it is known."""

from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh, NestingError, Within, check, inner_cages, nested_cages, verify
from support.families import row, simple
from support.judging import codes, lies_within, note, rejected
from support.marks import slow_after
from support.shapes import annulus, letter_a, polygon, ring, star

SQUARE = Mesh.from_loops([[[0, 0], [4, 0], [4, 4], [0, 4]]])
CORNER = Mesh.from_loops([[[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6]]])
BOTTLE = Mesh.from_loops(
    [[[0, 0], [4, 0], [4, 4], [2.1, 4], [2.1, 3], [3, 3], [3, 1], [1, 1], [1, 3], [1.9, 3], [1.9, 4], [0, 4]]]
)
"""Its mouth is 0.2 wide, its inside 2 by 2, so the middle is 1 away from the glass."""


def ellipse(count: int = 120) -> Mesh:
    return Mesh.from_loops([ring(count) * [3.0, 1.0]])


def farthest(cage: Mesh, fine: Mesh, step: float) -> float:
    """The distance of the farthest of samples of a cage's solid from a shape: a lower bound of that of the solid."""
    left = polygon(cage).difference(polygon(fine))
    low_x, low_y, high_x, high_y = left.bounds
    places = np.stack(np.meshgrid(np.arange(low_x, high_x, step), np.arange(low_y, high_y, step)), axis=-1).reshape(
        -1, 2
    )
    points = shapely.points(np.concatenate([places, cage.vertices]))
    inside = points[shapely.intersects(left, points)]
    return float(shapely.distance([*inside, *shapely.points(cage.vertices)], polygon(fine)).max())


@pytest.mark.parametrize("distance", slow_after(0, [0.2, 0.03]))
def test_around_a_disc_the_bound_and_the_cage_are_the_regular_polygon(distance: float) -> None:
    fine = Mesh.from_loops([ring(720)])
    least = int(np.ceil(np.pi / np.arccos(1.0 / (1.0 + distance))))
    level = nested_cages(fine, Within(distance=distance))[0]
    assert least - 1 <= level.report.fewest <= least <= len(level.cage.vertices) <= least + 1
    assert lies_within(level.cage, fine, distance) and check(fine, level, distance=distance)


@pytest.mark.parametrize(
    ("fine", "distance", "count"),
    [(SQUARE, 1.0, 4), (SQUARE, 4.0, 3), (CORNER, 0.1, 6), (CORNER, 3.0, 5), (BOTTLE, 0.9, 5), (BOTTLE, 1.1, 4)],
    ids=["square", "triangle", "corner", "cut corner", "bottle", "lid"],
)
def test_corridors_by_hand(fine: Mesh, distance: float, count: int) -> None:
    """A square, a triangle around it where that is near enough; a bay is filled where its widest place is."""
    level = nested_cages(fine, Within(distance=distance))[0]
    found = len(level.cage.vertices)
    assert lies_within(level.cage, fine, distance) and level.report.fewest <= found
    if fine is BOTTLE:
        assert (found == count) if count == 4 else found >= count
    else:
        assert found <= count if distance == 3.0 else found == count == level.report.fewest
    assert note(level, "note.tolerance").data["count"] == found


@pytest.mark.parametrize("distance", slow_after(0, [0.1, 0.3, 0.03], thorough_after=1))
@pytest.mark.parametrize("fine", [star(5, 200), letter_a(), annulus(60), ellipse()])
def test_where_outlines_turn_inwards_too(fine: Mesh, distance: float) -> None:
    """Within one vertex per loop of the bound, and inside of the offset."""
    level = nested_cages(fine, Within(distance=distance))[0]
    count, bound = len(level.cage.vertices), level.report.fewest
    assert bound <= count <= bound + len(fine.loops)
    assert verify(level.cage, fine, level.report.wanted_clearance) and lies_within(level.cage, fine, distance)


@pytest.mark.parametrize("seed", slow_after(1, range(12), thorough_after=3))
def test_the_bound_undercuts_every_cage_that_is_as_near(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = simple(random, 15, 40)
    cage = nested_cages(fine, int(random.integers(5, 14)))[0].cage
    near = farthest(cage, fine, 0.02) + 0.02
    level = nested_cages(fine, Within(distance=near))[0]
    assert level.report.fewest <= len(cage.vertices) and len(level.cage.vertices) <= len(cage.vertices) + 1
    assert codes(level) == ["note.tolerance"]  # tightened, at the default clearance


def around(count: int) -> float:
    """Area of the least polygon of so many edges around the unit circle."""
    return float(count * np.tan(np.pi / count))


def within(count: int) -> float:
    """Area of the largest polygon of so many corners in the unit circle."""
    return float(0.5 * count * np.sin(2.0 * np.pi / count))


@pytest.mark.parametrize("made", [nested_cages, inner_cages], ids=["around", "inside"])
@pytest.mark.parametrize("count", slow_after(0, [5, 4, 7, 11], thorough_after=2))
def test_in_and_around_a_disc_the_fewest_are_those_of_the_regular_polygons(made: Any, count: int) -> None:
    """By an excess and a distance that this many vertices keep, and one less don't."""
    fine, both, outside = Mesh.from_loops([ring(120)]), (count - 1, count), made is nested_cages
    shares = [abs((around if outside else within)(k) / fine.area - 1.0) for k in both]
    level = made(fine, Within(excess=float(np.mean(shares))))[0]
    assert len(level.cage.vertices) == count and abs(level.excess) == pytest.approx(shares[1], abs=1e-2)
    far = [1.0 / np.cos(np.pi / k) - 1.0 if outside else 1.0 - np.cos(np.pi / k) for k in both]
    level = made(fine, Within(distance=float(np.mean(far))))[0]
    assert count <= len(level.cage.vertices) <= count + (not outside)  # the largest area does not reach the least


@pytest.mark.parametrize("made", [nested_cages, inner_cages], ids=["around", "inside"])
@pytest.mark.parametrize(("size", "excess"), slow_after(0, [(100, 0.2), (100, 0.05), (40, 0.1)]))
def test_with_one_vertex_less_the_excess_is_larger(made: Any, size: int, excess: float) -> None:
    fine = star(5, size)
    level = made(fine, Within(excess=excess))[0]
    assert abs(level.excess) <= excess and level.report.fewest is None
    assert abs(made(fine, len(level.cage.vertices) - 1)[0].excess) > excess
    data = note(level, "note.tolerance").data
    assert (data["limit"], data["on"]) == (excess, "excess") and data["taken"] == pytest.approx(abs(level.excess))


@pytest.mark.parametrize(("seed", "share"), slow_after(1, [(47, 0.0336), (17, 0.003746)]))
def test_with_one_vertex_less_a_cage_goes_too_far(seed: int, share: float) -> None:
    """Around rows of squares and discs, whose first polygons have many more vertices than the bound."""
    fine = row(np.random.default_rng(seed))
    cage = nested_cages(fine, Within(distance=share * fine.diagonal), loops="keep")[0].cage
    less = nested_cages(fine, len(cage.vertices) - 1, loops="keep")[0].cage
    assert [lies_within(each, fine, share * fine.diagonal) for each in (cage, less)] == [True, False]


@pytest.mark.slow
def test_cages_inside_are_near_too() -> None:
    fine = star(5)
    level = inner_cages(fine, Within(distance=0.1))[0]
    assert lies_within(fine, level.cage, 0.1) and level.report.fewest is None
    assert not lies_within(fine, inner_cages(fine, len(level.cage.vertices) - 1)[0].cage, 0.1)


@pytest.mark.parametrize("seed", slow_after(0, range(6), thorough_after=2))
def test_the_distance_that_a_note_has_is_that_of_the_farthest_point(seed: int) -> None:
    """Around bays and two loops too; a sample is at most half the diagonal of a cell from the farthest place."""
    random = np.random.default_rng(seed)
    outline = ring(60) * random.uniform(random.uniform(0.3, 0.9), 1.0, size=(60, 1))
    fine, limit, step = Mesh.from_loops([outline, 0.2 * ring(12)]), float(random.uniform(0.05, 0.3)), 0.01
    level = nested_cages(fine, Within(distance=limit))[0]
    taken = note(level, "note.tolerance").data["taken"]
    sampled = farthest(level.cage, fine, step)
    assert sampled <= taken <= limit and taken <= (sampled + step) * 1.01
    assert check(fine, level, distance=taken) and not check(fine, level, distance=0.99 * (sampled - 1e-9))


@pytest.mark.parametrize("seed", slow_after(1, [20, 6, 18, 22]))
def test_what_is_measured_bounds_the_distance_of_every_point(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = simple(random, 8, 40)
    cage = nested_cages(fine, int(random.integers(4, 16)))[0].cage
    taken = Within(distance=1.0).measured(cage, fine)
    assert check(fine, cage, distance=taken) and not check(fine, cage, distance=0.99 * taken)


@pytest.mark.slow
def test_the_inside_of_a_shape_is_at_no_distance() -> None:
    """One side has many vertices, so the middle of the square is farther from its outline than a usual edge is long."""
    side = np.linspace(0.0, 10.0, 100, endpoint=False)
    fine = Mesh.from_loops([[*np.column_stack([side, 0.0 * side]), [10, 0], [10, 10], [0, 10]]])
    level = nested_cages(fine, Within(distance=0.5))[0]
    assert len(level.cage.vertices) == 4 and note(level, "note.tolerance").data["taken"] <= 0.5


def test_all_bays_that_are_too_wide_are_followed() -> None:
    """Behind mouths of 0.2: one 2 wide, one 0.5, which may be filled at a distance of 0.3 and not at 0.2."""
    walls = [[0, 0], [9, 0], [9, 4], [7.1, 4], [7.1, 3], [7.25, 3], [7.25, 2], [6.75, 2], [6.75, 3], [6.9, 3], [6.9, 4]]
    bays = [*walls, [2.1, 4], [2.1, 3], [3, 3], [3, 1], [1, 1], [1, 3], [1.9, 3], [1.9, 4], [0, 4]]
    fine = Mesh.from_loops([bays])
    one, both = (nested_cages(fine, Within(distance=distance))[0] for distance in (0.3, 0.2))
    middles = shapely.Point(7.0, 2.5), shapely.Point(2.0, 2.0)
    assert [polygon(one.cage).contains(middle) for middle in middles] == [True, False]
    assert [polygon(both.cage).contains(middle) for middle in middles] == [False, False]
    assert lies_within(one.cage, fine, 0.3) and lies_within(both.cage, fine, 0.2)


@pytest.mark.slow
def test_a_hole_smaller_than_the_distance() -> None:
    """In an outline around which the first polygon goes too far; the cage is not tightened beyond the distance."""
    angle = 2.0 * np.pi * np.arange(400) / 400
    radius = 1.0 + 0.1 * np.cos(7.0 * angle) + 0.06 * np.cos(23.0 * angle + 1.0) + 0.02 * np.cos(41.0 * angle)
    fine = Mesh.from_loops([ring(400) * radius[:, None], 0.01 * ring(8)])
    distance = 0.01 * fine.diagonal
    level = nested_cages(fine, Within(distance=distance))[0]
    assert lies_within(level.cage, fine, distance)
    assert level.report.fewest - 3 <= len(level.cage.vertices) <= level.report.fewest + 4


@pytest.mark.slow
def test_holes_and_levels() -> None:
    fine = annulus(48)
    hierarchy = nested_cages(fine, [Within(distance=0.05), Within(excess=0.4), 6])
    counts = [len(cage.vertices) for cage in hierarchy.cages]
    assert counts == sorted(counts, reverse=True)
    assert lies_within(hierarchy.cages[0], fine, 0.05) and counts[0] <= hierarchy[0].report.fewest + 2
    assert hierarchy.cages[1].area / fine.area - 1.0 <= 0.4 and verify(hierarchy.cages[1], hierarchy.cages[0])


@pytest.mark.slow
def test_a_level_near_another_mesh_than_the_one_inside() -> None:
    fine, inner = ellipse(60), nested_cages(ellipse(60), 24).cages[0]
    level = nested_cages(inner, Within(distance=0.2), about=fine)[0]
    assert verify(level.cage, inner) and lies_within(level.cage, fine, 0.2)
    own = nested_cages(inner, Within(distance=0.2))[0]
    assert farthest(level.cage, fine, 0.05) <= 0.2 and own.report.fewest <= level.report.fewest
    for make in (
        lambda: nested_cages(inner, Within(distance=0.2), about=level.cage),
        lambda: inner_cages(fine, 12, about=inner_cages(fine, 24).cages[0]),
    ):
        with rejected("coarse.not_nested", NestingError):
            make()
