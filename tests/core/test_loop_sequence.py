"""Cages around the best of a sequence of outlines: what a box satisfies has one, more vertices are not looser."""

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import AxisAligned, Box, Level, Mesh, Settings, check, collision_outline, nested_cages, verify
from support.families import OF_SEVERAL_LOOPS, courtyard, drawing, plate, rings, row, scattered
from support.judging import is_along_the_axes, is_on_grid, lengths_of, sharpest
from support.marks import slow_after
from support.shapes import polygon, ring

pytestmark = pytest.mark.slow

SLACK = 1.005
"""Factor on the excess that a cage of more vertices may have."""


def boxed(*corners: float) -> np.ndarray:
    return np.array(shapely.box(*corners).exterior.coords)[:-1]


def caged(shape: Any, count: int, *, has_shapely: bool = True, **options: Any) -> Level:
    """A level, with shapely or without."""
    fine = Mesh.of(shape)
    with pytest.MonkeyPatch.context() as patch:
        if not has_shapely:
            patch.setitem(sys.modules, "shapely", None)
        return nested_cages(fine, count, **options)[0]


# More vertices


def assert_never_looser(fine: Mesh, counts: Any, **options: Any) -> None:
    """Each cage has about the least excess of those with as many vertices or fewer."""
    best = np.inf
    for count in counts:
        level = nested_cages(fine, count, **options)[0]
        assert len(level.cage.vertices) <= count
        assert level.excess <= SLACK * best + 1e-6, (count, level.report.lost)
        best = min(best, level.excess)


STARS = [
    [(3, 1), (1, 2), (2, 3), (1, 4), (3, 5), (5, 4), (4, 3), (5, 2)],
    [(7, 1), (5, 2), (6, 3), (5, 4), (7, 5), (9, 4), (8, 3), (9, 2)],
]
LOOSER_ONCE: dict[str, tuple[Any, tuple[int, ...], dict[str, Any]]] = {
    "a courtyard": (Mesh.from_loops([boxed(0, 0, 10, 6), boxed(4, 2, 6, 4)]), (5, 6), {}),
    "stars that touch": (shapely.MultiPolygon([shapely.Polygon(star) for star in STARS]), (10, 12), {}),
    "bolt holes": (
        Mesh.from_loops(
            [
                np.array([(0, 0), (20, 0), (20, 8), (14, 8), (14, 10), (6, 10), (6, 8), (0, 8)]),
                *(ring(24, 0.3, 0.0, place) for place in ((1, 1), (19, 1), (1, 7), (19, 7))),
            ]
        ),
        (17, 19),
        {},
    ),
    "needles": (drawing(7), (24, 27, 30, 35), {}),
    "a dotted square on a grid": (
        shapely.box(0.0, 0.0, 8.0, 8.0).segmentize(2.0),
        (4, 12),
        {"grid": 1.0},
    ),
}  # fmt: skip


@pytest.mark.parametrize(("shape", "counts", "options"), LOOSER_ONCE.values(), ids=LOOSER_ONCE.keys())
def test_a_few_more_vertices_are_not_looser(shape: Any, counts: tuple[int, ...], options: dict[str, Any]) -> None:
    assert_never_looser(shape, counts, **options)


@pytest.mark.parametrize("seed", slow_after(0, range(8), thorough_after=1))
def test_holes_are_filled_where_that_is_best(seed: int) -> None:
    """Of a head with eyes, a mouth and ears, next to all choices of holes; the ears stay where they are."""
    random = np.random.default_rng(seed)
    holes = [ring(12, random.uniform(0.06, 0.2), 0.0, place) for place in ((-0.35, 0.3), (0.35, 0.3), (0.0, -0.4))]
    parts = [ring(40), *(ring(14, random.uniform(0.15, 0.3), 0.0, (x, 0.3)) for x in (-1.7, 1.7))]
    area = Mesh.from_loops([*parts, *holes]).area
    for count in (14, 20):
        level = nested_cages([*parts, *holes], count)[0]
        least = np.inf
        for chosen in range(8):
            kept = [hole for k, hole in enumerate(holes) if chosen >> k & 1]
            if count >= 3 * (3 + len(kept)):
                least = min(least, nested_cages([*parts, *kept], count, loops="keep")[0].cage.area)
        assert level.cage.area <= least + 0.01 * (least - area)


@pytest.mark.parametrize("size", [1e-7, 1e-5, 1e-3])
def test_holes_without_room_cost_no_vertices(size: float) -> None:
    two = [ring(40), ring(40, centre=(2.5, 0.0))]
    specks = [np.array([(x, 0.4), (x + size, 0.4), (x, 0.4 + size)]) for x in (0.3, -0.2, 2.2)]
    assert nested_cages([*two, *specks], 24)[0].cage.area <= SLACK * nested_cages(two, 24)[0].cage.area


@pytest.mark.slow
def test_more_vertices_around_a_sprite_on_whole_pixels_are_not_looser() -> None:
    y, x = np.mgrid[:32, :32]
    disc = (x - 15.5) ** 2 + (y - 15.5) ** 2 < 14**2
    few, many = (collision_outline(disc, count, settings=Settings(grid=1.0)) for count in (16, 64))
    assert many.area <= few.area


@pytest.mark.thorough
def test_two_hundred_loops_are_joined_to_some_not_to_one() -> None:
    discs = [ring(20, 1.0, 0.0, (2.5 * (k % 20), 2.5 * (k // 20))) for k in range(200)]
    assert nested_cages(discs, 600)[0].excess < 0.45


COUNTS = (3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 17, 20, 24, 30, 40)


@pytest.mark.parametrize("seed", slow_after(1, range(12), thorough_after=2))
@pytest.mark.parametrize("kind", [courtyard, plate, row, scattered], ids=lambda kind: kind.__name__)
def test_more_vertices_are_never_looser(kind: Callable[..., Mesh], seed: int) -> None:
    fine = kind(np.random.default_rng(seed))
    assert_never_looser(fine, (8, 9) if seed == 0 else COUNTS[::2] if seed == 1 else COUNTS)


KEPT: dict[str, Callable[[Mesh], dict[str, Any]]] = {
    "grid": lambda fine: {"grid": float(f"{fine.diagonal / 50.0:.2g}")},
    "axes": lambda fine: {"constraints": [AxisAligned()]},
    "clearance": lambda fine: {"clearance": fine.diagonal / 12.0},
}


@pytest.mark.parametrize("seed", slow_after(0, range(12), thorough_after=1))
@pytest.mark.parametrize("kept", KEPT)
@pytest.mark.parametrize("kind", OF_SEVERAL_LOOPS, ids=lambda kind: kind.__name__)
def test_more_vertices_are_never_looser_with(kind: Callable[..., Mesh], kept: str, seed: int) -> None:
    fine = kind(np.random.default_rng(seed))
    assert_never_looser(fine, (6, 9, 20) if seed == 0 else COUNTS[1::2], **KEPT[kept](fine))


VALLEYS = [
    (row, 1, "grid", (30, 40, 100)),
    (rings, 6, "edge", (40, 55, 75)),
    (scattered, 0, "edge", (55, 75)),
    (plate, 5, "grid", (8, 17, 40, 100)),
    (row, 5, "grid", (24, 55)),
    (rings, 7, "edge", (55, 75)),
]
"""More vertices than a grid or a least edge has a use for."""


@pytest.mark.parametrize(("kind", "seed", "kept", "counts"), slow_after(0, VALLEYS, thorough_after=3))
def test_more_vertices_than_are_of_use_are_not_looser(
    kind: Callable[..., Mesh], seed: int, kept: str, counts: tuple[int, ...]
) -> None:
    fine = kind(np.random.default_rng(seed))
    options = {"min_edge": fine.diagonal / 20.0} if kept == "edge" else KEPT[kept](fine)
    assert_never_looser(fine, counts, **options)


BAY = np.array([(9, 1), (9, 9), (5, 9), (6, 7), (3, 4), (4, 3), (7, 5), (4, 2), (2, 4), (4, 6), (1, 9), (1, 1)])
"""A square with a crooked bay."""


@pytest.mark.parametrize("seed", range(6))
def test_edges_may_meet_anywhere_on_the_walls_of_a_bay(seed: int) -> None:
    sheared = np.random.default_rng(seed).uniform(-0.4, 0.4, (2, 2)) * (seed > 0)
    assert nested_cages(BAY @ (np.eye(2) + sheared), 7)[0].excess < 0.096  # areas keep their ratios


@pytest.mark.parametrize("seed", slow_after(0, range(12), thorough_after=1))
@pytest.mark.parametrize("kept", KEPT)
@pytest.mark.parametrize("kind", OF_SEVERAL_LOOPS, ids=lambda kind: kind.__name__)
def test_one_loop_is_not_tighter(kind: Callable[..., Mesh], kept: str, seed: int) -> None:
    fine = kind(np.random.default_rng(seed))
    for count in (6, 24) if seed == 0 else (6, 12, 24):
        level, one = (nested_cages(fine, count, loops=loops, **KEPT[kept](fine))[0] for loops in ("auto", "one"))
        assert level.excess <= 1.01 * one.excess


def test_one_loop_is_not_tighter_on_a_coarse_grid() -> None:
    fine, options = scattered(np.random.default_rng(47)), {"grid": 0.26, "constraints": [AxisAligned()]}
    level, one = (nested_cages(fine, 16, loops=loops, **options)[0] for loops in ("auto", "one"))
    assert level.excess <= 1.01 * one.excess


# What a box satisfies


SQUARES = [boxed(0.0, 0.0, 1.0, 1.0), boxed(1.001, 0.0, 2.0, 1.0)]
DISCS = [ring(16, 1.0, 0.0, centre) for centre in ((0.0, 0.0), (2.1, 0.0), (1.05, 1.9))]
REFUSED_ONCE: list[tuple[Any, int, dict[str, Any]]] = [
    (DISCS, 12, {"constraints": [AxisAligned()]}),
    (SQUARES, 7, {"clearance": 0.01}),
    ([ring(16), ring(16, 0.05)], 12, {"clearance": 0.1}),
    *((DISCS, n, {"constraints": [AxisAligned()]}) for n in (13, 20, 30)),
    *((SQUARES, n, {"clearance": 0.01}) for n in (8, 12)),
    *((SQUARES, n, {"grid": grid}) for n in (7, 8, 12) for grid in (0.1, 0.01)),
    *(([ring(16), ring(16, 0.05)], n, {"clearance": 0.1}) for n in (20, 30)),
]


@pytest.mark.parametrize(("shape", "count", "options"), slow_after(3, REFUSED_ONCE))
def test_what_a_box_satisfies_has_a_cage(shape: Any, count: int, options: dict[str, Any]) -> None:
    for has_shapely in (True, False):
        level = caged(shape, count, has_shapely=has_shapely, **options)
        assert len(level.cage.vertices) <= count and check(level.fine, level)


@pytest.mark.parametrize("seed", slow_after(1, range(12), thorough_after=2))
@pytest.mark.parametrize("kind", OF_SEVERAL_LOOPS, ids=lambda kind: kind.__name__)
def test_a_grid_has_cages_in_a_box_of_two_steps_more_than_the_drawing(kind: Callable[..., Mesh], seed: int) -> None:
    fine = kind(np.random.default_rng(seed))
    step = float(f"{fine.diagonal / 50.0:.2g}")
    low, high = fine.vertices.min(axis=0) - 2.0 * step, fine.vertices.max(axis=0) + 2.0 * step
    for count in (4, 8):
        cage = nested_cages(fine, count, grid=step, constraints=[Box(tuple(low), tuple(high))])[0].cage
        assert (cage.vertices >= low).all() and (cage.vertices <= high).all()


def requested(random: np.random.Generator, fine: Mesh) -> tuple[int, dict[str, Any]]:
    """A number of vertices and settings that an upright rectangle has, if large enough."""
    size, options = fine.diagonal, dict[str, Any]()
    if random.random() < 0.6:
        options["clearance"] = size * 10.0 ** random.uniform(-4.0, 0.5)
    numbers = random.random()
    if numbers < 0.35:
        options["grid"] = float(f"{size * 10.0 ** random.uniform(-3.0, -0.3):.2g}")
    elif numbers < 0.5:
        options["stored"] = np.float32
    which = random.random()
    if which < 0.3:
        options["constraints"] = [AxisAligned()]
    elif which < 0.5:
        options["min_edge"] = size * 10.0 ** random.uniform(-2.0, 0.0)
    elif which < 0.6:
        options["min_angle"] = random.uniform(5.0, 50.0)
    return int(random.choice([4, 5, 6, 7, 8, 10, 12, 16, 24, 40])), options


QUICK = [(courtyard, 1), (plate, 0), (row, 1), (scattered, 1), (None, 0)]
"""A kind, or any drawing, and a seed."""
REQUESTS = [*QUICK, *((kind, seed) for seed in range(2, 60) for kind in (*OF_SEVERAL_LOOPS, None))]


@pytest.mark.parametrize("has_shapely", [True, False], ids=["with shapely", "without"])
@pytest.mark.parametrize(("kind", "seed"), slow_after(len(QUICK), REQUESTS, thorough_after=14))
def test_random_requests_that_a_box_satisfies_have_cages(
    kind: Callable[..., Mesh] | None, seed: int, has_shapely: bool
) -> None:
    random = np.random.default_rng(seed)
    fine = drawing(int(random.integers(10_000))) if kind is None else kind(random)
    count, options = requested(random, fine)
    level = caged(fine, count, has_shapely=has_shapely, **options)
    clearance = options.get("clearance", 0.0)
    assert len(level.cage.vertices) <= count and verify(level.cage, fine, clearance, same_loops=False)
    assert "constraints" not in options or is_along_the_axes(level.cage)
    assert "grid" not in options or is_on_grid(level.cage, options["grid"])
    side, grid = options.get("min_edge", 0.0), options.get("grid", 0.0)
    assert lengths_of(level.cage).min() >= side
    assert sharpest(level.cage) >= options.get("min_angle", 0.0)
    sides = np.ptp(fine.vertices, axis=0) + 2.0 * (clearance or 1e-5 * fine.diagonal) + 2.0 * grid
    assert level.cage.area <= 1.01 * np.maximum(sides, side + grid).prod()


# Large clearances


def round_buffer(fine: Mesh, distance: float) -> float:
    """The area within a distance."""
    return float(polygon(fine).buffer(distance, quad_segs=64).area)


WIDE = {"square": boxed(0.0, 0.0, 1e4, 1e4), "reef": np.array([(0.0, 0.0), (1.0, 0.02), (1.0, -0.02)])}


@pytest.mark.parametrize(("name", "clearance"), [("square", 5e4), ("reef", 0.05)])
def test_a_cage_may_have_more_vertices_than_the_drawing(name: str, clearance: float) -> None:
    level = nested_cages(WIDE[name], 16, clearance=clearance)[0]
    assert len(level.cage.vertices) == 16 and level.cage.area <= 1.05 * round_buffer(level.fine, clearance)


@pytest.mark.parametrize("seed", slow_after(1, range(40), thorough_after=3))
@pytest.mark.parametrize("kind", OF_SEVERAL_LOOPS, ids=lambda kind: kind.__name__)
def test_far_away_a_cage_is_as_tight_as_around_a_disc(kind: Callable[..., Mesh], seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = kind(random)
    clearance, count = fine.diagonal * 10.0 ** random.uniform(-0.5, 1.0), int(random.choice([12, 16, 24, 32]))
    circumscribed = count / np.pi * np.tan(np.pi / count)
    level = nested_cages(fine, count, clearance=clearance)[0]
    assert level.cage.area <= 1.02 * circumscribed * round_buffer(fine, clearance)
