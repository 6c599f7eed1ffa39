"""Regions that share borders: borders simplified once, nothing cut off the coast, no gaps, no overlaps."""

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Mesh, Within, check, coverage_cages
from support.documents import refusal
from support.marks import slow_after
from support.shapes import polygon


def crooked(count: int, seed: int = 4, turn: float = 0.0) -> list[Mesh]:
    """Regions around an inland sea of nobody's, and an island, with crooked borders in common."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1.0, 1.0, (count, 2))
    cells = shapely.voronoi_polygons(shapely.MultiPoint(points), extend_to=shapely.box(-3, -3, 3, 3))
    land = shapely.difference(shapely.Point(0, 0).buffer(1.5, 24), shapely.Point(0.1, 0.2).buffer(0.3))
    land = shapely.union(land, shapely.Point(2.2, 0.3).buffer(0.4))
    rough = shapely.segmentize(shapely.GeometryCollection([land, *cells.geoms]), 0.04)
    moved = shapely.transform(rough, lambda xy: xy + 0.02 * np.sin(23.0 * xy[:, ::-1]) + 0.015 * np.cos(41.0 * xy))
    whole, *parts = shapely.affinity.rotate(moved, turn, origin=(0, 0)).geoms
    pieces = shapely.get_parts(shapely.coverage_simplify([shapely.intersection(part, whole) for part in parts], 0.0))
    return [Mesh.of(piece) for piece in pieces]


def area(regions: list[shapely.Geometry]) -> float:
    return float(sum(region.area for region in regions))


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "turn"), slow_after(0, [(4, 0.0), (5, 33.0), (6, 70.0)], thorough_after=1))
def test_regions_fill_the_cage_of_their_land(seed: int, turn: float) -> None:
    regions = crooked(9, seed, turn)
    land = shapely.union_all([polygon(region) for region in regions])
    inner = [polygon(region) for region in regions]
    points = len(np.unique(np.concatenate([region.vertices for region in regions]), axis=0))
    for share, found in zip((0.12, 0.04), coverage_cages(regions, ["12%", "4%"]), strict=True):
        made = list(found.regions)
        cage = polygon(found.coast.cage)
        assert core.verify(found.coast.cage, found.coast.fine, same_loops=not any(found.coast.report.lost))
        assert check(found.coast.fine, found.coast)
        assert area(made) == pytest.approx(cage.area, rel=1e-9)  # no overlap, and with the next line no gap
        assert shapely.union_all(made).symmetric_difference(cage).area < 1e-9 * cage.area
        assert found.points < 1.8 * share * points
        for region, simple in zip(inner, made, strict=True):
            assert region.difference(simple.buffer(1.001 * found.width, 32)).area < 1e-9
        kept = sum(region.intersection(simple).area for region, simple in zip(inner, made, strict=True))
        assert kept > 0.93 * area(inner)
        inner = made
        assert cage.covers(land)


@pytest.mark.slow
def test_borders_stay_within_the_width() -> None:
    regions = crooked(7)
    counts = []
    for width in (0.01, 0.05):
        (found,) = coverage_cages(regions, Within(distance=0.05), width=width)
        lines = shapely.union_all([region.boundary for region in found.regions])
        shared, count = np.unique(np.concatenate([region.vertices for region in regions]), axis=0, return_counts=True)
        away = shapely.distance(shapely.points(shared[count > 1]), lines).max()
        assert away <= (1.0 + 1e-6) * found.width and found.width <= width
        counts.append(found.points)
    assert counts[1] < 0.7 * counts[0]


def test_regions_with_slightly_different_borders_have_no_gap() -> None:
    west = [(0, 0), (5, 0), (5.00003, 2), (5, 4), (0, 4)]
    east = [(5, 0), (9, 0), (9, 4), (5, 4), (4.99998, 1)]
    (found,) = coverage_cages([Mesh.from_loops([west]), Mesh.from_loops([east])], 4)
    made = list(found.regions)
    assert shapely.union_all(made).area == pytest.approx(found.coast.cage.area, rel=1e-9)
    assert area(made) == pytest.approx(found.coast.cage.area, rel=1e-9)
    for width in (0.0, -1.0, float("nan")):
        refusal(coverage_cages, crooked(4), 12, width=width)


@pytest.mark.parametrize("seed", range(4))
def test_regions_of_pixels_are_a_valid_coverage_with_simple_borders(seed: int) -> None:
    rng = np.random.default_rng(seed)
    fields = [np.cumsum(np.cumsum(rng.normal(size=(12, 12)), axis=0), axis=1) for _ in range(3)]
    chosen = np.argmax(fields, axis=0)
    places = [np.nonzero(chosen == k) for k in range(3)]
    regions = [shapely.coverage_union_all(shapely.box(x, y, x + 1, y + 1)) for y, x in places if len(x)]
    (found,) = coverage_cages(regions, 8)
    assert shapely.coverage_is_valid(list(found.regions))
    assert shapely.union_all(list(found.regions)).area == pytest.approx(found.coast.cage.area, rel=1e-9)
    assert found.points < 0.6 * len(np.unique(shapely.get_coordinates(regions), axis=0))
