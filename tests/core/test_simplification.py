"""Coarse meshes by Douglas-Peucker, Visvalingam and edge collapse: counts, simple loops, known properties."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.published import DouglasPeucker, EdgeCollapse, Visvalingam
from benchmarks.published.simplification.edge_collapse import touching
from nestedcages_core import Mesh
from nestedcages_core.decimation import Decimation
from support.shapes import annulus, comb, islands, letter_a, polygon, ring, star

EVERY_ONE = (DouglasPeucker(), Visvalingam(), EdgeCollapse())
BY_NAME = pytest.mark.parametrize("decimation", EVERY_ONE, ids=lambda decimation: type(decimation).__name__)


def deviation(coarse: Mesh, fine: Mesh) -> float:
    """Largest distance of a fine vertex from the coarse boundary, by shapely."""
    boundary = polygon(coarse).boundary
    return max(boundary.distance(shapely.Point(vertex)) for vertex in fine.vertices)


@BY_NAME
@pytest.mark.parametrize("shape", [letter_a, star, islands, lambda: annulus(40)])
def test_it_gives_the_wanted_vertices_on_simple_loops_near_the_mesh(decimation: Decimation, shape: object) -> None:
    fine: Mesh = shape()  # type: ignore[operator]
    least = 6 * len(fine.loops)
    previous = np.inf
    for count in (least, 3 * least):
        coarse = decimation.decimate(fine, count)
        assert len(coarse.vertices) == count
        assert (coarse.loop_signs == fine.loop_signs).all()
        assert (coarse.component_of_loop == fine.component_of_loop).all()
        assert polygon(coarse).is_valid
        away = deviation(coarse, fine)
        assert away < min(0.3 * fine.diagonal, previous)
        previous = away


@BY_NAME
def test_numbers_per_loop_are_kept_even_if_there_are_not_so_many(decimation: Decimation) -> None:
    fine = islands()
    coarse = decimation.decimate(fine, [10, 7, 3, 30, 14])
    assert [len(loop) for loop in coarse.loops] == [10, 7, 3, 30, 14]


@BY_NAME
@pytest.mark.parametrize("slit", [0.5, 0.05, 1e-6])
def test_slits_stay_open(decimation: Decimation, slit: float) -> None:
    fine = comb(4, 0.2 * slit, per_unit=12)
    for count in (50, 22, 15, 8):
        assert polygon(decimation.decimate(fine, count)).is_valid


@BY_NAME
def test_the_choice_follows_rotation_scale_and_numbering(decimation: Decimation) -> None:
    random = np.random.default_rng(1)
    fine = letter_a()
    fine = Mesh(fine.vertices + random.normal(scale=0.002, size=fine.vertices.shape), fine.edges)  # no ties
    expected = decimation.decimate(fine, 30)
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    moved = decimation.decimate(Mesh(1e3 * fine.vertices @ turn + 50.0, fine.edges), 30)
    back = Mesh((moved.vertices - 50.0) @ turn.T / 1e3, moved.edges)
    order = random.permutation(len(fine.vertices))
    shuffled = decimation.decimate(Mesh(fine.vertices[order], np.argsort(order)[fine.edges]), 30)
    for other in (back, shuffled):
        assert polygon(other).symmetric_difference(polygon(expected)).area < 1e-9


@pytest.mark.parametrize("decimation", [DouglasPeucker(), Visvalingam()], ids=lambda one: type(one).__name__)
def test_vertices_are_those_of_the_fine_mesh(decimation: Decimation) -> None:
    fine = letter_a()
    assert set(map(tuple, decimation.decimate(fine, 20).vertices)) <= set(map(tuple, fine.vertices))


@BY_NAME
def test_corners_come_first(decimation: Decimation) -> None:
    """Of a square with divided edges, four vertices are the corners; a small bump is dropped before them."""
    side = np.linspace(-1.0, 1.0, 20, endpoint=False)
    sides = [np.stack([side, -np.ones(20)], 1), np.stack([np.ones(20), side], 1)]
    square = np.concatenate([*sides, -sides[0], -sides[1]])
    square[5, 1] -= 0.01
    corners = decimation.decimate(Mesh.from_loops([square]), 4).vertices
    expected = {(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)}
    assert {tuple(corner) for corner in np.round(corners, 1) + 0.0} == expected


def test_douglas_peucker_divides_where_the_distance_is_largest() -> None:
    """Against shapely's tolerance: what keeps as many vertices deviates as little, within the choice of the start."""
    fine = star(9, 180)
    for count in (27, 45, 72):
        ours = deviation(DouglasPeucker().decimate(fine, count), fine)
        tolerances = np.geomspace(1e-4, 1.0, 200)
        simplified = (polygon(fine).simplify(tolerance) for tolerance in tolerances)
        fitting = next(shape for shape in simplified if len(shape.exterior.coords) - 1 <= count)
        assert ours <= 1.5 * max(fitting.exterior.distance(shapely.Point(v)) for v in fine.vertices) + 1e-12


def test_visvalingam_loses_no_more_area_than_the_smallest_triangles() -> None:
    ellipse = ring(100) * [2.0, 1.0]
    coarse = Visvalingam().decimate(Mesh.from_loops([ellipse]), 50)
    assert shapely.Polygon(coarse.vertices).area == pytest.approx(shapely.Polygon(ellipse).area, rel=4e-3)


def test_edge_collapse_meets_the_lines_of_cut_corners() -> None:
    """A square with small chamfers: collapsed vertices are near the corners that were cut off."""
    cut = [(0.9, -1.0), (1.0, -0.9), (1.0, 0.9), (0.9, 1.0), (-0.9, 1.0), (-1.0, 0.9), (-1.0, -0.9), (-0.9, -1.0)]
    corners = EdgeCollapse().decimate(Mesh.from_loops([np.array(cut)]), 4).vertices
    assert np.abs(np.abs(corners) - 1.0).max() < 0.03


# What it rests on

COORDINATE = st.integers(-3, 3).map(float)
POINT = st.tuples(COORDINATE, COORDINATE)


@given(POINT, POINT, POINT, POINT)
def test_touching_agrees_with_shapely(a: tuple, b: tuple, c: tuple, d: tuple) -> None:
    one, other = (shapely.Point(p) if p == q else shapely.LineString([p, q]) for p, q in ((a, b), (c, d)))
    assert touching(a, b, c, d) == one.intersects(other)
