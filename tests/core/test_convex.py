"""Convex cages: the least polygons there are, certified, apart from each other, and what does not go with them."""

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Level, Mesh, Mirror, NestingError, Rotation, Within, nested_cages
from support.families import simple, smallest_around
from support.judging import codes, gap, is_convex, is_on_grid, is_symmetric, rejected
from support.marks import slow_after
from support.shapes import annulus, disc, islands, letter_a, polygon, ring, star


def assert_convex_cage(level: Level, count: int, parts: int = 1) -> None:
    """Convex, certified, with so many vertices around each part, and apart from what it encloses."""
    cage, fine, clearance = level.cage, level.fine, level.report.wanted_clearance
    assert is_convex(cage) and [len(loop) for loop in cage.loops] == [count] * parts
    assert core.verify(cage, fine, clearance, same_loops=False) and polygon(cage).contains(polygon(fine))
    assert gap(cage, fine) >= clearance * (1.0 - 1e-6)
    assert np.array_equal(level.reinflation.cage_steps[0], level.coarse.vertices)


def cage_of(fine: Mesh, count: int, clearance: float = 1e-9) -> Level:
    return nested_cages(fine, count, convex=True, clearance=clearance)[0]


@pytest.mark.parametrize("count", slow_after(1, [3, 6, 4, 12], thorough_after=2))
def test_around_a_disc_the_regular_polygon_is_taken(count: int) -> None:
    level = cage_of(Mesh.from_loops([ring(160)]), count)
    assert_convex_cage(level, count)
    assert level.cage.area == pytest.approx(count * np.tan(np.pi / count), rel=2e-3)
    whole, solid = (cage_of(fine, count).cage.area for fine in (annulus(48), Mesh.from_loops([ring(48)])))
    assert whole == pytest.approx(solid)


def test_known_polygons() -> None:
    """A triangle around a parallelogram is twice as large; a heptagon is the smallest around itself."""
    slanted = Mesh.from_loops([[[0, 0], [3, 0], [4, 1], [1, 1]]])
    assert cage_of(slanted, 3).cage.area == pytest.approx(6.0, rel=1e-6)
    assert cage_of(slanted, 4).cage.area == pytest.approx(3.0, rel=1e-6)
    heptagon = Mesh.from_loops([ring(7)])
    assert cage_of(heptagon, 7).cage.area == pytest.approx(heptagon.area, rel=1e-6)


@pytest.mark.parametrize("seed", slow_after(1, range(12), thorough_after=3))
def test_as_small_as_the_best_of_all_choices_of_edges(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(24, 2)) * [1.0, rng.uniform(0.1, 1.0)]
    corners = shapely.get_coordinates(shapely.MultiPoint(points).convex_hull.exterior.normalize())[:-1][::-1]
    fine = Mesh.from_loops([corners])
    for count in range(3, min(6, len(corners)) + 1):
        best = smallest_around(fine.rings[0], count)
        assert cage_of(fine, count).cage.area <= best + 1e-3 * (best - fine.area) + 1e-6 * best


@pytest.mark.parametrize("seed", slow_after(1, range(40), thorough_after=4))
def test_every_edge_touches_the_shape(seed: int) -> None:
    """Most of them at their middle or along an edge; at the clearance."""
    rng = np.random.default_rng(seed)
    fine = simple(rng, 30, 31)
    fine = Mesh(fine.vertices * [1.0, rng.uniform(0.1, 1.0)], fine.edges)
    count, clearance = int(rng.integers(3, 9)), float(rng.choice([1e-7, 1e-3, 0.3]))
    level = cage_of(fine, count, clearance)
    assert_convex_cage(level, min(count, len(level.cage.vertices)))
    widened = polygon(fine).convex_hull.buffer(clearance, quad_segs=64)
    for start, end in level.cage.vertices[level.cage.edges]:
        assert shapely.LineString([start, end]).distance(widened) <= 1e-3 * clearance + 1e-5


def test_every_part_gets_its_own_on_each_level() -> None:
    level = cage_of(islands(), 5)
    assert_convex_cage(level, 5, parts=2)
    assert "note.loops" in codes(level)
    hierarchy = nested_cages(letter_a(), [10, 6, 4], convex=True)
    for level, count in zip(hierarchy, (10, 6, 4), strict=True):
        assert_convex_cage(level, count)
    assert hierarchy[1].fine is hierarchy[0].cage


@pytest.mark.parametrize(
    ("count", "angle"), slow_after(0, [(4, 0.5), (3, 0.0), (4, 0.0), (5, 1.0), (6, 0.8)], thorough_after=1)
)
def test_parts_close_to_each_other_keep_apart(count: int, angle: float) -> None:
    """Turned, some pairs overlap only once there are walls between others."""
    c, s = np.cos(angle), np.sin(angle)
    loops = ring(24), disc(24, 1.0, 2.05, 0.0), disc(20, 0.5, 1.025, 1.3)
    fine = Mesh.from_loops([loop @ np.array([[c, s], [-s, c]]) for loop in loops])
    assert_convex_cage(cage_of(fine, count, 1e-3), count, parts=3)


def test_parts_whose_polygons_would_overlap_have_one_together() -> None:
    """Also where only the clearance leaves no room; an error names them where loops are kept."""
    bay = [[0, 0], [5, 0], [5, 5], [4, 5], [4, 1], [1, 1], [1, 5], [0, 5]]
    reaching = Mesh.from_loops([bay, [[2, 2], [3, 2], [3, 3], [2, 3]]])
    for fine, count, clearance in (
        (reaching, 4, 1e-9),
        (Mesh.from_loops([ring(24), disc(24, 1.0, 2.05, 0.0)]), 6, 0.1),
    ):
        level = cage_of(fine, count, clearance)
        assert_convex_cage(level, count)
        assert level.report.lost.joined and "note.loops" in codes(level)
    with rejected("convex.overlapping", NestingError) as caught:
        nested_cages(reaching, 6, convex=True, loops="keep")
    assert sorted(caught.value.data["loops"]) == [0, 1]


def test_a_row_of_parts_is_joined_as_far_as_their_polygons_meet() -> None:
    """Two of three, also once the common hull of two reaches a further one, and with a mirror."""
    parts = [disc(24, 0.5, x, 0.0) for x in (-1.05, 1.05, 4.0)]
    (cage,) = nested_cages(parts, 6, convex=True, clearance=0.6).cages
    assert [len(loop) for loop in cage.loops] == [6, 6] and is_convex(cage)
    hat = [disc(24, 0.2, 0.0, 0.9), disc(24, 0.5, -1.0, 0.4), disc(24, 0.5, 1.0, 0.4)]
    (cage,) = nested_cages(hat, 6, convex=True, clearance=0.45, symmetry=Mirror()).cages
    assert len(cage.loops) == 1 and is_convex(cage) and is_symmetric(cage.vertices, Mirror())


def test_no_more_vertices_than_the_hull_has() -> None:
    level = cage_of(star(5, 60), 50)
    hull = polygon(star(5, 60)).convex_hull
    assert len(level.cage.vertices) == len(hull.exterior.coords) - 1 and "note.count" in codes(level)
    assert level.cage.area == pytest.approx(hull.area, rel=1e-6)


@pytest.mark.slow
def test_on_a_grid_and_within() -> None:
    for fine in (star(), islands()):
        for level in nested_cages(fine, [9, 5], convex=True, grid=0.05):
            assert_convex_cage(level, len(level.cage.loops[0]), len(level.cage.loops))
            assert is_on_grid(level.cage, 0.05)
    fine = star()
    level = nested_cages(fine, Within(excess=0.9), convex=True)[0]
    count = len(level.cage.vertices)
    assert level.cage.area <= 1.9 * fine.area < cage_of(fine, count - 1, 1e-5 * fine.diagonal).cage.area
    with rejected("tolerance.unreachable", NestingError):
        nested_cages(fine, Within(excess=0.01), convex=True)


def test_what_does_not_go_together() -> None:
    with rejected("convex.impossible"):
        core.inner_cages(star(5, 40), 6, convex=True)
    with rejected("count.too_small"):
        nested_cages(star(5, 40), 2, convex=True)
    with rejected("setting.conflict"):
        nested_cages(star(5, 40), Mesh.from_loops([ring(6, 3.0)]), convex=True)


@pytest.mark.slow
def test_symmetric_polygons_are_the_least_where_these_are_symmetric() -> None:
    """Of a shape with four rotations and mirrors, and in pairs next to an axis."""
    turn = 2.0 * np.pi * np.arange(120) / 120
    fine = Mesh.from_loops([ring(120) * (1.0 + 0.3 * np.cos(4.0 * turn))[:, None]])
    free = {count: cage_of(fine, count).excess for count in (8, 9)}
    mirrors = [Mirror((0.0, 0.0), along) for along in ((0.0, 1.0), (1.0, 1.0))]
    for symmetry in (Rotation((0.0, 0.0), 4), Rotation((0.0, 0.0), 2), *mirrors):
        for count in (8, 9):
            level = nested_cages(fine, count, convex=True, symmetry=symmetry, clearance=1e-9)[0]
            assert is_convex(level.cage) and is_symmetric(level.cage.vertices, symmetry)
            assert len(level.cage.vertices) <= count
            assert free[count] <= level.excess + 1e-9 <= free[8] * (1.0 + 1e-3)
    pair = nested_cages(disc(40, 0.5, 2.0, 0.0), 6, convex=True, symmetry=Mirror((1.0, 0.0)))[0]
    assert [len(loop) for loop in pair.cage.loops] == [6, 6]


@pytest.mark.slow
def test_weights_move_convex_cages() -> None:
    fine = Mesh.from_loops([ring(120)])
    weights = 1.0 + 99.0 * (fine.vertices[:, 0] > 0.5)
    heavy, light = nested_cages(fine, 5, convex=True, weights=weights).cages[0], cage_of(fine, 5).cage
    right = shapely.box(0.5, -9.0, 9.0, 9.0) - polygon(fine)
    assert is_convex(heavy) and heavy.area > light.area
    assert (polygon(heavy) & right).area < 0.5 * (polygon(light) & right).area


def test_polygons_do_not_depend_on_place_or_scale() -> None:
    fine = star(7, 60)
    area = nested_cages(fine, 5, convex=True)[0].cage.area
    for scale, place in ((1e-6, 0.0), (1e6, 1e7), (1.0, -500.0)):
        moved = nested_cages(Mesh(scale * fine.vertices + place, fine.edges), 5, convex=True)[0].cage.area
        assert moved == pytest.approx(scale**2 * area, rel=1e-5)
