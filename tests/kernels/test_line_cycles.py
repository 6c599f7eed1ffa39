"""Line cycles: turns and best cycles against all that are possible, cages of convex shapes against the optimum."""

from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import pytest
import shapely

from nestedcages_core import LineCycles, Mesh, nested_cages
from nestedcages_core.decimation.cycle_search import OFFSET, CycleSearch
from nestedcages_core.decimation.outline import Lines, Outline
from nestedcages_core.decimation.problem import Problem
from nestedcages_core.decimation.turns import SLACK
from nestedcages_core.decimation.visibility import Obstacles
from support.marks import slow_after
from support.shapes import annulus, assert_nested, comb, islands, jagged, letter_a, polygon, ring, star

NOTCHED = Mesh.from_loops([[(0, 0), (4, 0), (4, 3), (2.5, 3), (2, 1), (1.5, 3), (0, 3)]])
SHAPES = {"notched": NOTCHED, "star": star(3, 12), "pair": Mesh.from_loops([ring(7), ring(5) + 2.2])}


def cross(u: Any, v: Any) -> float:
    return float(u[0] * v[1] - u[1] * v[0])


# The search around one loop


class Searched(NamedTuple):
    """A search around a loop: all that these tests know of it."""

    outline: np.ndarray
    """(n, 2) the loop."""
    place: np.ndarray
    """(K,) of each line, where it touches the loop: an edge's number, and the part of the edge."""
    point: np.ndarray
    """(K, 2) a point on each line."""
    direction: np.ndarray
    """(K, 2)."""
    free: np.ndarray
    """(2, K) how far each line is free of the shape, ahead and behind."""
    turn: dict[tuple[int, int], tuple[float, float, float]]
    """Pairs of lines that may follow each other: the distances to where they meet, and the area."""
    totals: np.ndarray
    """The least area for each number of lines."""
    cycle: Any
    """A function of a number of lines: the best cycle."""
    within: Any
    """A function of what is free: the areas of turns, infinite where one is not."""


@pytest.fixture(scope="module", params=SHAPES)
def searches(request: pytest.FixtureRequest) -> list[Searched]:
    """Those around a small shape."""
    problem = Problem.of(SHAPES[request.param], 5 * len(SHAPES[request.param].loops))
    around = CycleSearch(problem, problem.outline, np.full(len(problem.outline.sizes), OFFSET))
    around.search()
    found = []
    for loop, search in around.searches.items():
        lines, turns = search.lines, search.turns
        pairs = zip(turns.source.tolist(), turns.target.tolist(), strict=True)
        data = zip(turns.forth.tolist(), turns.back.tolist(), turns.area.tolist(), strict=True)
        turn = dict(zip(pairs, data, strict=True))
        found.append(
            Searched(
                around.loops.split()[loop], lines.place - around.loops.begins[loop], lines.point, lines.direction,
                search.free, turn, search.totals, search.cycle, turns.within,
            )
        )  # fmt: skip
    return found


def test_turns_are_the_pairs_of_lines_that_meet_where_both_are_free(searches: list[Searched]) -> None:
    """Each pair by itself: where they meet, whether that is ahead of one and behind the other, and the area."""
    for search in searches:
        random, count, size = np.random.default_rng(1), len(search.point), len(search.outline)
        some = random.permutation(list(search.turn))[:250].tolist()
        judged = 0
        for i, j in {*map(tuple, some), *map(tuple, random.integers(0, count, (250, 2)).tolist())}:
            p, q, u, v = search.point[i], search.point[j], search.direction[i], search.direction[j]
            sine = cross(u, v)
            if i == j or abs(sine) < 1e-6:
                continue
            forth, back = cross(q - p, v) / sine, cross(u, q - p) / sine
            at = p + forth * u
            edges = [int(np.floor(search.place[k])) for k in (i, j)]
            feet = [
                search.outline[e] + (search.place[k] - e) * (search.outline[(e + 1) % size] - search.outline[e])
                for k, e in zip((i, j), edges, strict=True)
            ]
            steps = edges[1] - edges[0] + (size if j < i else 0)
            passed = [search.outline[(edges[0] + 1 + k) % size] for k in range(steps)]
            outline = np.array([feet[0], p, at, q, feet[1], *passed[::-1]])
            outline = outline - outline[0]
            ahead = np.roll(outline, -1, axis=0)
            area = 0.5 * float((outline[:, 0] * ahead[:, 1] - outline[:, 1] * ahead[:, 0]).sum())
            margins = [forth + SLACK, back + SLACK, search.free[0][i] - forth, search.free[1][j] - back, area]
            if min(map(abs, margins)) < 2e-6:
                continue  # decided by single precision
            judged += 1
            assert ((i, j) in search.turn) == (min(margins) > 0.0), (margins, i, j)
            if (i, j) in search.turn:
                assert search.turn[i, j] == pytest.approx((forth, back, area), rel=1e-4, abs=1e-6)
        assert judged > 100


def test_what_is_free_of_either_line_bounds_a_turn(searches: list[Searched]) -> None:
    for search in searches:
        (i, j), (forth, back, area) = np.array(list(search.turn)).T, np.array(list(search.turn.values())).T
        less = search.free * np.random.default_rng(2).random(search.free.shape)
        open_ = (forth <= less[0][i]) & (back <= less[1][j])
        np.testing.assert_array_equal(search.within(less), np.where(open_, area, np.inf))


def test_cycles_are_the_best_of_all(searches: list[Searched]) -> None:
    """Every number of lines, through every line: none has less area, and the one that is used has the least."""
    for search in searches:
        count, most = len(search.point), len(search.totals) - 1
        cost = np.full((count, count), np.inf)
        for (i, j), (forth, back, area) in search.turn.items():
            if forth <= search.free[0][i] and back <= search.free[1][j]:
                cost[i, j] = area
        best = np.full(most + 1, np.inf)
        for start in range(count):
            order = (start + np.arange(count)) % count
            turned = cost[np.ix_(order, order)]
            onwards = np.where(np.triu(np.ones((count, count), bool), 1), turned, np.inf)
            path = np.where(np.arange(count) == 0, 0.0, np.inf)
            for number in range(1, most + 1):
                best[number] = min(best[number], float((path + turned[:, 0]).min()) if number > 1 else np.inf)
                path = (path[:, None] + onwards).min(axis=0)
        assert np.isfinite(search.totals).any()
        for number, total in enumerate(search.totals.tolist()):
            if np.isfinite(total):
                assert best[number] - 1e-5 <= total <= 1.02 * best[number] + 1e-5
                cycle = search.cycle(number)
                assert len(cycle) == number
                assert (np.diff(cycle) > 0).all()
                around = zip(cycle, np.roll(cycle, -1), strict=True)
                assert sum(cost[a, b] for a, b in around) == pytest.approx(total, rel=1e-4, abs=1e-5)


@pytest.mark.parametrize("distance", [0.3, 0.03])
def test_lines_run_until_they_come_too_close(distance: float) -> None:
    """From any place in any direction, next to a solid with a hole, by shapely."""
    fine, random = Mesh.from_loops([ring(7), ring(5, 0.6)]), np.random.default_rng(4)
    problem, solid, turn = Problem.of(fine, 6), polygon(fine), random.uniform(0.0, 2.0 * np.pi, 150)
    directions = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    lines = Lines.of(random.uniform(-1.6, 1.6, (150, 2)), np.zeros(150), directions)
    obstacles, reach, far = (
        Obstacles(Outline(problem.outline), problem.regions),
        np.full(150, 3.0),
        np.full(150, distance),
    )
    free = np.max([obstacles.free(lines, reach, np.full(150, loop), far) for loop in (0, 1)], axis=0)
    for k, way in np.ndindex(150, 2):
        start, length = lines.point[k], free[way, k]
        assert (length < 0.0) == (solid.distance(shapely.Point(start)) < distance)
        run = shapely.LineString([start, start + (1 - 2 * way) * max(length, 0.0) * directions[k]])
        left = solid.distance(run) - distance
        assert length < 0.0 or abs(left) < 1e-9 or (length == 3.0 and left > 0.0)


# Convex shapes, whose tightest polygon of k edges has all but one of them flush (DePano & Aggarwal 1984)


def meeting(p: np.ndarray, u: np.ndarray, q: np.ndarray, v: np.ndarray) -> np.ndarray | None:
    """Where two lines (point, direction) meet, if the second turns left."""
    sine = cross(u, v)
    return p + cross(q - p, v) / sine * u if sine > 1e-9 else None


def area_of(lines: list[tuple[np.ndarray, np.ndarray]], inside: shapely.Polygon) -> float:
    """Of the polygon that lines in order of their directions bound; infinite if it does not hold the shape."""
    corners = [meeting(*one, *other) for one, other in zip(lines, lines[1:] + lines[:1], strict=True)]
    if any(corner is None for corner in corners):
        return np.inf
    polygon = shapely.Polygon(corners)
    return float(polygon.area) if polygon.is_valid and polygon.buffer(1e-9).contains(inside) else np.inf


def least_area(hull: np.ndarray, count: int) -> float:
    """Of all polygons of at most `count` edges around a convex one (n, 2), by trying them."""
    inside, n = shapely.Polygon(hull), len(hull)
    flush = [(hull[k], hull[(k + 1) % n] - hull[k]) for k in range(n)]
    best = np.inf
    for chosen in (c for size in (count - 1, count) for c in combinations(range(n), size) if size > 2 or size < count):
        lines = [flush[k] for k in chosen]
        if len(lines) > 2:
            best = min(best, area_of(lines, inside))
        if len(lines) < count:
            for place, (first, second) in enumerate(zip(chosen, (*chosen[1:], chosen[0] + n), strict=True)):
                for vertex in hull[[k % n for k in range(first + 1, second + 1)]]:
                    # the free edge has its middle at the vertex: its end is on the mirror image of the other line
                    (p, u), (q, v) = lines[place], lines[(place + 1) % len(lines)]
                    sine = cross(v, u)
                    if abs(sine) > 1e-9:
                        end = q + cross(2.0 * vertex - p - q, u) / sine * v
                        free = (vertex, 2.0 * (end - vertex))
                        best = min(best, area_of([*lines[: place + 1], free, *lines[place + 1 :]], inside))
    return best


CONVEX = {
    "7 corners": [(0, 0), (3, -1), (5, 0), (6, 2), (5, 4), (2, 5), (-1, 3)],
    "half disc": [*ring(16)[:9].tolist(), (0.0, -0.2)],
    "wedge": [(0, 0), (4, 0.3), (7, 1), (7.5, 1.6), (4, 2), (0, 1.5), (-0.3, 0.7)],
}


def convex(seed: int) -> np.ndarray:
    """A random polygon with nine corners."""
    random = np.random.default_rng(seed)
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, 9))
    return np.stack([np.cos(turn), np.sin(turn)], axis=1) * [1.0, random.uniform(0.3, 1.0)]


@pytest.mark.parametrize("count", [3, 4, 5])
@pytest.mark.parametrize("shape", [*CONVEX, *slow_after(0, range(6)), *slow_after(0, range(6, 60), thorough_after=0)])
def test_cages_of_convex_shapes_are_the_tightest_of_all(shape: str | int, count: int) -> None:
    hull = np.array(CONVEX[shape], float) if isinstance(shape, str) else convex(shape)
    best = least_area(hull, count)
    fine = Mesh.from_loops([hull])
    start = LineCycles(on_curve=False).decimate(fine, count)
    assert len(start.vertices) == count
    assert best * (1.0 - 1e-9) <= start.area <= 1.03 * best
    (level,) = nested_cages(fine, count)
    assert best * (1.0 - 1e-9) <= level.cage.area <= (1.002 if shape in CONVEX else 1.03) * best


# Around shapes of several loops, next to each other and in each other


NEXT_TO = Mesh.from_loops([jagged(np.random.default_rng(2), 40), 0.9 * jagged(np.random.default_rng(3), 30) + 1.9])
HOOKED = Mesh.from_loops(
    [[(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)], [(2, 2), (5, 2), (5, 5), (4, 5), (4, 3), (2, 3)]]
)
CASES = [(letter_a(), 24), (islands(), 20), (comb(3, 0.02), 20), (annulus(80), 7), (NEXT_TO, 16), (HOOKED, 12)]
MORE = [(letter_a(), 70), (islands(), 60), (comb(6, 0.001), 14), (star(15, 300), 31)]


@pytest.mark.parametrize(("shape", "count"), slow_after(len(CASES), [*CASES, *MORE]))
@pytest.mark.parametrize("clearance", [0.0, 0.05])
def test_cycles_enclose_loop_by_loop_and_do_not_cross(shape: Mesh, count: int, clearance: float) -> None:
    coarse = LineCycles(on_curve=False).decimate(shape, count, clearance=clearance)
    assert len(coarse.vertices) <= count
    assert_nested(coarse, shape)
    for k in range(len(shape.loops)):
        one, other = (shapely.Polygon(mesh.vertices[mesh.loops[k]]) for mesh in (coarse, shape))
        assert one.contains(other) if shape.loop_signs[k] > 0 else other.contains(one)


@pytest.mark.parametrize(("seed", "count", "area"), [(10, 16, 12.942), (16, 9, 9.313)])
def test_of_lines_that_cross_the_farther_give_way(seed: int, count: int, area: float) -> None:
    """The areas are those that were reached."""
    random = np.random.default_rng(seed)
    places = [(1.6 * (k % 2), 1.7 * (k // 2)) for k in range(int(random.integers(2, 5)))]
    fine = Mesh.from_loops([jagged(random, int(random.integers(6, 40))) + place for place in places])
    assert LineCycles(on_curve=False).decimate(fine, count).area <= 1.001 * area


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(300))
def test_cycles_around_random_shapes(seed: int) -> None:
    random = np.random.default_rng(seed)
    loops = [jagged(random, int(random.integers(5, 60))) for _ in range(2)]
    loops[1] += [2.02, 0.3]
    fine = Mesh.from_loops(loops[: int(random.integers(1, 3))])
    count = min(4 * len(fine.loops) + int(random.integers(0, 30)), len(fine.vertices))
    coarse = LineCycles(on_curve=False).decimate(fine, count)
    assert_nested(coarse, fine)
