"""The outer hull as a decimation of its own: strictly around the shape, with exactly so many vertices."""

import numpy as np
import pytest

from nestedcages_core import Mesh, NestingError, OuterHull, verify
from support.judging import gap
from support.marks import slow_after
from support.shapes import annulus, assert_nested, islands, letter_a, polygon, ring, star

SHAPES = {"letter": letter_a(), "star": star(), "islands": islands(), "ring": annulus(40)}
AREAS = {"letter": (1.0429, 1.2408), "star": (1.0377, 1.2908), "islands": (1.1424, 2.1288), "ring": (1.0129, 1.0874)}
"""In areas of the shape, with 40 vertices and with 18."""
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def beside(x: float) -> np.ndarray:
    return np.array([x, 0.0])


def hull(fine: Mesh, count: object, clearance: float = 0.0) -> Mesh:
    return OuterHull().decimate(fine, count, clearance=clearance)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", slow_after(1, SHAPES))
def test_it_encloses_strictly_with_exactly_the_vertices_asked_for(name: str) -> None:
    fine = SHAPES[name]
    clearance = 1e-5 * fine.diagonal
    for count in (40, 18):
        coarse = hull(fine, count, clearance)
        assert len(coarse.vertices) == count and verify(coarse, fine, clearance)
        assert_nested(coarse, fine)
        assert coarse.area <= 1.005 * AREAS[name][count == 18] * fine.area
    assert [len(loop) for loop in hull(annulus(5), [9, 4]).loops] == [9, 4]


@pytest.mark.parametrize("width", slow_after(2, [1e-3, 1e-13, 0.05, 1e-6, 1e-9]))
def test_slits_are_followed_or_filled_but_the_clearance_holds(width: float) -> None:
    y = np.linspace(0.2, 1.0, 20)
    x = 0.5 + 0.05 * np.sin(9.0 * y)
    right, left = np.stack([x + 0.5 * width, y], axis=1)[::-1], np.stack([x - 0.5 * width, y], axis=1)
    fine = Mesh.from_loops([np.concatenate([[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], right, left, [(0.0, 1.0)]])])
    for count in (7, 24):
        coarse = hull(fine, count, 1e-4)
        assert len(coarse.vertices) == count and gap(coarse, fine) >= 1e-4 and coarse.area < 1.1
        assert_nested(coarse, fine)


@pytest.mark.parametrize("tiny", [1e-6, 1e-12, 1e-15])
def test_vertices_that_almost_coincide_do_no_harm(tiny: float) -> None:
    fine = Mesh.from_loops([np.array([(0, 0), (1, 0), (1, 1), (0.5 + tiny, 1), (0.5, 1 - tiny), (0, 1), (0, tiny)])])
    for count in (4, 7):
        assert verify(hull(fine, count, 1e-5), fine, 1e-5)


def test_teeth_with_hardly_a_gap_are_enclosed_without_stairs() -> None:
    lengths, gap_width = [1.0, 2.0, 1.2, 2.4, 1.7, 0.8], 1e-7
    points = [(6.0, -1.0), (0.0, -1.0)]
    for k, length in enumerate(lengths):
        left, right = k + gap_width * (k > 0), k + 1.0 - gap_width * (k < 5)
        points += [(left, 0.0)] * (k > 0) + [(left, length), (right, length)] + [(right, 0.0)] * (k < 5)
    fine = Mesh.from_loops([points])
    coarse = hull(fine, 14, 1e-4)
    assert_nested(coarse, fine)
    assert coarse.area < 1.001 * fine.area


@pytest.mark.slow
def test_what_has_no_room_is_an_error_with_the_place_or_the_smallest_count() -> None:
    assert_nested(hull(two := Mesh.from_loops([SQUARE, SQUARE + beside(1.0 + 1e-12)]), 8, 1e-5), two)
    with pytest.raises(NestingError) as caught:
        hull(Mesh.from_loops([SQUARE, SQUARE + beside(np.nextafter(1.0, 2.0))]), 8)
    assert caught.value.code == "clearance.no_room"
    corner = np.array([(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)], dtype=float)
    island = np.array([(0.3, 0.3), (3.5, 0.3), (3.5, 1.6), (1.7, 1.6), (1.7, 3.5), (0.3, 3.5)])
    fine = Mesh.from_loops([corner * 1.2 - 0.3, corner * 0.9 + 0.1, island])
    with pytest.raises(NestingError) as caught:
        hull(fine, 9)
    least = caught.value.data["least"]
    assert caught.value.code == "count.too_small" and 9 < least <= 15
    assert_nested(hull(fine, least), fine)


@pytest.mark.slow
def test_large_clearances_straight_sides_and_many_vertices() -> None:
    needle = np.array([(0, 0), (1, 0), (1, 0.2), (0.501, 0.2), (0.5, 2.0), (0.499, 0.2), (0, 0.2)])
    for fine, count in ((Mesh.from_loops([needle]), 7), (Mesh.from_loops([ring(900)]), 12)):
        coarse = hull(fine, count, 0.02 * fine.diagonal)
        assert verify(coarse, fine, 0.02 * fine.diagonal) and polygon(coarse).covers(polygon(fine))
    many = Mesh.from_loops([ring(3000), ring(1000, 0.5) + beside(0.1)])
    assert_nested(coarse := hull(many, 30), many)
    assert coarse.area < 1.1 * many.area
    areas = [hull(Mesh.from_loops([ring(60)]), count).area for count in (3, 4, 5, 8, 12, 20, 40, 60)]
    assert (np.diff(areas) < 0.0).all()
