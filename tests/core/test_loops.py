"""Which loops a cage keeps: the count is a promise, area decides, and certificates name what is lost."""

from __future__ import annotations

import pickle
import sys
import warnings
from contextlib import suppress
from itertools import product
from typing import Any

import numpy as np
import pytest

from nestedcages_core import (
    Mesh,
    NestedCagesError,
    OuterHull,
    Settings,
    Within,
    check,
    inner_cages,
    nested_cages,
    verify,
)
from nestedcages_core.decimation import LineCycles
from nestedcages_core.decimation.loops import FewerLoops, Tradeoff
from nestedcages_core.decimation.loops.joining import Joins, WorkLeft
from nestedcages_core.decimation.loops.knapsack import Tree
from nestedcages_core.decimation.loops.parts import Hole, Part, open_regions, outermost_parts, outlines
from nestedcages_core.verification import LostLoops
from support.marks import slow_after
from support.shapes import islands, polygon, ring

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def bell() -> Mesh:
    """Two weights of two discs each and the bar between them, each with a dent: parts that only just do not touch."""
    rings = [ring(24, 0.5) + np.array([x, y]) for x, y in ((0.0, 0.0), (0.0, 1.1), (3.0, 0.0), (3.0, 1.1))]
    return Mesh.from_loops([*rings, np.array([[0.7, 0.45], [2.3, 0.45], [2.3, 0.65], [0.7, 0.65]])])


def target() -> Mesh:
    """A ring around a disc with a hole, off its middle."""
    inner = np.array([0.3, 0.2])
    return Mesh.from_loops([ring(40, 2.0), ring(40, 1.5), ring(30, 0.6) + inner, ring(20, 0.2) + inner])


def cloud() -> Mesh:
    """A disc with forty small holes."""
    angle = np.arange(40) * 2.4
    at = (0.1 + 0.02 * np.arange(40))[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Mesh.from_loops([ring(60), *(ring(6, 0.01) + place for place in at)])


SHAPES = [bell, target, cloud, islands]


def test_parts_lie_in_each_other_deeper_than_python_calls() -> None:
    depth = sys.getrecursionlimit() + 100
    nest: Part | Hole = Part(SQUARE, [])
    nest.table = table = np.array([np.inf, np.inf, np.inf, 0.0])
    for k in range(1, depth):
        ring = (1.0 + k / depth) * SQUARE
        nest = Hole(ring, [nest]) if isinstance(nest, Part) else Part(ring, [nest])
        nest.table = table
    whole = Part(3.0 * SQUARE, [nest] if isinstance(nest, Hole) else [])
    whole.table = table
    assert isinstance(nest, Hole) and whole.size == depth + 1 and nest.size == depth
    signs = np.where(np.arange(depth) % 2, -1.0, 1.0)
    assert whole.solid == pytest.approx(9.0 + float((signs * (1.0 + np.arange(depth) / depth) ** 2).sum()))
    assert nest.open_area == pytest.approx(9.0 - whole.solid)
    outer = [whole, nest, *nest.parts]
    for count, kept in ((3, outer[:1]), (8, outer[:1]), (9, outer)):
        tree = Tree(count).of_parts([whole])
        assert set(tree.chosen(int(tree.least.argmin()))) == set(kept)


@pytest.mark.parametrize("count", slow_after(1, [5, 8, 3, 12, 17], thorough_after=3))
@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.__name__)
def test_no_cage_has_more_vertices_than_asked_for(shape: Any, count: int) -> None:
    fine = shape()
    level = nested_cages(fine, count)[0]
    assert len(level.cage.vertices) <= count
    assert verify(level.cage, fine, level.report.wanted_clearance, same_loops=False)
    assert check(fine, level) and polygon(level.cage).contains(polygon(fine))


def test_loops_are_kept_where_the_count_suffices() -> None:
    for fine, count in ((bell(), 60), (target(), 80)):
        auto, keep = (nested_cages(fine, count, loops=loops)[0] for loops in ("auto", "keep"))
        assert auto.cage == keep.cage and auto.report.notes == keep.report.notes


@pytest.mark.parametrize(("side", "each", "looked"), [(4, 6, True), (18, 8, False)])
def test_joins_are_looked_at_where_they_can_save_much(
    side: int, each: int, looked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Joins] = []
    monkeypatch.setattr(Joins, "candidates", lambda joins: asked.append(joins) or [])
    disc = ring(24, 1.0)
    fine = Mesh.from_loops([disc + 3.0 * np.array(place) for place in product(range(side), repeat=2)])
    (level,) = nested_cages(fine, [each * side**2]).levels
    assert level.report.excess > 0.05 and len(level.cage.loops) == side**2
    assert bool(asked) == looked


@pytest.mark.slow
def test_the_choice_is_that_of_least_area() -> None:
    """Around specks one loop, around a frame with something in it a middle, around a cheap hole nothing of it."""
    specks = nested_cages(cloud(), 24)[0]
    assert len(specks.cage.loops) <= 3 and specks.excess < 0.05
    weights = nested_cages(bell(), 16)[0]
    keep = nested_cages(bell(), 16, loops="keep")[0]
    assert weights.excess < 0.6 * keep.excess and 1 < len(weights.cage.loops) < 5
    rings = nested_cages(target(), 40)[0]
    assert len(rings.cage.loops) > 1 and rings.excess < polygon(nested_cages(target(), 40, loops="one")[0].cage).area


@pytest.mark.parametrize("count", [7, 10, 15])
def test_the_knapsack_finds_the_best_of_all_choices(count: int) -> None:
    """Next to every choice of what to keep, of a hole with two parts in it beside two parts of which two may join."""
    random = np.random.default_rng(count)
    parts = outermost_parts(Mesh.from_loops([8.0 * SQUARE, 7.0 * SQUARE + 0.5, SQUARE + 2.0, SQUARE + 5.0,
                                      SQUARE + 10.0, SQUARE + 12.0]))  # fmt: skip
    big, hole = next((part, part.holes[0]) for part in parts if part.holes)
    small = [part for part in parts if not part.holes]
    both = Part(np.array([[10.0, 10.0], [13.0, 10.0], [13.0, 13.0], [10.0, 13.0]]), [], tuple(small))
    for each in (big, hole, *hole.parts, *small, both):
        each.table = np.concatenate([[np.inf] * 3, np.sort(random.random(8))[::-1] * 30.0])

    def cost(kept: list[Any], split: tuple[int, ...]) -> float:
        filled = 0.0 if hole in kept else hole.open_area
        return filled + sum(float(each.table[k]) + each.added for each, k in zip(kept, split, strict=True))

    def best_split(kept: list[Any], left: int) -> float:
        splits = (split for split in product(range(3, 11), repeat=len(kept)) if sum(split) <= left)
        return min((cost(kept, split) for split in splits), default=np.inf)

    choices = [[big, *inner, *outer] for inner in ([], [hole, *hole.parts]) for outer in ([both], small)]
    tree = Tree(count).of_parts([big, both])
    least = int(tree.least.argmin())
    assert np.isclose(tree.least[least], min(best_split(kept, count) for kept in choices))
    chosen = tree.chosen(least)
    assert np.isclose(best_split(chosen, count), tree.least[least])


def test_joins_end_when_their_work_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    """No join is made after that, and the cage is that of the convex hull."""
    made: list[object] = []
    joined = Joins._joined
    monkeypatch.setattr(Joins, "_joined", lambda *given: made.append(given) or joined(*given))
    monkeypatch.setattr("nestedcages_core.decimation.loops.joining.WORK", 100)
    fine = Mesh.from_loops([ring(12, 0.3) + np.array([k % 6, k // 6]) for k in range(30)])
    (level,) = nested_cages(fine, [20])
    assert len(made) <= 100 // 24 and len(level.cage.loops) == 1 and level.report.strict


def test_joined_outlines_contain_what_they_join() -> None:
    joins = Joins(next(iter(open_regions(outermost_parts(bell())))), WorkLeft())
    for part in joins.candidates():
        around = polygon(Mesh.from_loops([part.ring]))
        assert isinstance(part, Part) and around.contains_properly(polygon(Mesh.from_loops([part.joined[0].ring])))
        assert around.area - sum(each.area for each in part.joined) == pytest.approx(part.added) and part.added > 0.0


def test_parts_join_the_outline_of_the_hole_that_they_are_in() -> None:
    parts = outermost_parts(target())
    region = next(region for region in open_regions(parts) if region.hole is not None and region.parts)
    (made,) = Joins(region, WorkLeft()).candidates()
    assert isinstance(made, Hole) and made.joined == tuple(region.parts) and len(made.inner) == 1
    Joins(region, WorkLeft()).apply(made)
    assert made in list(outlines(parts)) and made.added > 0.0
    assert made.open_area == pytest.approx(outermost_parts(target())[0].holes[0].open_area)


@pytest.mark.slow
def test_what_is_lost_is_named() -> None:
    fine = target()
    level = nested_cages(fine, 5)[0]
    assert level.report.lost == verify(level.cage, fine, same_loops=False).lost == LostLoops((1,), ())
    (note,) = (note for note in level.report.notes if note.code == "note.loops")
    assert "1 hole is filled" in note and note.data["filled"] == (1,)
    verdict = check(fine, level)
    assert verdict and len(verdict.lost) == 1 and "is filled" in verdict.lost[0]
    together = nested_cages(bell(), 4)[0]
    assert together.report.lost == LostLoops((), ((0, 1, 2, 3, 4),))
    assert "5 parts share a loop" in " ".join(together.report.notes)
    assert "share one" in check(bell(), together).lost[0]
    kept = nested_cages(fine, 80)[0]
    assert kept.report.lost == LostLoops() and not check(fine, kept).lost


def test_a_part_beside_the_hole_of_a_cage_shares_its_loop() -> None:
    cage = Mesh.from_loops([ring(40, 2.2), ring(20, 0.7) * (0.3, 1.0) + np.array([-1.05, 0.0])])
    fine = Mesh.from_loops([ring(40, 2.0), ring(40, 1.5), ring(30, 0.6)])
    assert verify(cage, fine, same_loops=False).lost == LostLoops((), ((1, 2),))
    assert "share one" in check(fine, cage, same_loops=False).lost[0]


def test_a_filled_hole_must_be_covered() -> None:
    """A part left out, or a hole of the cage across the drawing, is wrong however few loops are asked for."""
    fine = target()
    for wrong in ([ring(20, 2.2), ring(20, 0.4)], [ring(20, 1.0)], [ring(20, 2.2), ring(20, 1.0)]):
        cage = Mesh.from_loops(wrong)
        assert not verify(cage, fine, same_loops=False) and not check(fine, cage, same_loops=False)


@pytest.mark.slow
def test_keep_is_the_promise_of_each_loop() -> None:
    with pytest.raises(NestedCagesError, match="5 loops need at least 15, 3 each"):
        nested_cages(bell(), 14, loops="keep")
    level = nested_cages(bell(), 15, loops="keep")[0]
    assert len(level.cage.loops) == 5
    assert any('leave out loops="keep"' in note for note in level.report.notes)
    with pytest.raises(NestedCagesError, match="loops must be one of 'auto', 'keep', 'one'"):
        Settings(loops="some")


def test_one_is_a_silhouette() -> None:
    for fine in (bell(), target()):
        assert len(nested_cages(fine, 20, loops="one")[0].cage.loops) == 1
    with pytest.raises(NestedCagesError, match='loops="one" does not go with'):
        nested_cages(bell(), 20, loops="one", symmetry=_mirror())


def test_holes_are_filled_without_shapely(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "shapely", None)
    assert len(nested_cages(cloud(), 24)[0].cage.vertices) == 24
    with pytest.raises(NestedCagesError, match="Joining parts needs shapely; install it"):
        nested_cages(bell(), 12)


@pytest.mark.parametrize("angle", slow_after(0, [1.0, 0.3, 0.0, 1.9, 2.8, 4.4], thorough_after=2))
def test_the_same_loops_are_chosen_at_any_angle(angle: float) -> None:
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    for shape, count in ((bell, 16), (target, 14)):
        fine = shape()
        plain, turned = (nested_cages(Mesh(x, fine.edges), count)[0] for x in (fine.vertices, fine.vertices @ turn))
        assert plain.report.lost == turned.report.lost
        assert plain.cage.area == pytest.approx(turned.cage.area, rel=0.03)


def _mirror() -> Any:
    from nestedcages_core import Mirror

    return Mirror((1.5, 0.55), (0.0, 1.0))


WITH: dict[str, dict[str, Any]] = {
    "clearance": {"clearance": 0.02},
    "grid": {"grid": 0.05},
    "float32": {"stored": np.float32},
    "symmetry": {"symmetry": _mirror()},
    "weights": {"weights": np.linspace(0.5, 2.0, 100)},
    "pins": {"pins": [0, 50]},
    "edges": {"min_edge": 0.1},
    "angles": {"min_angle": 20.0},
    "hull": {"decimation": OuterHull()},
    "no fallback": {"fallback": None},
}


@pytest.mark.parametrize("name", slow_after(1, WITH, thorough_after=4))
def test_the_count_holds_together_with(name: str) -> None:
    fine = bell()
    for count in (6, 12):
        level = nested_cages(fine, count, **WITH[name])[0]
        assert len(level.cage.vertices) <= count and len(level.cage.loops) < 5
        assert check(fine, level, symmetry=WITH[name].get("symmetry"))


@pytest.mark.slow
def test_the_count_holds_on_every_level() -> None:
    levels = nested_cages(bell(), [24, 10, 5])
    assert [len(level.cage.vertices) for level in levels] == [24, 10, 5]
    assert check(bell(), levels)


@pytest.mark.slow
def test_loops_are_kept_inside_by_tolerances_and_around_own_meshes() -> None:
    fine = bell()
    with pytest.raises(NestedCagesError, match="at least 15"):
        inner_cages(fine, 12)
    assert len(nested_cages(fine, Within(excess=0.8))[0].cage.loops) == 5
    own = Mesh.from_loops([1.05 * (fine.vertices[loop] - (mean := fine.vertices[loop].mean(axis=0))) + mean
                           for loop in fine.loops[:2]])  # fmt: skip
    assert len(nested_cages(Mesh.from_loops(fine.rings[:2]), own)[0].cage.loops) == 2


@pytest.mark.slow
def test_starts_enclose_and_are_no_looser_than_those_with_all_loops() -> None:
    method = LineCycles(on_curve=False)
    for fine, count in ((bell(), 18), (target(), 16), (islands(), 20)):
        mesh = FewerLoops(method).decimate(fine, count)
        assert verify(mesh, fine, same_loops=False) and len(mesh.vertices) <= count
        assert mesh.area <= method.decimate(fine, count).area


def test_the_knee_is_told() -> None:
    """Fifteen vertices cannot follow sixteen corners."""
    fine = Mesh.from_loops([ring(4, 1.0, angle=np.pi / 4) + np.array([3.0 * x, 3.0 * y]) for x, y in np.ndindex(2, 2)])
    level = nested_cages(fine, 13)[0]
    found, notes = level.tradeoff, level.report.notes
    assert pickle.loads(pickle.dumps(notes)) == notes == tuple(notes) and hash(notes) == hash(tuple(notes))
    (said,) = (note for note in level.report.notes if note.code == "note.knee")
    assert said.data["better"] == found.knee and said.data["given"] == 13
    assert f"{found.knee} vertices would make it" in said and found[found.knee] <= 0.5 * level.excess
    assert found[13] == pytest.approx(level.excess)
    assert list(found) == sorted(found) and all(np.diff(list(found.values())) <= 0.0)
    better = nested_cages(fine, found.knee)[0]
    assert better.excess == pytest.approx(found[found.knee], abs=0.1 * level.excess)
    assert not any(note.code == "note.knee" for note in better.report.notes)


@pytest.mark.slow
def test_counts_against_excess_are_drawn() -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    found = nested_cages(bell(), 9)[0].tradeoff
    axes = found.plot()
    x, y = axes.lines[0].get_data()
    assert list(x) == list(found) and list(y) == list(found.values()) and axes.get_xlabel() == "vertices"
    assert found.plot(axes) is axes
    plt.close("all")
    assert len(Tradeoff.of(bell(), nested_cages(bell(), 9)[0].cage, most=30)) > len(found)


def test_parts_that_are_flat_next_to_round_off_join_without_a_warning() -> None:
    loops = [[(-1.0, 1.0), (0.0, 0.0), (-1.0, 0.0)], [(0.0, 1.552746739039523e-151), (1.0, 0.0), (2.0, 0.0)]]
    with warnings.catch_warnings(), suppress(NestedCagesError):
        warnings.simplefilter("error")
        nested_cages(Mesh.from_loops(loops), [6], Settings(decimation=OuterHull()))
