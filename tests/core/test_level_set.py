"""Level sets: contours against the exact signed distance, cages that enclose, and changes of topology that are told."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from benchmarks.published import LevelSet
from benchmarks.published.sellan_2022.contour import Field
from benchmarks.published.sellan_2022.level_set import loops_around, without_pockets
from nestedcages_core import Mesh, NestingError, Settings, nested_cages
from support.shapes import annulus, assert_nested, islands, letter_a, polygon, ring, star

COARSE_GRID = LevelSet(cells=80)


def contour_of(mesh: Mesh, level: float, cells: int = 120) -> Mesh:
    contour = Field.signed_distance(mesh, mesh.diagonal / cells, level + 0.1 * mesh.diagonal).contour(level)
    assert contour is not None
    return contour


@pytest.mark.parametrize("shape", [letter_a, star, lambda: annulus(40)])
@pytest.mark.parametrize("level", [0.02, 0.1])
def test_contours_have_their_distance(shape: object, level: float) -> None:
    """The distance is linear but for corners and the medial axis; there the contour is off by part of a cell."""
    mesh: Mesh = shape()  # type: ignore[operator]
    boundary = polygon(mesh).boundary
    contour = contour_of(mesh, level)
    away = np.array([boundary.distance(shapely.Point(vertex)) for vertex in contour.vertices])
    cell = mesh.diagonal / 120
    assert np.median(np.abs(away - level)) < 0.01 * cell
    assert np.abs(away - level).max() < 0.8 * cell
    buffered = polygon(mesh).buffer(level, quad_segs=32)
    assert polygon(contour).symmetric_difference(buffered).area < 0.02 * buffered.length * cell + 1e-3


def test_random_fields_give_simple_loops() -> None:
    """Saddles of both kinds, and values that are exactly the level: marching squares must still pair all ends."""
    random = np.random.default_rng(1)
    for _ in range(20):
        values = np.pad(random.integers(-2, 3, size=(12, 12)).astype(float), 1, constant_values=3.0)
        contour = Field(np.zeros(2), 1.0, values).contour(0.0)
        assert contour is not None  # and its loops have passed the door: closed, simple, apart
        inside = shapely.contains_xy(polygon(contour), *np.meshgrid(np.arange(14.0), np.arange(14.0), indexing="ij"))
        assert (inside == (values < 0.0)).all()


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "count"), [(letter_a, 30), (star, 24), (lambda: annulus(60), 16)])
def test_it_encloses_strictly_with_the_loops_of_the_mesh(shape: object, count: int) -> None:
    fine: Mesh = shape()  # type: ignore[operator]
    coarse = COARSE_GRID.decimate(fine, count)
    assert len(coarse.vertices) == count
    assert_nested(coarse, fine)
    assert (coarse.loop_signs == fine.loop_signs).all()
    assert coarse.area < 1.6 * fine.area
    for k in range(len(fine.loops)):
        one, other = (shapely.Polygon(mesh.vertices[mesh.loops[k]]) for mesh in (coarse, fine))
        assert one.contains(other) if fine.loop_signs[k] > 0 else other.contains(one)


def test_a_clearance_is_kept() -> None:
    fine = letter_a()
    coarse = COARSE_GRID.decimate(fine, 40, clearance=0.15)
    assert polygon(coarse).boundary.distance(polygon(fine).boundary) >= 0.15


# Topology


def test_a_change_of_loops_is_an_error_that_names_the_place() -> None:
    """Nested rings with narrow gaps: before 15 vertices enclose them, the gaps have closed."""
    with pytest.raises(NestingError, match=r"outlines and holes, 3 and 2, have become .*near .*outer hull"):
        COARSE_GRID.decimate(islands(), 15)


@pytest.mark.slow
def test_a_change_of_loops_can_be_allowed_and_is_noted() -> None:
    fine = islands()
    decimation = LevelSet(cells=80, change_loops=True)
    coarse = decimation.decimate(fine, 15)
    assert len(coarse.loops) < len(fine.loops)
    assert polygon(coarse).covers(polygon(fine))
    level = nested_cages(fine, [15], Settings(decimation=decimation)).levels[0]
    assert polygon(level.cage).covers(polygon(fine))
    assert any("loops" in note for note in level.report.notes)


def test_bays_that_close_are_filled() -> None:
    """A ring with a narrow mouth: its level set has a hole that the mesh has not, until it is filled."""
    turn = np.linspace(0.1, 2.0 * np.pi - 0.1, 60)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    fine = Mesh.from_loops([np.concatenate([circle, 0.6 * circle[::-1]])])
    contour = contour_of(fine, 0.13)
    assert len(contour.loops) == 2
    assert loops_around(contour, fine) is None
    filled = without_pockets(contour, fine)
    assert len(filled.loops) == 1
    assert loops_around(filled, fine) is not None
    assert_nested(COARSE_GRID.decimate(fine, 10), fine)


def test_loops_find_their_partners_in_any_order() -> None:
    fine = islands()
    wide = Mesh.from_loops([ring(5), ring(5)[:, ::-1] + 9.0])
    assert loops_around(wide, fine) is None
    shifted = [1.05, 0.65, 1.2, 1.05, 0.8]
    loops = [fine.vertices[loop] for loop in fine.loops]
    centres = [points.mean(axis=0) for points in loops]
    grown = [c + factor * (points - c) for points, c, factor in zip(loops, centres, shifted, strict=True)]
    order = [3, 1, 4, 0, 2]
    partner = loops_around(Mesh.from_loops([grown[k] for k in order]), fine)
    assert partner is not None
    assert [order[k] for k in partner] == [0, 1, 2, 3, 4]


def test_a_clearance_beyond_all_offsets_is_refused() -> None:
    fine = Mesh.from_loops([ring(20)])
    with pytest.raises(NestingError, match="clearance of 6, 2 times the size of the mesh or more"):
        LevelSet().decimate(fine, 8, clearance=6.0)
    level = nested_cages(fine, [8], Settings(decimation=LevelSet(), clearance=6.0)).levels[0]
    assert level.report.clearance >= 6.0 * (1.0 - 1e-9)
    assert "the outer hull" in level.report.notes[0]
