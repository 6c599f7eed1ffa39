"""Line cycles against what is worked out one by one: turns, best cycles, crossings, what gives way, shifts, hulls."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh
from nestedcages_core.decimation.hull.outer_hull import OuterHull
from nestedcages_core.decimation.line_cycles import loop_search, method
from nestedcages_core.decimation.line_cycles.chain import Lines
from nestedcages_core.decimation.line_cycles.crossings import Choice
from nestedcages_core.decimation.line_cycles.giving_way import SHORTENED, give_way
from nestedcages_core.decimation.line_cycles.loop_search import LoopSearch, NoCyclesError
from nestedcages_core.decimation.line_cycles.method import SOURCE, cycles_around
from nestedcages_core.decimation.line_cycles.turns import SLACK, Turns
from nestedcages_core.decimation.request import Request
from nestedcages_core.tasks import drain
from support.shapes import ring, star

NOTCHED = Mesh.from_loops([[(0, 0), (4, 0), (4, 3), (2.5, 3), (2, 1), (1.5, 3), (0, 3)]])
SHAPES = {"notched": NOTCHED, "star": star(3, 12), "pair": Mesh.from_loops([ring(7), ring(5) + 2.2])}


def cross(u: Any, v: Any) -> float:
    return float(u[0] * v[1] - u[1] * v[0])


@pytest.fixture(params=SHAPES)
def searches(request: Any, monkeypatch: pytest.MonkeyPatch) -> list[tuple[LoopSearch, np.ndarray, Turns]]:
    """The searches around a small shape, what was free of their lines when turns were sought, and these."""
    seen: list[tuple[LoopSearch, np.ndarray, Turns]] = []
    true = LoopSearch.__init__

    def watched(self: LoopSearch, chain: Any, lines: Any, free: np.ndarray, **options: Any) -> None:
        before = free.copy()
        true(self, chain, lines, free, **{**options, "width": len(lines) - 1})  # any line may follow any
        seen.append((self, before, self.turns))

    monkeypatch.setattr(loop_search.LoopSearch, "__init__", watched)
    fine = SHAPES[request.param]
    drain(cycles_around(Request.of(fine, 5 * len(fine.loops)), 0.0))
    return seen


def test_turns_are_the_pairs_of_lines_that_meet_where_both_are_free(searches: Any) -> None:
    """Each pair by itself: where they meet, whether that is ahead of one and behind the other, and the area."""
    for search, free, turns in searches:
        chain, lines = search.chain, search.lines
        found = {(i, j): k for k, (i, j) in enumerate(zip(turns.source.tolist(), turns.target.tolist(), strict=True))}
        random, count = np.random.default_rng(1), len(lines)
        some = random.permutation(list(found))[:250].tolist()
        pairs = {*map(tuple, some), *map(tuple, random.integers(0, count, (250, 2)).tolist())}
        for i, j in pairs:
            p, q, u, v = lines.point[i], lines.point[j], lines.direction[i], lines.direction[j]
            sine = cross(u, v)
            if i == j or abs(sine) < 1e-6:
                continue
            forth, back = cross(q - p, v) / sine, cross(u, q - p) / sine
            at = p + forth * u
            edges = [np.floor(x) for x in (lines.place[i], lines.place[j])]
            feet = [
                chain.vertices[int(e)] + (x - e) * chain.edges[int(e)]
                for e, x in zip(edges, (lines.place[i], lines.place[j]), strict=True)
            ]
            first, last = int(edges[0]) + 1, int(edges[1])
            steps = (last - first + 1) + (chain.size if j < i else 0)
            passed = [chain.vertices[(first + k) % chain.size] for k in range(steps)]
            outline = np.array([feet[0], p, at, q, feet[1], *passed[::-1]])
            outline = outline - outline[0]
            ahead = np.roll(outline, -1, axis=0)
            area = 0.5 * float((outline[:, 0] * ahead[:, 1] - outline[:, 1] * ahead[:, 0]).sum())
            margins = [forth + SLACK, back + SLACK, free[0][i] - forth, free[1][j] - back, area]
            if min(map(abs, margins)) < 2e-6:
                continue  # decided by single precision
            assert ((i, j) in found) == (min(margins) > 0.0), (margins, i, j)
            if (i, j) in found:
                assert turns.forth[found[i, j]] == pytest.approx(forth, abs=1e-9)
                assert turns.back[found[i, j]] == pytest.approx(back, abs=1e-9)
                assert turns.area[found[i, j]] == pytest.approx(area, rel=1e-4, abs=1e-6)


def test_what_is_free_of_either_line_bounds_a_turn(searches: Any) -> None:
    random = np.random.default_rng(2)
    for _, free, turns in searches:
        less = free * random.random(free.shape)
        open_ = np.isfinite(turns.within(less))
        for k in range(len(open_)):
            kept = turns.forth[k] <= less[0, turns.source[k]] and turns.back[k] <= less[1, turns.target[k]]
            assert open_[k] == kept


def test_cycles_are_the_best_of_all(searches: Any) -> None:
    """Every number of lines, through every line: none has less area, and the one that is used has the least."""
    for search, _, turns in searches:
        count, most = len(search.lines), search.sizes.stop - 1
        cost = np.full((count, count), np.inf)
        cost[turns.source, turns.target] = turns.within(search.free)
        best = np.full(most + 1, np.inf)
        for start in range(count):
            order = (start + np.arange(count)) % count
            turned = cost[np.ix_(order, order)]
            onwards = np.where(np.triu(np.ones((count, count), bool), 1), turned, np.inf)
            path = np.where(np.arange(count) == 0, 0.0, np.inf)
            for number in range(1, most + 1):
                best[number] = min(best[number], float((path + turned[:, 0]).min()) if number > 1 else np.inf)
                path = (path[:, None] + onwards).min(axis=0)
        for number, total in enumerate(search.totals.tolist()):
            if np.isfinite(total):
                assert best[number] - 1e-5 <= total <= 1.02 * best[number] + 1e-5
                cycle = search.cycle(number)
                assert len(cycle) == number and (np.diff(cycle) > 0).all()
                around = zip(cycle, np.roll(cycle, -1), strict=True)
                assert sum(cost[a, b] for a, b in around) == pytest.approx(total, rel=1e-4, abs=1e-5)


def choice_of(rings: list[np.ndarray], contacts: list[np.ndarray] | None = None) -> Choice:
    starts, ends = np.concatenate(rings), np.concatenate([np.roll(each, -1, axis=0) for each in rings])
    direction = (ends - starts) / np.hypot(*(ends - starts).T)[:, None]
    point = 0.5 * (starts + ends) if contacts is None else np.concatenate(contacts)
    loop = np.repeat(np.arange(len(rings)), [len(each) for each in rings])
    line = np.concatenate([np.arange(len(each)) for each in rings])
    return Choice(rings, loop, line, point, direction, starts, ends, None)


def test_crossings_are_those_of_all_pairs() -> None:
    random = np.random.default_rng(3)
    for _ in range(30):
        rings = [random.random((int(random.integers(3, 7)), 2)) + random.random(2) for _ in range(2)]
        choice = choice_of(rings)
        size = [len(rings[k]) for k in choice.loop]
        expected = set()
        for a, b in combinations(range(len(choice.start)), 2):
            gap = (b - a) % size[a]
            beside = choice.loop[a] == choice.loop[b] and gap in (1, size[a] - 1)
            one, other = (shapely.LineString([choice.start[k], choice.end[k]]) for k in (a, b))
            if not beside and one.intersects(other):
                expected.add((a, b))
        i, j = choice.crossings()
        assert {(min(pair), max(pair)) for pair in zip(i.tolist(), j.tolist(), strict=True)} == expected


@pytest.mark.parametrize(("bias", "yields"), [(1.0, 1), (0.1, 1), (10.0, 0)])
def test_the_line_whose_contact_is_farther_gives_way(bias: float, yields: int) -> None:
    """Two triangles: an edge of the first crosses one of the second, 0.3 from its contact and 0.5 from the other's."""
    one = np.array([(0.0, 0.0), (1.0, 0.0), (0.5, 1.0)])
    other = np.array([(0.6, -1.0), (0.6, 0.8), (3.0, 0.0)])
    contacts = [0.5 * (each + np.roll(each, -1, axis=0)) for each in (one, other)]
    contacts[0][0], contacts[1][0] = (0.3, 0.0), (0.6, -0.5)
    choice = choice_of([one, other], contacts)
    searches = {}
    for k in range(2):
        own = choice.loop == k
        lines = Lines.of(choice.point[own], np.arange(3.0), choice.direction[own])
        searches[k] = SimpleNamespace(lines=lines, free=np.full((2, 3), 9.0), share=lambda: None)
    changed = give_way(searches, choice, np.array([0]), np.array([3]), bias)  # type: ignore[arg-type]
    assert changed == {yields}
    expected = np.full((2, 3), 9.0)
    expected[0, 0] = SHORTENED * (0.3, 0.5)[yields] - SLACK
    assert np.allclose(searches[yields].free, expected)
    assert (searches[1 - yields].free == 9.0).all()


def result_of(result: Any) -> Any:
    return result
    yield


def test_only_blocked_loops_lose_their_shift(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[np.ndarray] = []
    fine = Mesh.from_loops([ring(6), ring(6) + 4.0, ring(6) + 8.0])

    def blocked(request: Any, outline: Any, shift: np.ndarray) -> Any:
        tried.append(np.array(shift))
        if len(tried) == 1:
            raise NoCyclesError.around([1])
        return (yield from result_of((fine, 0)))

    monkeypatch.setattr(method, "_best", blocked)
    drain(cycles_around(Request.of(fine, 12), 0.5))
    assert (tried[1] < tried[0]).tolist() == [False, True, False]
    assert tried[1][1] == method.HULL_OFFSET


@pytest.mark.parametrize(("rounds", "smaller", "hull"), [(1, True, True), (1, False, False), (0, True, False)])
def test_where_cycles_crossed_the_smaller_of_them_and_the_hull_is_taken(
    rounds: int, smaller: bool, hull: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    inner, outer = (Mesh.from_loops([size * ring(6)]) for size in (2.0, 3.0))
    cycles, of_hull = (outer, inner) if smaller else (inner, outer)
    monkeypatch.setattr(method, "cycles_around", lambda *_: result_of((cycles, rounds)))
    monkeypatch.setattr(OuterHull, "hull", lambda *_: result_of(of_hull))
    mesh, source = drain(method._found(Request.of(Mesh.from_loops([ring(12)]), 6), 0.0))
    assert (mesh is of_hull) is hull is (source != SOURCE)
