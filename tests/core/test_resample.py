"""Even resampling, vertices of the hull put back on the curve, and a decimation of one's own."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from nestedcages_core import ArcLength, Mesh, NestingError, OnCurve, OwnDecimation, Settings, nested_cages
from nestedcages_core.decimation import Decimation
from support.shapes import annulus, assert_nested, islands, letter_a, polygon, ring, star

BOTH = pytest.mark.parametrize("decimation", [ArcLength(), OnCurve()], ids=["ArcLength", "OnCurve"])
SHAPES = pytest.mark.parametrize("shape", [letter_a, star, islands, lambda: annulus(40)])


@BOTH
@SHAPES
def test_the_vertices_lie_on_their_loops_in_order(decimation: Decimation, shape: object) -> None:
    fine: Mesh = shape()  # type: ignore[operator]
    count = 9 * len(fine.loops)
    coarse = decimation.decimate(fine, count)
    assert len(coarse.vertices) == count
    assert polygon(coarse).is_valid
    assert (coarse.loop_signs == fine.loop_signs).all()
    assert (coarse.component_of_loop == fine.component_of_loop).all()
    for mine, of_fine in zip(coarse.loops, fine.loops, strict=True):
        assert len(mine) >= 3
        curve = shapely.LinearRing(fine.vertices[of_fine])
        points = shapely.points(coarse.vertices[mine])
        assert shapely.distance(curve, points).max() < 1e-12
        along = shapely.line_locate_point(curve, points)
        assert (np.diff(np.append(along, along[0])) < 0.0).sum() == 1  # once around, forwards


@pytest.mark.slow
@given(st.integers(3, 60), st.floats(0.1, 0.9), st.integers(6, 40))
def test_even_spacing_shared_out_by_length(corners: int, inner: float, count: int) -> None:
    fine = Mesh.from_loops([ring(corners), ring(corners, inner)])
    try:
        coarse = ArcLength().decimate(fine, min(count, 2 * corners))
    except NestingError:
        return  # chords of the outer loop may cut the inner one: said, not returned
    sizes = [len(loop) for loop in coarse.loops]
    assert sum(sizes) == min(count, 2 * corners)
    for mine, of_fine in zip(coarse.loops, fine.loops, strict=True):
        curve = shapely.LinearRing(fine.vertices[of_fine])
        along = shapely.line_locate_point(curve, shapely.points(coarse.vertices[mine]))
        assert np.diff(np.sort(along)) == pytest.approx(curve.length / len(mine), rel=1e-6)
    if min(sizes) > 3:
        assert sizes[0] / sizes[1] == pytest.approx(1.0 / inner, abs=0.5 * (1.0 + 1.0 / inner))


@BOTH
def test_the_numbering_changes_nothing(decimation: Decimation) -> None:
    fine = letter_a()
    moved = Mesh.from_loops([np.roll(fine.vertices[loop], 5, axis=0)[::-1] for loop in fine.loops][::-1])
    coarse, other = decimation.decimate(fine, 24), decimation.decimate(moved, 24)
    for k in range(2):
        assert (coarse.vertices[coarse.loops[k]] == other.vertices[other.loops[1 - k]]).all()


@BOTH
def test_numbers_per_loop_are_kept_even_if_there_are_not_so_many(decimation: Decimation) -> None:
    coarse = decimation.decimate(islands(), [10, 7, 3, 30, 14])
    assert [len(loop) for loop in coarse.loops] == [10, 7, 3, 30, 14]


def test_another_phase_is_tried_where_loops_cross() -> None:
    fine = Mesh.from_loops([ring(96), ring(96, 0.9)])
    coarse = ArcLength().decimate(fine, [8, 8])
    assert polygon(coarse).is_valid


def test_loops_that_cannot_be_followed_are_refused_with_the_place() -> None:
    fine = Mesh.from_loops([ring(96), ring(96, 0.99)])
    with pytest.raises(NestingError, match=r"13 evenly spaced vertices are too few .*[Ll]oop.*\(.*use the outer hull"):
        ArcLength().decimate(fine, [4, 9])


def test_on_curve_puts_more_vertices_at_features() -> None:
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    part = np.linspace(0.0, 1.0, 25, endpoint=False)[None, :, None]
    edges = square[:, None] * (1 - part) + np.roll(square, -1, axis=0)[:, None] * part
    fine = Mesh.from_loops([edges.reshape(-1, 2)])
    corners = {tuple(vertex) for vertex in OnCurve().decimate(fine, 4).vertices.round(12).tolist()}
    assert corners == {tuple(vertex) for vertex in square.tolist()}


def test_a_decimation_of_ones_own_is_checked() -> None:
    def every_fourth(loops: list, count: int) -> list:
        return [loop[::4] for loop in loops]

    fine = annulus(48)
    level = nested_cages(fine, [24], Settings(decimation=OwnDecimation(every_fourth))).levels[0]
    assert_nested(level.cage, level.fine)
    assert set(map(tuple, level.coarse.vertices)) <= set(map(tuple, fine.vertices))
    with pytest.raises(NestingError, match="returned 24 vertices where 20 are wanted"):
        OwnDecimation(every_fourth).decimate(fine, 20)
    crossed = OwnDecimation(lambda loops, count: [loops[0][[0, 24, 12, 36]], loops[1][::4]])
    with pytest.raises(NestingError, match=r"of your own decimation is not valid: .*cross"):
        crossed.decimate(fine, 20)
