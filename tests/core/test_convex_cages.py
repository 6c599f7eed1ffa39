"""Convex cages: the least polygons there are, certified, apart from each other, and what does not go with them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import (
    Level,
    Mesh,
    Mirror,
    NestedCagesError,
    NestingError,
    Rotation,
    Settings,
    Within,
    animated_cages,
    inner_cages,
    nested_cages,
    verify,
)
from nestedcages_core.constraints.convex import is_convex
from nestedcages_core.geometry.convex_hull import convex_hull
from nestedcages_core.geometry.group import orbits_of
from nestedcages_core.level import settling
from support.marks import slow_after
from support.shapes import annulus, disc, islands, letter_a, polygon, ring, star

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def assert_convex_cage(level: Level, count: int, parts: int = 1) -> None:
    """Convex, certified, with so many vertices around each part, and apart from what it encloses."""
    cage, fine, clearance = level.cage, level.fine, level.report.wanted_clearance
    assert is_convex(cage)
    assert [len(loop) for loop in cage.loops] == [count] * parts
    assert verify(cage, fine, clearance, same_loops=False)
    assert polygon(cage).contains(polygon(fine))
    assert polygon(cage).boundary.distance(polygon(fine)) >= clearance * (1.0 - 1e-6)
    assert np.array_equal(level.reinflation.cage_steps[0], level.coarse.vertices)


def cage_of(fine: Mesh, count: int, clearance: float = 1e-9) -> Level:
    return nested_cages(fine, [count], Settings(convex=True, clearance=clearance)).levels[0]


@pytest.mark.slow
def test_known_optima() -> None:
    """A triangle around a disc or a parallelogram, a square around a disc, a regular polygon around itself."""
    disc = Mesh.from_loops([ring(160)])
    for count in (3, 4, 6, 12):
        level = cage_of(disc, count)
        assert_convex_cage(level, count)
        assert level.cage.area == pytest.approx(count * np.tan(np.pi / count), rel=2e-3)
    slanted = Mesh.from_loops([[[0, 0], [3, 0], [4, 1], [1, 1]]])
    assert cage_of(slanted, 3).cage.area == pytest.approx(6.0, rel=1e-6)
    assert cage_of(slanted, 4).cage.area == pytest.approx(3.0, rel=1e-6)
    heptagon = Mesh.from_loops([ring(7)])
    assert cage_of(heptagon, 7).cage.area == pytest.approx(heptagon.area, rel=1e-6)
    assert cage_of(annulus(48), 5).cage.area == pytest.approx(cage_of(Mesh.from_loops([ring(48)]), 5).cage.area)


@pytest.mark.parametrize("seed", range(3))
def test_as_small_as_the_best_of_all_choices_of_edges(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    from needed.convex import least_by_trial

    rng = np.random.default_rng(seed)
    points = rng.normal(size=(24, 2)) * [1.0, rng.uniform(0.1, 1.0)]
    corners = points[convex_hull(points)]
    fine = Mesh.from_loops([corners])
    for count in range(3, min(7, len(corners)) + 1):
        least = least_by_trial(corners, count)
        assert cage_of(fine, count).cage.area <= least * (1.0 + 1e-6)


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(3, 8), clearance=st.sampled_from([1e-7, 1e-3, 0.3]))
def test_random_shapes(seed: int, count: int, clearance: float) -> None:
    rng = np.random.default_rng(seed)
    fine = Mesh.from_loops([ring(30) * rng.uniform(0.3, 1.0, size=(30, 1)) * [1.0, rng.uniform(0.1, 1.0)]])
    level = cage_of(fine, count, clearance)
    assert_convex_cage(level, min(count, len(level.cage.vertices)))
    widened = polygon(fine).convex_hull.buffer(clearance, quad_segs=64)
    # every edge touches, most of them at the middle or along an edge
    for start, end in zip(level.cage.vertices, level.cage.edge_ends, strict=True):
        assert shapely.LineString([start, end]).distance(widened) <= 1e-3 * clearance + 1e-6


def test_the_hull_is_by_exact_predicates() -> None:
    rng = np.random.default_rng(2)
    points = rng.integers(-3, 4, size=(60, 2)) * 0.1 + 1e6
    ours = points[convex_hull(points)]
    theirs = shapely.MultiPoint(points).convex_hull
    assert shapely.Polygon(ours).equals(theirs)
    assert len(ours) == len(theirs.exterior.coords) - 1
    assert shapely.Polygon(ours).exterior.is_ccw


def test_every_part_gets_its_own() -> None:
    level = cage_of(islands(), 5)
    assert_convex_cage(level, 5, parts=2)
    assert "2 outer loops and no holes" in level.report.notes[0]
    hierarchy = nested_cages(letter_a(), [10, 6, 4], Settings(convex=True))
    for level, count in zip(hierarchy.levels, (10, 6, 4), strict=True):
        assert_convex_cage(level, count)
        assert level.report.start == "line cycles"
    assert hierarchy.levels[1].fine is hierarchy.levels[0].cage


@pytest.mark.parametrize(
    ("count", "angle"), slow_after(0, [(3, 0.0), (4, 0.0), (4, 0.5), (5, 1.0), (6, 0.8)], thorough_after=2)
)
def test_parts_close_to_each_other_keep_apart(count: int, angle: float) -> None:
    """Turned, some pairs overlap only once there are walls between others."""
    c, s = np.cos(angle), np.sin(angle)
    loops = ring(24), disc(24, 1.0, 2.05, 0.0), disc(20, 0.5, 1.025, 1.3)
    fine = Mesh.from_loops([loop @ np.array([[c, s], [-s, c]]) for loop in loops])
    assert_convex_cage(cage_of(fine, count, 1e-3), count, parts=3)


def test_a_part_in_the_bay_of_another_has_none() -> None:
    bay = [[0, 0], [5, 0], [5, 5], [4, 5], [4, 1], [1, 1], [1, 5], [0, 5]]
    fine = Mesh.from_loops([bay, [[2, 2], [3, 2], [3, 3], [2, 3]]])
    with pytest.raises(NestingError, match=r"loop 0 and loop 1 would overlap.*unite them"):
        cage_of(fine, 6)
    close = Mesh.from_loops([ring(24), disc(24, 1.0, 2.05, 0.0)])
    with pytest.raises(NestingError, match=r"0\.05 apart.*ask for less than 0\.025"):
        cage_of(close, 6, clearance=0.1)


def test_more_vertices_than_the_hull_has() -> None:
    level = cage_of(star(5, 60), 50)
    assert len(level.cage.vertices) < 50
    assert any("50 vertices were asked for" in note for note in level.report.notes)


@pytest.mark.slow
def test_on_a_grid_and_within() -> None:
    for fine in (star(), islands()):
        for level in nested_cages(fine, [9, 5], Settings(convex=True, grid=0.05)).levels:
            assert_convex_cage(level, len(level.cage.loops[0]), len(level.cage.loops))
            assert np.array_equal(level.cage.vertices, np.round(level.cage.vertices, 2))
    fine = star()
    level = nested_cages(fine, [Within(excess=0.9)], Settings(convex=True)).levels[0]
    count = len(level.cage.vertices)
    assert level.cage.area <= 1.9 * fine.area < cage_of(fine, count - 1, 1e-5 * fine.diagonal).cage.area
    with pytest.raises(NestingError, match="No convex cage within"):
        nested_cages(fine, [Within(excess=0.01)], Settings(convex=True))


def test_what_does_not_go_together() -> None:
    fine = star(5, 40)
    with pytest.raises(NestingError, match="around a shape, not inside"):
        inner_cages(fine, [6], Settings(convex=True))
    with pytest.raises(NestingError, match="does not stay convex"):
        animated_cages(fine, [fine.vertices, fine.vertices + 0.1], [6], Settings(convex=True))
    with pytest.raises(NestingError, match="needs a number of vertices"):
        nested_cages(fine, [Mesh.from_loops([ring(6, 3.0)])], Settings(convex=True))
    with pytest.raises(NestingError, match="at least 3"):
        nested_cages(fine, [2], Settings(convex=True))
    with pytest.raises(NestedCagesError, match="convex"):
        Settings(convex=1)


@pytest.mark.slow
def test_symmetric_polygons_are_the_least_where_these_are_symmetric() -> None:
    """Of a shape with four rotations and mirrors, and in pairs next to an axis."""
    turn = 2.0 * np.pi * np.arange(120) / 120
    fine = Mesh.from_loops([ring(120) * (1.0 + 0.3 * np.cos(4.0 * turn))[:, None]])
    best = cage_of(fine, 8).excess
    mirrors = [Mirror((0.0, 0.0), along) for along in ((0.0, 1.0), (1.0, 1.0))]
    for symmetry in (Rotation((0.0, 0.0), 4), Rotation((0.0, 0.0), 2), *mirrors):
        settings = Settings(convex=True, symmetry=symmetry, clearance=1e-9)
        for count in (8, 9):
            level = nested_cages(fine, [count], settings).levels[0]
            orbits = orbits_of(level.cage, symmetry)
            assert is_convex(level.cage) and orbits is not None
            assert np.abs(orbits.symmetrised(level.cage.vertices) - level.cage.vertices).max() < 1e-15
            assert len(level.cage.vertices) == count - (count % 2 and isinstance(symmetry, Rotation))
            assert cage_of(fine, count).excess <= level.excess + 1e-9 <= best * (1.0 + 1e-3)
    pair = nested_cages(disc(40, 0.5, 2.0, 0.0), [6], Settings(convex=True, symmetry=Mirror((1.0, 0.0)))).levels[0]
    assert [len(loop) for loop in pair.cage.loops] == [6, 6]


@pytest.mark.slow
def test_triangles_that_a_grid_turns_over_are_mended_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two needles on a coarse grid: hulls of three corners have none to drop, which went on for ever."""
    fine = Mesh.from_loops([[(0, y), (500, y + 0.5), (0, y + 1)] for y in (0, 20)])
    searched: list[int] = []
    placed = settling.placements

    def counted(plan: Any, *asked: Any) -> Any:
        searched.append(len(asked[1].vertices))
        return placed(plan, *asked)

    monkeypatch.setattr(settling, "placements", counted)
    with pytest.raises(NestingError, match=r"a grid of 0\.5 works"):
        nested_cages(fine, 6, convex=True, grid=5.0)
    assert len(searched) < 10


def test_weights_move_convex_cages() -> None:
    fine = Mesh.from_loops([ring(120)])
    weights = 1.0 + 99.0 * (fine.vertices[:, 0] > 0.5)
    heavy, light = nested_cages(fine, [5], Settings(convex=True, weights=weights)).cages[0], cage_of(fine, 5).cage
    right = shapely.box(0.5, -9.0, 9.0, 9.0) - polygon(fine)
    assert is_convex(heavy)
    assert (polygon(heavy) & right).area < 0.5 * (polygon(light) & right).area
    assert heavy.area > light.area


def test_polygons_do_not_depend_on_place_or_scale() -> None:
    fine = star(7, 60)
    area = nested_cages(fine, 5, convex=True)[0].cage.area
    for scale, place in ((1e-6, 0.0), (1e6, 1e7), (1.0, -500.0)):
        moved = nested_cages(fine.moved(scale * fine.vertices + place), 5, convex=True)[0].cage.area
        assert moved == pytest.approx(scale**2 * area, rel=1e-5)
