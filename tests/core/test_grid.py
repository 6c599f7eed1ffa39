"""Cages on a grid and on stored numbers: certified on the numbers that are written, which are read back bit by bit."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Mesh, NestingError, Settings, nested_cages, verify
from support.command import run
from support.families import simple
from support.judging import codes, is_on_grid, lengths_of, lies_within, note, rejected
from support.marks import slow_after
from support.shapes import annulus, comb, islands, letter_a, polygon, ring, star

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
KINDS: dict[str, Any] = {"star": star(), "letter": letter_a(), "ring": annulus(40), "islands": islands()}


def assert_on_grid(level: core.Level, grid: float) -> None:
    """The cage's numbers are decimals of the grid, and it is one on them; see `conftest.py` for what else holds."""
    outer, inner = (level.fine, level.cage) if level.inside else (level.cage, level.fine)
    assert is_on_grid(level.cage, grid) and level.report.grid == grid
    assert verify(outer, inner, level.report.wanted_clearance, same_loops=True)


# The smallest on a grid


@pytest.mark.parametrize(
    ("grid", "inner"),
    [(0.5, (0.0, 10.5)), (0.3, (0.0, 10.2)), (0.25, (0.0, 10.25)), (0.1, (0.0, 10.1)), (1 / 64, (3 / 64, 644 / 64))],
)
def test_around_a_square_along_the_axes_the_next_lines_of_the_grid_are_taken(grid: float, inner: Any) -> None:
    """The square from 0.05 to 10.05."""
    level = nested_cages(10.0 * SQUARE + 0.05, 4, grid=grid, constraints=[core.AxisAligned()])[0]
    low, high = inner
    assert sorted(map(tuple, level.cage.vertices.tolist())) == [(low, low), (low, high), (high, low), (high, high)]


def test_where_a_square_lies_on_the_grid_the_cage_goes_around_its_corners() -> None:
    """Turned a little, it is smaller than the square on the next lines."""
    level = nested_cages(10.0 * SQUARE, 4, grid=1)[0]
    assert_on_grid(level, 1)
    assert level.cage.area <= 122.0


@pytest.mark.parametrize("seed", slow_after(1, range(8), thorough_after=3))
def test_as_small_as_the_smallest_polygon_on_the_grid(seed: int) -> None:
    """Of all with corners on a coarse grid around a convex shape, by the shortest cycles of so many edges."""
    random = np.random.default_rng(seed)
    fine = Mesh.from_loops([ring(9, 1.0, random.uniform(0, 6)) * random.uniform(0.6, 1.0, size=(9, 1))])
    corners = shapely.get_coordinates(polygon(fine).convex_hull)[:-1]
    for count, least in zip((3, 4), smallest_on_grid(corners, 0.5, 1e-3), strict=True):
        level = nested_cages(corners, count, grid=0.5, clearance=1e-3)[0]
        assert_on_grid(level, 0.5)
        assert level.cage.area == pytest.approx(least, rel=1e-9)


def smallest_on_grid(corners: np.ndarray, step: float, clearance: float) -> tuple[float, float]:
    """The least areas of triangles and quadrilaterals, whose edges all have the shape on their left."""
    side = np.arange(-6, 7) * step
    points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    edge = points[None] - points[:, None]
    length = np.maximum(np.hypot(edge[..., 0], edge[..., 1]), 1e-12)
    to = corners[None, None] - points[:, None, None]
    beyond = (edge[:, :, None, 0] * to[..., 1] - edge[:, :, None, 1] * to[..., 0]) / length[..., None]
    swept = 0.5 * (points[:, None, 0] * points[None, :, 1] - points[:, None, 1] * points[None, :, 0])
    cost = np.where((beyond >= clearance).all(axis=2), swept, np.inf)
    two = np.min(cost[:, :, None] + cost[None], axis=1)
    return float((two + cost.T).min()), float((two + two.T).min())


# Levels


@pytest.mark.parametrize(
    ("name", "grid"),
    slow_after(0, [("star", 0.05), ("letter", 0.05), ("ring", 1e-6), ("islands", 0.02), ("star", 1 / 3)]),
)
def test_levels_on_a_grid(name: str, grid: float) -> None:
    """A step of the grid along the whole boundary is more than what it costs."""
    fine = KINDS[name]
    counts = [8 * len(fine.loops), 5 * len(fine.loops)]
    hierarchy = nested_cages(fine, counts, grid=grid, loops="keep")
    free = nested_cages(fine, counts[:1], loops="keep")[0]
    for level, count in zip(hierarchy, counts, strict=True):
        assert len(level.cage.vertices) <= count
        assert_on_grid(level, grid)
    assert hierarchy[0].cage.area <= free.cage.area + 1.5 * grid * lengths_of(free.cage).sum()


@pytest.mark.slow
def test_cages_inside_and_within() -> None:
    fine = letter_a(1)
    for level in core.inner_cages(fine, [30, 16], grid=0.02):
        assert_on_grid(level, 0.02)
        assert level.excess < 0.0
    level = nested_cages(fine, core.Within(distance=0.3), grid=0.05)[0]
    assert_on_grid(level, 0.05)
    assert lies_within(level.cage, fine, 0.3)


def test_a_coarse_mesh_of_ones_own() -> None:
    coarse = Mesh.from_loops([ring(8, 1.01), ring(8, 0.49)])
    level = nested_cages(annulus(48), coarse, grid=0.05, clearance=0.01)[0]
    assert_on_grid(level, 0.05)
    assert np.array_equal(level.cage.edges, coarse.edges)


def test_what_is_missed_is_measured_on_the_grid() -> None:
    level = nested_cages(star(), 12, grid=0.1, pins=[0], min_edge=0.3)[0]
    assert_on_grid(level, 0.1)
    shortest = float(lengths_of(level.cage).min())
    assert ("note.edge" in codes(level)) == (shortest < 0.3)
    if shortest < 0.3:
        assert note(level, "note.edge").data["given"] == pytest.approx(shortest)
    away = float(np.hypot(*(level.cage.vertices - star().vertices[0]).T).min())
    for said in [each for each in level.report.notes if each.code == "note.pin"]:
        assert said.data["distance"] == pytest.approx(away, abs=1e-3)
    assert codes(nested_cages(annulus(40), 24, grid=0.05)[0]) == []  # a push makes way, so that no cage stands still


def test_starts_of_another_decimation_need_no_failure_to_be_compared() -> None:
    for count in (8, 20):
        assert_on_grid(core.nested_cages(star(60), count, grid=0.1, decimation=core.ArcLength())[0], 0.1)


@pytest.mark.slow
def test_slits_narrower_than_the_grid_are_filled() -> None:
    fine = comb(5, 0.02)
    level = nested_cages(fine, 16, grid=0.04)[0]
    assert_on_grid(level, 0.04)
    assert level.report.wanted_clearance == nested_cages(fine, 16)[0].report.wanted_clearance


def test_where_there_is_no_cage_on_a_grid_the_error_says_so() -> None:
    with rejected("numbers.no_room", NestingError, spacing=0.5, count=12):
        nested_cages(annulus(40, 0.2), 12, grid=0.5, loops="keep")


def test_grids_that_no_cage_can_be_on_are_refused() -> None:
    for grid, code in ((1e-20, "numbers.unresolved"), (1e9, "numbers.no_room")):
        with rejected(code, NestingError, spacing=grid):
            nested_cages(annulus(40), 12, grid=grid)
    for wrong in (0.0, -1.0, float("nan"), "0.1"):
        with rejected("setting.invalid"):
            Settings(grid=wrong)  # type: ignore[arg-type]


@pytest.mark.slow
def test_needles_on_a_coarse_grid_end_in_an_error() -> None:
    """Hulls of three corners have none to drop, which went on for ever."""
    fine = Mesh.from_loops([[(0, y), (500, y + 0.5), (0, y + 1)] for y in (0, 20)])
    try:
        assert is_on_grid(nested_cages(fine, 6, convex=True, grid=5.0)[0].cage, 5.0)
    except NestingError as error:
        assert error.code == "numbers.no_room"


@pytest.mark.parametrize("seed", slow_after(0, range(30), thorough_after=2))
def test_random_outlines_have_cages_on_coarse_grids(seed: int) -> None:
    """A larger count may cost a little more on a grid, a finer grid hardly anything."""
    fine = simple(np.random.default_rng(seed), 12, 60)
    boxes = [np.prod(np.ptp(fine.vertices, axis=0) + 2.0 * grid) for grid in (0.1, 0.02)]
    for grid, box in zip((0.1, 0.02), boxes, strict=True):
        for count in (4, 9):
            level = nested_cages(fine, count, grid=grid)[0]
            assert_on_grid(level, grid)
            assert len(level.cage.vertices) <= count and level.cage.area <= box * 1.001


# Numbers that programs store


@pytest.mark.parametrize("kind", slow_after(1, ["float32", "float16"]))
@pytest.mark.parametrize("inside", [False, True])
def test_every_step_is_stored_without_rounding(kind: str, inside: bool) -> None:
    """Far enough from the origin that rounding counts."""
    fine = letter_a().moved((letter_a().vertices + np.array([30.0, -7.0])).astype(kind).astype(float))
    level = (core.inner_cages if inside else nested_cages)(fine, 20, stored=kind, clearance=0.05, loops="keep")[0]
    assert level.report.stored == kind and len(level.cage.vertices) == 20
    steps = level.reinflation.cage_steps, level.reinflation.fine_steps
    for points in (level.cage.vertices, level.coarse.vertices, level.flow.steps, *steps):
        assert np.array_equal(points, np.asarray(points).astype(kind))
    outer, inner = (fine, level.cage) if inside else (level.cage, fine)
    assert verify(outer, inner, level.report.wanted_clearance)
    assert core.verify_motion(*((fine, level.cage, *steps[::-1]) if inside else (level.cage, fine, *steps)))
    assert (level.reinflation.fine_steps[-1] == fine.vertices).all()


@pytest.mark.slow
def test_grid_and_stored_numbers_go_together_and_no_other_types_are_known() -> None:
    level = nested_cages(letter_a(), 20, stored=np.float32, grid=0.125)[0]
    assert is_on_grid(level.cage, 0.125)
    assert np.array_equal(level.cage.vertices, level.cage.vertices.astype(np.float32))
    assert nested_cages(letter_a(), 20, stored=np.float64)[0].report.stored is None
    for wrong in ("int8", "double double", 3):
        with rejected("setting.invalid"):
            Settings(stored=wrong)  # type: ignore[arg-type]


# Writing and reading


@pytest.mark.parametrize(
    ("seed", "decimals", "place"),
    slow_after(1, [(0, 2, 123.0), (1, 1, 0.0), (2, 4, -40_000.0), (3, 7, 123.0), (4, 3, 0.0)], thorough_after=3),
)
def test_every_grid_cage_survives_writing_and_reading(seed: int, decimals: int, place: float) -> None:
    fine = simple(np.random.default_rng(seed), 40, 41)
    fine = Mesh(fine.vertices + place, fine.edges)
    level = nested_cages(fine, 9, grid=10.0**-decimals)[0]
    assert_on_grid(level, 10.0**-decimals)
    cage, clearance = level.cage, level.report.wanted_clearance
    for read in (
        core.from_geojson(core.to_geojson(cage, decimals=decimals)),
        core.from_svg(core.to_svg({"drawing": fine, "cage": cage}, decimals=decimals), element="cage"),
        core.from_svg(core.to_svg(cage, y_up=False, decimals=decimals)),
    ):
        assert {tuple(row) for row in read.vertices.tolist()} == {tuple(row) for row in cage.vertices.tolist()}
        assert verify(read, fine, clearance)
    # and with that many decimals, as other programs write
    assert [[float(f"{x:.{decimals}f}") for x in row] for row in cage.vertices.tolist()] == cage.vertices.tolist()


@pytest.mark.slow
def test_the_command_writes_so_many_decimals(tmp_path: Path) -> None:
    source, out, report = (tmp_path / name for name in ("star.geojson", "cages.geojson", "report.json"))
    source.write_text(core.to_geojson(star()))
    asked = [str(source), "--levels", "20", "--grid", "0.01", "-o", str(out), "--report", str(report), "--quiet"]
    for inside in ([], ["--inside"]):
        assert run(*asked, *inside).status == 0
        cage = core.from_geojson(out.read_text())
        assert is_on_grid(cage, 0.01) and (verify(star(), cage) if inside else verify(cage, star()))
        assert json.loads(report.read_text())["inputs"][0]["shapes"][0]["levels"][0]["grid"] == 0.01
    assert run(str(source), "--levels", "20", "--grid", "0").status == 2


@pytest.mark.slow
def test_a_picture_in_whole_pixels() -> None:
    y, x = np.mgrid[:40, :60]
    picture = (np.hypot((x - 30) / 25.0, (y - 20) / 15.0) < 1.0).astype(float)
    outline = core.collision_outline(picture, 8, settings=Settings(grid=1))
    assert is_on_grid(outline, 1.0) and outline.area < 1.2 * picture.sum()
    assert core.to_geojson(outline, decimals=0)
