"""Line cycles: each part next to a plain way of computing it, and starts that enclose their shapes."""

from __future__ import annotations

from itertools import combinations, pairwise, product
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import box

from nestedcages_core import (
    LineCycles,
    Mesh,
    Mirror,
    NestedCagesError,
    OuterHull,
    Rotation,
    Settings,
    inner_cages,
    nested_cages,
    verify,
)
from nestedcages_core.constraints import LeastEdge
from nestedcages_core.decimation.base import Kept
from nestedcages_core.decimation.hull.narrow_gaps import HULL_OFFSET
from nestedcages_core.decimation.hull.outer_hull import SOURCE as HULL
from nestedcages_core.decimation.importance import Importance
from nestedcages_core.decimation.line_cycles.around import Around
from nestedcages_core.decimation.line_cycles.candidates import Obstacles
from nestedcages_core.decimation.line_cycles.chain import Chain, Lines
from nestedcages_core.decimation.line_cycles.loop_search import allocation
from nestedcages_core.decimation.line_cycles.method import SOURCE, cycles_around
from nestedcages_core.decimation.line_cycles.shortest_cycles import Paths
from nestedcages_core.decimation.line_cycles.turns import Turns
from nestedcages_core.decimation.request import Request
from nestedcages_core.tasks import drain
from support.marks import slow_after
from support.shapes import annulus, assert_nested, comb, disc, islands, letter_a, polygon, ring, star

RANDOM = np.random.default_rng(5)


def wave(count: int) -> Mesh:
    """A coast of many waves."""
    t = 2.0 * np.pi * np.arange(count) / count
    radius = 1.0 + sum(0.2 / k**1.1 * np.cos(k * t + k * k) for k in range(2, 40, 3))
    return Mesh.from_loops([radius[:, None] * np.column_stack((np.cos(t), np.sin(t)))])


def random_turns(count: int, share: float) -> Turns:
    """Turns between a share of all pairs of lines."""
    target, source = np.nonzero((RANDOM.random((count, count)) < share) & ~np.eye(count, dtype=bool))
    area = RANDOM.random(len(source)).astype(np.float32)
    return Turns(source, target, np.zeros(len(source)), np.zeros(len(source)), area)


@pytest.mark.parametrize(("count", "share"), [(5, 1.0), (8, 0.7), (9, 0.3), (6, 0.1)])
def test_the_best_cycles_are_those_of_all_choices_of_lines(count: int, share: float) -> None:
    turns = random_turns(count, share)
    first = np.searchsorted(turns.target, np.arange(count + 1))
    cost = np.full((count, count), np.inf)
    cost[turns.source, turns.target] = turns.area
    for start in range(count):
        paths = Paths(turns, turns.area, first, start, count)
        totals = paths.run()
        for size in range(2, count + 1):
            some = [c for c in combinations(range(count), size) if start in c]
            areas = [sum(cost[a, b] for a, b in zip(c, (*c[1:], c[0]), strict=True)) for c in some]
            assert totals[size] == pytest.approx(min(areas))
            if np.isfinite(totals[size]):
                cycle = paths.cycle(size).tolist()
                assert areas[some.index(tuple(cycle))] == pytest.approx(totals[size])
                corridor = np.sort(np.mod(np.array(cycle) - start, count)).tolist()
                assert Paths(turns, turns.area, first, start, size, corridor).run()[size] <= totals[size] + 1e-6


def test_programs_that_run_as_one_find_what_each_finds_alone() -> None:
    def several() -> list[Paths]:
        return [Paths(turns, turns.area, first, start, most, way) for turns, first, start, most, way in asked]

    asked = []
    for count, share, most, corridor in ((5, 1.0, 4, None), (9, 0.3, 9, [0, 2, 3, 6, 8]), (7, 0.6, 3, [0, 2, 5])):
        turns = random_turns(count, share)
        asked.append((turns, np.searchsorted(turns.target, np.arange(count + 1)), count // 2, most, corridor))
    alone, together = several(), several()
    Paths.run_all(together)
    for one, other in zip(alone, together, strict=True):
        assert np.array_equal(one.run(), other.totals)
        assert np.array_equal(one.least, other.least)


def test_lines_are_shared_between_loops_as_if_all_ways_were_tried() -> None:
    for _ in range(40):
        totals = [np.where(RANDOM.random(6) < 0.3, np.inf, RANDOM.random(6)) for _ in range(3)]
        for total in totals:
            total[:2] = np.inf
        count = int(RANDOM.integers(5, 14))
        ways = [w for w in product(range(6), repeat=3) if sum(w) <= count]
        best = min((sum(t[k] for t, k in zip(totals, way, strict=True)) for way in ways), default=np.inf)
        numbers = allocation(totals, count, [1] * len(totals))
        if numbers is None:
            assert best == np.inf
        else:
            assert sum(numbers) <= count
            assert sum(t[k] for t, k in zip(totals, numbers, strict=True)) == pytest.approx(best)


@pytest.mark.parametrize("distance", [0.0, 0.02, 0.3])
def test_rays_end_where_they_come_too_close_to_the_solid_next_to_their_region(distance: float) -> None:
    fine = annulus(40, 0.4)
    solid, reach = polygon(fine).buffer(distance, quad_segs=500), 3.0
    angle, radius = RANDOM.uniform(0.0, 2.0 * np.pi, 60), RANDOM.uniform(0.0, 1.6, 60)
    point = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    turn = RANDOM.uniform(0.0, 2.0 * np.pi, 60)
    lines = Lines.of(point, np.zeros(60), np.stack([np.cos(turn), np.sin(turn)], axis=1))
    request = Request.of(fine, 6)
    obstacles = Obstacles(request.outline.split(), request.regions)
    outside, inside = (obstacles.free(lines, reach, region, distance) for region in request.regions.tolist())
    assert (outside[:, radius < 0.3] < 0.0).all()
    free = np.maximum(outside, inside)
    for k in range(60):
        here = shapely.Point(point[k])
        if solid.contains(here):
            assert (free[:, k] < 0.0).all()
            continue
        for way, sign in enumerate((1.0, -1.0)):
            ray = shapely.LineString([point[k], point[k] + sign * reach * lines.direction[k]])
            met = ray.intersection(solid)
            assert free[way, k] == pytest.approx(
                reach if met.is_empty else here.distance(met), abs=1e-4 * distance + 1e-9
            )


def test_areas_of_cycles_are_those_between_cage_and_outline(monkeypatch: pytest.MonkeyPatch) -> None:
    """The sum over the turns of each loop is the difference of two areas."""
    from nestedcages_core.decimation.line_cycles import around

    seen: list[float] = []
    choose = around.Choice.of.__func__  # type: ignore[attr-defined]

    def watched(cls: type, searches: dict, numbers: dict, images: None) -> object:
        seen.append(sum(float(search.totals[k]) for search, k in zip(searches.values(), numbers.values(), strict=True)))
        return choose(cls, searches, numbers, images)

    monkeypatch.setattr(around.Choice, "of", classmethod(watched))
    for fine, count in ((letter_a(), 16), (star(), 20), (annulus(60), 12)):
        request = Request.of(fine, count)
        mesh, _ = drain(cycles_around(request, 0.0))
        added = (mesh.area - fine.area) / request.outline.diameter**2
        assert seen[-1] == pytest.approx(added, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize(
    "fine", slow_after(3, [letter_a(), star(), annulus(60), islands(), comb(5, 0.02), comb(2, 1e-5)])
)
def test_starts_enclose_their_shapes_with_the_wanted_vertices(fine: Mesh) -> None:
    areas = []
    for count in (17, 18, 21, 27, 40):
        mesh = LineCycles().decimate(fine, count)
        assert len(mesh.vertices) == count and verify(mesh, fine)
        areas.append(mesh.area)
    assert areas == sorted(areas, reverse=True)
    per_loop = [3 + k for k in range(len(fine.loops))] if len(fine.loops) > 1 else [9]
    assert [len(loop) for loop in LineCycles().decimate(fine, per_loop).loops] == per_loop


def test_a_spiral_is_bridged_far_along_its_outline() -> None:
    turn = np.linspace(0.0, 6.0 * np.pi, 120)
    ray = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    middle = (0.2 + 0.8 * turn / turn[-1])[:, None] * ray
    spiral = Mesh.from_loops([np.concatenate([middle + 0.05 * ray, (middle - 0.05 * ray)[::-1]])])
    assert verify(LineCycles().decimate(spiral, 17), spiral)


@pytest.mark.slow
def test_cages_are_the_same_in_every_position() -> None:
    c, s = np.cos(2.5), np.sin(2.5)
    for fine in (letter_a(2), star(), islands()):
        turned = Mesh.from_loops(
            [np.roll(fine.vertices[loop] @ np.array([[c, s], [-s, c]]) * 7e3 + 1e4, 3, axis=0) for loop in fine.loops]
        )
        excess = [nested_cages(mesh, 20).levels[0].report.excess for mesh in (fine, turned)]
        assert excess[1] == pytest.approx(excess[0], rel=0.01)


def test_a_small_shape_gets_the_best_cage_there_is() -> None:
    """All lines a degree apart, in all cycles, lead to 13.04 % (benchmarks/optimum.py, seed 16)."""
    points = [(0.715, 0.0), (0.443, 0.322), (0.208, 0.641), (-0.251, 0.771), (-0.413, 0.3), (-0.937, 0.0)]
    fine = Mesh.from_loops([[*points, (-0.75, -0.545), (-0.161, -0.497), (0.278, -0.857), (0.479, -0.348)]])
    assert nested_cages(fine, [6]).levels[0].report.excess < 0.132


@pytest.mark.parametrize("seed", slow_after(2, [6, 27, 37, 41, 74, 97, 122, 199], thorough_after=4))
def test_one_more_vertex_is_no_looser(seed: int) -> None:
    """In random shapes of several kinds; cages end in local minima, so a little is allowed."""
    from benchmarks.random_shapes import random_shape

    drawn = random_shape(seed)
    assert drawn is not None
    fine = drawn[1]
    first = 4 * len(fine.loops) + seed % 7
    excess = [nested_cages(fine, first + more, loops="keep").levels[0].report.excess for more in range(3)]
    assert max(excess[1] / excess[0], excess[2] / excess[1]) < 1.005


def test_more_vertices_are_never_worse_where_one_loop_has_long_edges() -> None:
    fine = Mesh.from_loops([disc(24, 2.0, 0.0, 0.0), disc(40, 1.0, 10.0, 0.0), disc(44, 1.0, 0.0, 10.0)])
    areas = [LineCycles().decimate(fine, count).area for count in (48, 50, 52, 55)]
    assert areas == sorted(areas, reverse=True)


def test_both_ways_of_starting_lead_to_the_same_cage() -> None:
    fine = letter_a()
    curve, outside = (
        nested_cages(fine, 20, Settings(decimation=LineCycles(on_curve=way))).levels[0] for way in (True, False)
    )
    assert (curve.report.start, outside.report.start) == ("flow", "line cycles")
    assert curve.report.excess == pytest.approx(outside.report.excess, rel=0.01)
    assert_nested(outside.cage, fine)


def test_lines_next_to_the_outline_enclose_it_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a second search around its offset."""
    from nestedcages_core.decimation.hull import offset

    monkeypatch.delattr(offset, "offsetting")
    assert len(LineCycles().decimate(wave(400), 90).vertices) == 90


def test_large_counts_have_cycles_and_no_steps() -> None:
    fine = wave(700)
    starts = [drain(LineCycles().starts(fine, count))[0] for count in (126, 128, 130, 190)]
    assert [start.source for start in starts] == [SOURCE] * 4
    areas = [start.coarse.area for start in starts]
    assert areas == sorted(areas, reverse=True)
    assert areas[-1] - fine.area < 0.9 * (OuterHull().decimate(fine, 190).area - fine.area)


def test_a_single_loop_has_the_best_cycle_of_the_wanted_number() -> None:
    """Though lines are sought near evenly spread ones, and the wheel has its teeth on one side."""
    t = 2.0 * np.pi * np.arange(1000) / 1000
    radius = 1.0 + np.where(t < 3.0, 0.05 * np.cos(60.0 * t), 0.0)
    request = Request.of(Mesh.from_loops([radius[:, None] * np.column_stack((np.cos(t), np.sin(t)))]), 300)
    around = [Around(request, request.outline, HULL_OFFSET) for _ in range(2)]
    for each, is_known in zip(around, (True, False), strict=True):
        for _ in each._search(known=is_known):
            pass
    known, all_numbers = (each.searches[0].totals for each in around)
    assert known[300] == all_numbers[300]
    assert known[150] > all_numbers[150]


def test_where_searches_leave_turns_out_the_hull_may_be_the_tighter_one() -> None:
    from benchmarks.random_shapes import random_shape

    drawn = random_shape(146)
    assert drawn is not None and drawn[0] == "needles"
    start = drain(LineCycles().starts(drawn[1], 140))[0]
    assert start.source == HULL
    assert start.coarse.area <= OuterHull().decimate(drawn[1], 140).area


@pytest.mark.slow
def test_many_loops_start_from_the_hull() -> None:
    for side, source in ((9, SOURCE), (10, HULL)):
        places = np.stack(np.mgrid[:side, :side], axis=-1).reshape(-1, 2)
        start = drain(LineCycles().starts(Mesh.from_loops([0.4 * ring(8) + place for place in places]), 5 * side**2))
        assert start[0].source == source


def test_parameters_and_impossible_counts_are_told() -> None:
    with pytest.raises(NestedCagesError, match="LineCycles: on_curve must be True or False"):
        LineCycles(on_curve=2)  # type: ignore[arg-type]
    with pytest.raises(NestedCagesError, match="too small"):
        nested_cages(Mesh.from_loops([ring(60), 0.9 * ring(60), 0.8 * ring(60)]), 9, loops="keep")
    assert Chain(ring(6)).size == 6


@pytest.mark.slow
def test_inner_cages_start_from_cycles_too() -> None:
    for fine in (letter_a(), star(), annulus(60)):
        cycles, greedy = drain(LineCycles().inside.starts(fine, 16))
        assert (cycles.source, greedy.source) == ("line cycles", "inner hull")
        level = inner_cages(fine, cycles.coarse).levels[0]
        hull = inner_cages(fine, 16, Settings(decimation=OuterHull())).levels[0]
        assert verify(fine, level.cage) and level.report.excess > 1.02 * hull.report.excess


def test_an_inner_hull_that_beats_crossing_cycles_is_named_so() -> None:
    from benchmarks.random_shapes import random_shape

    drawn = random_shape(5000870)
    assert drawn is not None
    assert inner_cages(drawn[1], 38).levels[0].report.start == "inner hull"


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "count"), [(None, 15), (78, 44)])
def test_the_least_count_that_is_named_has_a_cage(seed: int | None, count: int) -> None:
    from benchmarks.random_shapes import random_shape

    drawn = None if seed is None else random_shape(seed)
    fine = islands() if drawn is None else drawn[1]
    with pytest.raises(NestedCagesError, match="ask for at least") as caught:
        nested_cages(fine, count, loops="keep")
    assert caught.value.code == "count.too_small"
    least = caught.value.data["least"]
    assert least > count and len(nested_cages(fine, least, loops="keep").cages[0].vertices) == least


@pytest.mark.parametrize("seed", slow_after(1, range(5)))
@pytest.mark.parametrize("spikes", [9, 40])
def test_no_vertex_of_a_small_cage_runs_away_from_spikes(seed: int, spikes: int) -> None:
    random = np.random.default_rng(seed)
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, spikes))
    outline = random.uniform(0.02, 1.0, (spikes, 1)) * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    fine = Mesh.from_loops([outline])
    low, high = outline.min(axis=0), outline.max(axis=0)
    for count in (4, 5, 7):
        cage = nested_cages(fine, count)[0].cage.vertices
        beyond = np.maximum(0.0, np.maximum(low - cage, cage - high))
        assert np.hypot(*beyond.T).max() < 0.6 * fine.diagonal


@pytest.mark.parametrize("turns", slow_after(1, [7.0, 10.0, 13.0]))
def test_more_vertices_around_a_spiral_are_never_worse(turns: float) -> None:
    turn = np.linspace(0.6, turns, 30)
    band = shapely.LineString(turn[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)).buffer(1.2, quad_segs=3)
    areas = [nested_cages(band, count)[0].cage.area for count in (9, 10, 11, 12, 14, 16)]
    assert all(after <= (1.0 + 1e-3) * before for before, after in pairwise(areas))


@pytest.mark.parametrize("gap", slow_after(0, [0.1, 0.5, 1.5]))
def test_more_vertices_around_a_comb_with_a_clearance_are_never_worse(gap: float) -> None:
    teeth = [shapely.affinity.rotate(box(k, -0.1, k + 1.0 / (1.0 + gap), 3.0 - 0.2 * k), 0.3, (0, 0)) for k in range(6)]
    fine = shapely.union_all([shapely.affinity.rotate(box(0.0, -1.0, 6.0, 0.0), 0.3, (0, 0)), *teeth])
    areas = [nested_cages(fine, count, clearance=0.1)[0].cage.area for count in range(8, 24)]
    assert all(after <= (1.0 + 1e-6) * before for before, after in pairwise(areas))


@pytest.mark.parametrize("sides", slow_after(1, [5, 7, 12]))
def test_one_vertex_less_than_the_least_is_refused_too(sides: int) -> None:
    fine = Mesh.from_loops([radius * ring(sides) for radius in (1.0, 0.9, 0.8, 0.7)])
    with pytest.raises(NestedCagesError) as caught:
        nested_cages(fine, 12, loops="keep")
    least = caught.value.data["least"]
    assert len(nested_cages(fine, least, loops="keep")[0].cage.vertices) == least
    with pytest.raises(NestedCagesError):
        nested_cages(fine, least - 1, loops="keep")


def test_a_clearance_without_room_is_told_instead_of_a_count() -> None:
    with pytest.raises(NestedCagesError) as caught:
        nested_cages(Mesh.from_loops([ring(60), 0.9 * ring(60), 0.8 * ring(60)]), 9, clearance=0.06, loops="keep")
    assert caught.value.code == "clearance.no_room" and caught.value.data["largest"] < 0.06


def keeping(fine: Mesh, count: int, **kept: Any) -> Mesh:
    """A mesh of line cycles that keeps something."""
    return drain(LineCycles().starts_keeping(fine, count, Kept(**kept)))[0].coarse


def test_constraints_are_kept_by_the_start_itself() -> None:
    fine = letter_a()
    place = fine.vertices[[3, 11]]
    nothing = np.zeros((0, 2))
    at_pins = keeping(fine, 20, importance=Importance(fine, None, place))
    for pin in place:
        assert np.hypot(*(at_pins.vertices - pin).T).min() < 2e-3 * fine.diagonal
    right = 1.0 + 20.0 * (fine.vertices[:, 0] > fine.vertices[:, 0].mean())
    weighted = keeping(fine, 20, importance=Importance(fine, right, nothing))
    beyond = [
        polygon(mesh).difference(polygon(fine)).intersection(box(fine.vertices[:, 0].mean(), -9e3, 9e3, 9e3)).area
        for mesh in (weighted, LineCycles().decimate(fine, 20))
    ]
    assert beyond[0] < beyond[1]
    fine = Mesh.from_loops([ring(60) * (1.0, 0.3)])
    shortest = [keeping(fine, 10, rules=rules).edge_lengths.min() for rules in ((), (LeastEdge(0.4),))]
    assert shortest[1] > 1.2 * shortest[0]
    for symmetry in (Mirror((0.0, 0.0)), Rotation((0.0, 0.0), 5)):
        angle = np.arange(100) / 50.0 * np.pi + 0.5 * np.pi
        flower = Mesh.from_loops([(1.0 + 0.3 * np.cos(5 * (angle - 0.5 * np.pi)))[:, None] * ring_at(angle)])
        mesh = keeping(flower, 15, symmetry=symmetry)
        off = np.abs(symmetry.image(mesh.vertices)[:, None] - mesh.vertices).sum(axis=2).min(axis=1).max()
        assert off < 1e-9 and len(mesh.vertices) == 15 and verify(mesh, flower)


def ring_at(angle: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_a_small_hole_in_a_large_solid_has_no_lines_in_the_solid() -> None:
    hole = 0.004 * np.array([[0.0, 0.0], [0.3, 1.0], [0.55, 0.2], [0.5, -0.1]])
    fine = Mesh.from_loops([ring(40), hole])
    request = Request.of(fine, 16)
    area, mesh = drain(Around(request, request.outline, HULL_OFFSET).run(1.0))
    assert_nested(mesh, fine)
    assert area < 1.1 * fine.area
