"""Cages on a grid: certified on the numbers that are written, which are read back bit by bit."""

from __future__ import annotations

import itertools
import json
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nestedcages_core import (
    Level,
    Mesh,
    NestedCagesError,
    NestingError,
    Settings,
    Within,
    from_engine_json,
    from_geojson,
    from_svg,
    inner_cages,
    nested_cages,
    to_engine_json,
    to_geojson,
    to_svg,
    verify,
)
from nestedcages_core.cache import forget
from nestedcages_core.command import main
from nestedcages_core.constraints import free_edges
from nestedcages_core.constraints.free_edges import FreeEdges
from nestedcages_core.exchange.decimals import subtracted
from nestedcages_core.geometry.lattice import Grid
from nestedcages_core.geometry.shortest_cycle import shortest_cycle
from support.marks import slow_after
from support.shapes import annulus, comb, islands, letter_a, polygon, ring, star


def random_star(seed: int, count: int = 40) -> Mesh:
    rng = np.random.default_rng(seed)
    return Mesh.from_loops([ring(count, angle=rng.uniform(0, 6)) * rng.uniform(0.5, 1.0, size=(count, 1))])


def assert_on_grid(level: Level, grid: float) -> None:
    """The cage's numbers are decimals of the grid, and it is one on them; see `conftest.py` for what else holds."""
    cage, fine, report = level.cage, level.fine, level.report
    step = Decimal(repr(grid))
    for number in cage.vertices.ravel().tolist():
        k = round(Decimal(repr(number)) / step)
        assert number == float(k * step)
    outer, inner = (fine, cage) if level.inside else (cage, fine)
    assert verify(outer, inner, report.wanted_clearance, same_loops=True)
    assert report.grid == grid
    assert f"on a grid of {grid:g}" in str(report)


@given(k=st.integers(-(10**9), 10**9), decimals=st.integers(0, 6))
def test_a_grid_point_is_the_number_that_its_decimals_read_as(k: int, decimals: int) -> None:
    grid = Grid.of_decimals(decimals)
    point = float(grid.points(np.array([k]))[0])
    written = f"{Decimal(k).scaleb(-decimals):f}"
    assert point == float(written)
    assert f"{point:.{decimals}f}".removeprefix("-") == written.removeprefix("-")
    assert grid.holds(np.array([point]))
    assert grid.places(np.array([point]))[0] == k


def test_grids_of_all_kinds() -> None:
    assert Grid(0.1).points(np.array([3]))[0] == 0.3 != 3 * 0.1
    assert Grid(2.0**-25).points(np.array([12345]))[0] == 12345 * 2.0**-25
    assert Grid(1 / 3).points(np.array([3]))[0] == pytest.approx(1.0, abs=1e-15)
    assert Grid(2.5).points(np.array([[-3, 7]])).tolist() == [[-7.5, 17.5]]
    assert not Grid(0.1).holds(np.array([3 * 0.1]))
    assert not Grid(1e-9).resolves(np.array([1e9]))


def test_the_shortest_cycle_is_the_shortest_of_all() -> None:
    rng = np.random.default_rng(0)
    sizes = [3, 2, 4, 3]
    costs = [rng.uniform(size=(sizes[k], sizes[(k + 1) % 4])) for k in range(4)]
    costs[2][0] = np.inf

    def cost(choice: tuple[int, ...]) -> float:
        return sum(costs[k][choice[k], choice[(k + 1) % 4]] for k in range(4))

    best = min(itertools.product(*map(range, sizes)), key=cost)
    assert tuple(shortest_cycle(costs)) == best
    costs[1][:] = np.inf
    assert shortest_cycle(costs) is None


@pytest.mark.parametrize("seed", slow_after(1, range(2)))
def test_as_small_as_the_smallest_triangle_on_a_grid(seed: int) -> None:
    """Every triangle with corners on a coarse grid around the shape, one by one."""
    rng = np.random.default_rng(seed)
    fine = Mesh.from_loops([ring(9, 1.0, rng.uniform(0, 6)) * rng.uniform(0.6, 1.0, size=(9, 1))])
    step, clearance = 0.5, 1e-3
    side = np.arange(-6, 7) * step
    points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    points = points[np.hypot(*points.T) > 0.6]
    solid, corners = polygon(fine), fine.vertices
    i, j = (each.ravel() for each in np.indices((len(points), len(points))))
    p, q = points[i], points[j]
    length = np.maximum(np.hypot(*(q - p).T), 1e-12)
    beyond = (q - p)[:, None, 0] * (corners[:, 1] - p[:, 1:]) - (q - p)[:, None, 1] * (corners[:, 0] - p[:, :1])
    fits = ((beyond / length[:, None]) >= clearance).all(axis=1).reshape(len(points), -1) & ~np.eye(
        len(points), dtype=bool
    )
    least = np.inf
    for a, b in zip(*np.nonzero(fits), strict=True):
        for c in np.flatnonzero(fits[b] & fits[:, a]):
            one, other = points[b] - points[a], points[c] - points[a]
            area = 0.5 * (one[0] * other[1] - one[1] * other[0])
            if area < least and shapely.Polygon(points[[a, b, c]]).contains(solid):
                least = area
    level = nested_cages(fine, [3], Settings(grid=step, clearance=clearance)).levels[0]
    assert_on_grid(level, step)
    assert least <= level.cage.area <= least * 1.1


@pytest.mark.parametrize(
    ("fine", "grid"),
    slow_after(1, [(star(), 0.05), (letter_a(), 0.05), (annulus(40), 1e-6), (islands(), 0.02)]),
)
def test_levels_on_a_grid(fine: Mesh, grid: float) -> None:
    counts = [8 * len(fine.loops), 5 * len(fine.loops)]
    hierarchy = nested_cages(fine, counts, Settings(grid=grid, loops="keep"))
    free = nested_cages(fine, counts[:1], loops="keep").levels[0]
    for level, count in zip(hierarchy.levels, counts, strict=True):
        assert len(level.cage.vertices) == count
        assert_on_grid(level, grid)
    # a step of the grid along the whole boundary is more than what it costs
    length = free.cage.edge_lengths.sum()
    assert hierarchy.levels[0].cage.area <= free.cage.area + 1.5 * grid * length


@pytest.mark.slow
def test_cages_inside_and_within() -> None:
    fine = letter_a(1)
    for level in inner_cages(fine, [30, 16], Settings(grid=0.02)).levels:
        assert_on_grid(level, 0.02)
        assert level.report.excess < 0.0
    level = nested_cages(fine, [Within(distance=0.3)], Settings(grid=0.05)).levels[0]
    assert_on_grid(level, 0.05)
    assert polygon(fine).buffer(0.3 * (1 + 1e-4), quad_segs=256).contains(polygon(level.cage))


def test_a_coarse_mesh_of_ones_own() -> None:
    fine = annulus(48)
    coarse = Mesh.from_loops([ring(8, 1.01), ring(8, 0.49)])
    level = nested_cages(fine, [coarse], Settings(grid=0.05, clearance=0.01)).levels[0]
    assert_on_grid(level, 0.05)
    assert np.array_equal(level.cage.edges, coarse.edges)


def test_what_is_missed_is_said_of_the_cage_on_the_grid() -> None:
    fine = star()
    level = nested_cages(fine, [12], Settings(grid=0.1, pins=[0], min_edge=0.3)).levels[0]
    assert_on_grid(level, 0.1)
    missed = [note for note in level.report.notes if "pins have no vertex" in note]
    assert len(missed) <= 1
    shortest = float(level.cage.edge_lengths.min())
    said = [note for note in level.report.notes if "the shortest has" in note]
    assert bool(said) == (shortest < 0.3)
    assert all(f"{shortest:.3g}" in note for note in said)


@pytest.mark.slow
def test_where_no_motion_leads_to_the_grid_the_cage_stands_still() -> None:
    """Instead of one with room for the motion, which is far looser, or of none."""
    from benchmarks.random_shapes import random_shape

    drawn = random_shape(14)
    assert drawn is not None
    level = nested_cages(drawn[1], [48], grid=0.01 * drawn[1].diagonal)[0]
    assert_on_grid(level, 0.01 * drawn[1].diagonal)
    assert len(level.reinflation.cage_steps) == 1 and level.flow.stage == "inside"
    assert "The cage stands still" in str(level.report) and level.report.excess < 0.06


def test_slits_narrower_than_the_grid_are_filled() -> None:
    fine = comb(5, 0.02)
    level = nested_cages(fine, [16], Settings(grid=0.04)).levels[0]
    assert_on_grid(level, 0.04)
    assert level.report.wanted_clearance == nested_cages(fine, [16]).levels[0].report.wanted_clearance


def test_the_search_on_a_grid_ends_after_so_much_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first cage found is taken where there is one by then, else the error says why there is none."""
    fine, tests = random_star(3), [0]
    met = FreeEdges._met

    def counted(self: FreeEdges, *asked: Any) -> Any:
        tests[0] = self.tests
        return met(self, *asked)

    monkeypatch.setattr(FreeEdges, "_met", counted)
    best = nested_cages(fine, 9, grid=0.02)[0]
    monkeypatch.setattr(free_edges, "MOST_TESTS", tests[0] - 1)
    forget()
    assert_on_grid(found := nested_cages(fine, 9, grid=0.02)[0], 0.02)
    assert found.cage.area >= best.cage.area
    monkeypatch.setattr(free_edges, "MOST_TESTS", 10)
    forget()
    with pytest.raises(NestingError, match=r"on the grid of 0\.02 was found in 10 tests of edges") as error:
        nested_cages(fine, 9, grid=0.02)
    assert error.value.code == "limit.exceeded"


@pytest.mark.slow
def test_where_there_is_no_cage_a_grid_is_named_that_works() -> None:
    fine = annulus(40, 0.2)
    with pytest.raises(
        NestingError, match=r"No cage with 12 vertices on the grid of 0\.5 .* a grid of (\S+) works"
    ) as e:
        nested_cages(fine, [12], Settings(grid=0.5, loops="keep"))
    works = float(str(e.value).split("a grid of ")[1].split()[0])
    assert_on_grid(nested_cages(fine, [12], Settings(grid=works, loops="keep")).levels[0], works)
    with pytest.raises(NestingError, match="finer than floating-point numbers"):
        nested_cages(fine, [12], Settings(grid=1e-20))
    with pytest.raises(NestingError, match="larger than the drawing, which is 2 wide"):
        nested_cages(fine, [12], Settings(grid=1e9))
    for wrong in (0.0, -1.0, float("nan"), "0.1"):
        with pytest.raises(NestedCagesError, match="grid"):
            Settings(grid=wrong)


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10_000), decimals=st.integers(1, 7), place=st.sampled_from([0.0, 123.0, -40_000.0]))
def test_every_grid_cage_survives_writing_and_reading(seed: int, decimals: int, place: float) -> None:
    fine = random_star(seed).moved(random_star(seed).vertices + place).validated()
    grid = 10.0**-decimals
    try:
        level = nested_cages(fine, [9], Settings(grid=grid)).levels[0]
    except NestingError:
        assume(False)
    assert_on_grid(level, grid)
    cage, clearance = level.cage, level.report.wanted_clearance
    back = [
        from_geojson(to_geojson(cage, decimals=decimals)),
        from_svg(to_svg({"drawing": fine, "cage": cage}, decimals=decimals), element="cage"),
        from_svg(to_svg(cage, y_up=False, decimals=decimals)),
        from_engine_json(to_engine_json(cage, decimals=decimals)),
        from_engine_json(to_engine_json(cage, flip_y=480, decimals=decimals), flip_y=480),
    ]
    for read in back:
        assert {tuple(row) for row in read.vertices.tolist()} == {tuple(row) for row in cage.vertices.tolist()}
        assert verify(read, fine, clearance)
    written = json.loads(to_engine_json(cage, flip_y=480))["polygons"][0]["outer"]
    assert all(Decimal(repr(x)).normalize().as_tuple().exponent >= -decimals for row in written for x in row)
    # and with that many decimals, as other programs write
    rounded = cage.moved([[float(f"{x:.{decimals}f}") for x in row] for row in cage.vertices.tolist()])
    assert np.array_equal(rounded.vertices, cage.vertices)


def test_writers_do_not_round() -> None:
    fine = random_star(1)
    cage = nested_cages(fine, [8]).levels[0].cage
    for write in (to_geojson, to_svg, to_engine_json):
        with pytest.raises(NestedCagesError, match=r"more than 3 decimals.*Settings\(grid=0\.001\)"):
            write(cage, decimals=3)
    with pytest.raises(NestedCagesError, match="from 0 to 15"):
        to_geojson(cage, decimals=-1)
    assert subtracted(10.0, np.array([9.9, 0.1, 0.0])).tolist() == [0.1, 9.9, 10.0]


@pytest.mark.slow
def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "star.geojson"
    source.write_text(to_geojson(star()))
    out, report = tmp_path / "cages.geojson", tmp_path / "report.json"
    given = [str(source), "--levels", "20", "--decimals", "2", "-o", str(out), "--report", str(report), "--quiet"]
    assert main(given) == 0
    assert "on a grid of 0.01" in capsys.readouterr().out
    cage = from_geojson(out.read_text())
    assert Grid(0.01).holds(cage.vertices)
    assert verify(cage, star())
    assert json.loads(report.read_text())["inputs"][0]["shapes"][0]["levels"][0]["grid"] == 0.01
    assert main([*given, "--inside"]) == 0
    assert Grid(0.01).holds(from_geojson(out.read_text()).vertices)
    for wrong in (
        ["--grid", "0"],
        ["--decimals", "1.5"],
        ["--grid", "1", "--decimals", "2"],
        ["--grid", "1", "--borders"],
    ):
        with pytest.raises(SystemExit):
            main([str(source), "--levels", "20", *wrong])


def test_a_picture_in_whole_pixels() -> None:
    from nestedcages_core import collision_outline

    y, x = np.mgrid[:40, :60]
    picture = (np.hypot((x - 30) / 25.0, (y - 20) / 15.0) < 1.0).astype(float)
    outline = collision_outline(picture, 8, settings=Settings(grid=1))
    assert np.array_equal(outline.vertices, np.rint(outline.vertices))
    assert to_engine_json(outline, decimals=0)
