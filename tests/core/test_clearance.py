"""Clearances up to the largest that a hole or a gap has room for, which shapely knows, and the error beyond."""

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh, NestedCagesError, NestingError, inner_cages, nested_cages, verify
from support.families import drawing
from support.judging import codes, gap, rejected
from support.marks import slow_after
from support.shapes import annulus, comb, letter_a, polygon, resampled, ring, star

NEARLY_ALL = 0.99
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def star_with_hole(seed: int) -> Mesh:
    random = np.random.default_rng(seed)
    radius = random.uniform(0.15, 0.6, (14, 1))
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, 14))
    return Mesh.from_loops([ring(64), radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)])


def bent_hole() -> Mesh:
    """The widest place of the hole is in its bend."""
    hole = [(-0.5, -0.5), (0.5, -0.5), (0.5, -0.3), (-0.3, -0.3), (-0.3, 0.5), (-0.5, 0.5)]
    return Mesh.from_loops([ring(4, 2.0), np.array(hole)])


def inradius(fine: Mesh) -> float:
    return float(shapely.maximum_inscribed_circle(shapely.Polygon(fine.rings[1]), 1e-7).length)


HOLES = {"ring": annulus(32, 0.22), "bent": bent_hole(), "star": star_with_hole(0), "other": star_with_hole(1)}


@pytest.mark.parametrize("name", slow_after(0, ["ring", "letter", "star"], thorough_after=1))
def test_the_cage_is_as_close_as_the_clearance_and_no_closer(name: str) -> None:
    fine = {"letter": letter_a(), "star": star(), "ring": annulus(60)}[name]
    for clearance in (0.0, 1e-6, 1e-3, 0.03):
        level = nested_cages(fine, 24, clearance=clearance)[0]
        distance = gap(level.cage, fine)
        assert clearance * (1.0 - 1e-9) <= distance <= max(1.01 * clearance, 1e-4)
        assert level.report.clearance == pytest.approx(distance, rel=1e-9)
        assert level.report.wanted_clearance == clearance or clearance == 0.0
    inner = inner_cages(fine, 24, clearance=0.01)[0]
    assert 0.01 * (1.0 - 1e-9) <= gap(fine, inner.cage) < 0.0101
    assert nested_cages(fine, 24)[0].report.wanted_clearance == pytest.approx(1e-5 * fine.diagonal)


def test_around_a_square_a_clearance_is_a_larger_square() -> None:
    """With four vertices; with more, corners are cut at the distance, at most as far as the round offset."""
    fine = Mesh.from_loops([SQUARE])
    for clearance in (1e-3, 0.1):
        for made, side in ((nested_cages, 1), (inner_cages, -1)):
            area = made(fine, 4, clearance=clearance)[0].cage.area
            assert area == pytest.approx((1 + 2 * side * clearance) ** 2, rel=1e-5)
    dense = resampled(fine, 32)
    for count, octagon in ((8, 2), (12, 3)):
        clearance, corner = 0.1, np.pi / 2 / octagon
        pieces = 4 * octagon * np.tan(corner / 2) * clearance**2  # a polygon of 4 * octagon edges around the circle
        best = 1.0 + 4.0 * clearance + pieces
        assert nested_cages(dense, count, clearance=clearance)[0].cage.area == pytest.approx(best, rel=1e-2)


@pytest.mark.parametrize("name", HOLES)
@pytest.mark.parametrize("share", slow_after(0, [0.99, 0.6], thorough_after=1))
def test_a_clearance_may_fill_a_hole_nearly(name: str, share: float) -> None:
    fine = HOLES[name]
    clearance = share * inradius(fine)
    level = nested_cages(fine, 10, clearance=clearance, loops="keep")[0]
    assert len(level.cage.loops) == 2 and verify(level.cage, fine, clearance)


@pytest.mark.parametrize("points", [[(0, 0), (2, 0), (1, 1)], star().vertices], ids=["triangle", "star"])
def test_a_clearance_may_fill_a_cage_inside_nearly(points: np.ndarray) -> None:
    fine = Mesh.of(points)
    clearance = NEARLY_ALL * float(shapely.maximum_inscribed_circle(polygon(fine), 1e-7).length)
    level = inner_cages(fine, 5, clearance=clearance)[0]
    assert verify(fine, level.cage, clearance)


@pytest.mark.parametrize("name", slow_after(1, ["bent", "ring", "star"], thorough_after=2))
def test_a_clearance_that_a_hole_has_no_room_for_is_refused_with_the_hole_and_the_largest(name: str) -> None:
    fine, hole = HOLES[name], shapely.Polygon(HOLES[name].rings[1])
    wanted = 1.05 * inradius(fine)
    with pytest.raises(NestingError) as caught:
        nested_cages(fine, 10, clearance=wanted, loops="keep")
    data = caught.value.data
    assert caught.value.code == "clearance.no_room"
    assert data["wanted"] == pytest.approx(wanted) and data["loops"] == (1,)
    assert data["largest"] == pytest.approx(inradius(fine), rel=1e-3)
    assert hole.contains(shapely.Point(data["place"]))
    assert hole.exterior.distance(shapely.Point(data["place"])) == pytest.approx(data["largest"], rel=1e-4)


@pytest.mark.parametrize(
    ("width", "part"),
    slow_after(0, [(0.1, "square"), (0.01, "disc"), (0.01, "square"), (0.1, "disc")], thorough_after=2),
)
def test_two_parts_share_the_gap_between_them(width: float, part: str) -> None:
    loop = ring(4, 1.0, np.pi / 4) if part == "square" else ring(40)
    fine = Mesh.from_loops([loop, loop + np.array([np.ptp(loop[:, 0]) + width, 0.0])])
    clearance = NEARLY_ALL * 0.5 * width
    assert verify(nested_cages(fine, 8, clearance=clearance, loops="keep")[0].cage, fine, clearance)
    for wanted in (0.5 * width, 0.6 * width):
        with rejected("clearance.no_room", NestingError) as caught:
            nested_cages(fine, 8, clearance=wanted, loops="keep")
        assert caught.value.data["loops"] == (0, 1)
        assert caught.value.data["largest"] == pytest.approx(0.5 * width, rel=1e-6)


@pytest.mark.slow
def test_an_island_shares_its_hole_and_close_rings_their_gap() -> None:
    fine = Mesh.from_loops([ring(40), ring(40, 0.6), ring(40, 0.3)])
    with rejected("clearance.no_room", NestingError) as caught:
        nested_cages(fine, 24, clearance=0.2, loops="keep")
    assert sorted(caught.value.data["loops"]) == [1, 2]
    assert caught.value.data["largest"] == pytest.approx(0.5 * gap_of(fine, 1, 2), rel=1e-6)
    rings = Mesh.from_loops([ring(60), 0.9 * ring(60), 0.8 * ring(60)])
    with rejected("clearance.no_room") as caught:
        nested_cages(rings, 9, clearance=0.06, loops="keep")
    assert caught.value.data["largest"] < 0.06


def gap_of(fine: Mesh, one: int, other: int) -> float:
    return float(shapely.LinearRing(fine.rings[one]).distance(shapely.LinearRing(fine.rings[other])))


@pytest.mark.slow
def test_too_few_vertices_are_told_from_too_little_room() -> None:
    """Between the island and its hole there is room for the clearance, but not for loops of eight vertices."""
    fine = Mesh.from_loops([ring(40), ring(40, 0.6), ring(40, 0.3)])
    with rejected("clearance.no_room", NestingError) as caught:
        nested_cages(fine, 24, clearance=0.14, loops="keep")
    assert not caught.value.data.get("loops")
    assert verify(nested_cages(fine, 60, clearance=0.14, loops="keep")[0].cage, fine, 0.14)


@pytest.mark.parametrize("width", slow_after(1, [1e-4, 0.01, 1e-6]))
def test_a_slit_within_one_loop_is_filled(width: float) -> None:
    fine = comb(1, width)
    level = nested_cages(fine, 16, clearance=0.02, loops="keep")[0]
    assert verify(level.cage, fine, 0.02) and level.cage.area < polygon(fine).buffer(0.02).area * 1.02


def test_gaps_narrower_than_the_default_have_their_cage_with_a_note() -> None:
    fine = Mesh.from_loops([SQUARE, SQUARE + np.array([1.0 + 1e-7, 0.0])])
    level = nested_cages(fine, 8, loops="keep")[0]
    assert len(level.cage.loops) == 2 and verify(level.cage, fine)
    assert 0.0 < level.report.clearance <= 0.5e-7 and "note.clearance" in codes(level)
    joined = nested_cages(fine, 4)[0]
    assert joined.cage.area == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize(("width", "clearance"), slow_after(0, [(0.05, 0.005), (0.1, 0.01)], thorough_after=1))
def test_a_level_leaves_room_for_the_next(width: float, clearance: float) -> None:
    """Two letters with serifs; alone, the first cage would have its two loops next to each other."""
    side = [(0.6, 0), (0.6, 0.08), (0.35, 0.12), (0.35, 1.3), (0.6, 1.4), (0.6, 1.5)]
    beam = np.array(side + [(0.6 - x, y) for x, y in reversed(side)])
    fine = Mesh.from_loops([beam, beam + np.array([0.6 + width, 0.0])])
    hierarchy = nested_cages(fine, [16, 10], clearance=clearance, loops="keep")
    assert all(verify(level.cage, level.fine, clearance) for level in hierarchy)
    assert gap_of(hierarchy[0].cage, 0, 1) >= 2.0 * clearance


@pytest.mark.parametrize("seed", slow_after(0, range(12), thorough_after=2))
def test_random_drawings_keep_any_clearance_or_say_why_not(seed: int) -> None:
    fine = drawing(500 + seed)
    for part in (1e-7, 1e-3, 0.02, 0.1):
        clearance = part * fine.diagonal
        try:
            level = nested_cages(fine, 12, clearance=clearance)[0]
        except NestedCagesError as error:
            assert error.code in {"clearance.no_room", "clearance.too_large", "certificate.failed", "count.too_small"}
            continue
        assert verify(level.cage, fine, clearance, same_loops=False)
