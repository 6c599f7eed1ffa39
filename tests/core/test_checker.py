"""The independent checker: it knows wrong cages, needs and motions by hand, and no certificate says more than it."""

from __future__ import annotations

import ast
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import (
    Hierarchy,
    LineCycles,
    Mesh,
    Mirror,
    NestingError,
    OuterHull,
    Rotation,
    Settings,
    animated_cages,
    check,
    checker,
    checker_distance,
    inner_cages,
    nested_cages,
    verify,
    verify_motion,
)
from nestedcages_core.checker import faults_of_motion, touches
from nestedcages_core.tolerance.reach import reach
from support.marks import slow_after
from support.shapes import comb, disc, islands, letter_a, letter_a_coarse, ring, square_with_hole, star

SQUARE = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
FAST = Settings(decimation=OuterHull(), fallback=OuterHull())

MOST_LINES = 327
"""Lines of code in both files, without what explains it: what can be read in a quarter of an hour."""


def mesh(*loops: object) -> Mesh:
    return Mesh.from_loops([np.array(loop, float) for loop in loops])


SMALL = mesh(disc(8, 0.5, 2.0, 2.0))
TWO = mesh(disc(8, 0.2, 1.0, 1.0), disc(8, 0.2, 3.0, 3.0))


def test_it_shares_nothing_with_the_package_and_is_short() -> None:
    total = 0
    for module, known in ((checker, {"checker_distance"}), (checker_distance, set())):
        source = Path(str(module.__file__)).read_text(encoding="utf-8")
        nodes = list(ast.walk(ast.parse(source)))
        assert {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.level} == known
        assert "nestedcages_core" not in source
        texts = [node for node in nodes if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)]
        told = {k for node in texts for k in range(node.lineno, (node.end_lineno or 0) + 1)}
        total += sum(bool(line.strip()) and k not in told for k, line in enumerate(source.splitlines(), 1))
    assert total <= MOST_LINES


@pytest.mark.parametrize(
    ("cage", "fine", "fault"),
    [
        (mesh(disc(8, 0.4, 2.0, 2.0)), SMALL, "outside of the cage"),
        (mesh(disc(8, 0.4, 2.3, 2.0)), SMALL, "meets the fine mesh"),
        (mesh(disc(8, 0.5, 2.0, 2.0)), SMALL, "meets the fine mesh"),
        (mesh(disc(8, 0.6, 2.0, 2.0), disc(8, 0.4, 2.0, 2.0)), SMALL, "inside of the fine mesh"),
        (mesh(SQUARE), TWO, "no partner of its own"),
        (mesh(SQUARE, disc(8, 0.2, 7.0, 7.0)), TWO, "no partner of its own"),
        (mesh(SQUARE, disc(8, 0.2, 7.0, 7.0)), SMALL, "the cage has 2 loops"),
        (SMALL.moved(SMALL.vertices[[0, 2, 1, 3, 4, 5, 6, 7]]), mesh(disc(8, 0.1, 2.0, 2.0)), "meets the cage"),
        (Mesh(SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]]).moved(SQUARE[::-1]), SMALL, "has the wrong orientation"),
        (mesh(SQUARE).moved(SQUARE[[0, 0, 2, 3]]), SMALL, "stands still"),
        (mesh(SQUARE).moved(np.full((4, 2), np.nan)), SMALL, "not finite"),
        (SimpleNamespace(vertices=SQUARE, edges=[[0, 1], [1, 2], [3, 2], [3, 0]]), SMALL, "not the start of one edge"),
        ("a cage", SMALL, "a shape is a mesh"),
        ([], SMALL, "there is no cage"),
        ([mesh(2.0 * SQUARE - 4.0), mesh(1.5 * SQUARE - 2.5)], mesh(0.5 * SQUARE), "level 2: the loop of"),
    ],
)
def test_wrong_cages_are_known(cage: Any, fine: Mesh, fault: str) -> None:
    verdict = check(fine, cage)
    assert not verdict
    assert fault in "; ".join(verdict.problems)


def test_shapes_of_all_kinds_are_read() -> None:
    cage, fine = square_with_hole(0.2).moved(2.0 * square_with_hole(0.2).vertices), square_with_hole(0.5)
    geometry = {"type": "Polygon", "coordinates": [[*ring_, ring_[0]] for ring_ in map(np.ndarray.tolist, cage.rings)]}
    for each in (cage, list(cage.rings), [ring_[::-1] for ring_ in cage.rings], cage.__geo_interface__, geometry):
        assert check(fine, each)
        assert check(list(fine.rings), [each])
    assert check(0.5 * SQUARE + 1.0, SQUARE)
    assert not check(SQUARE, 0.5 * SQUARE + 1.0)
    assert check(SQUARE, 0.5 * SQUARE + 1.0, inside=True)
    assert check(TWO, mesh(SQUARE), same_loops=False)  # one loop may wrap two where that is wanted


def test_the_distance_is_exact() -> None:
    fine = mesh([(1, 1), (2, 1), (2, 2), (1, 2)])
    assert check(fine, SQUARE, 1.0)
    assert check(fine, SQUARE, 1.0 + 5e-10)
    assert "the distance is 1, not" in check(fine, SQUARE, 1.0 + 1.5e-9).problems[0]
    slanted = check(mesh([(1, 1), (2, 1), (1, 2)]), [(0, 0), (3.5, 0), (0, 3.5)], 0.5)
    assert slanted.problems == (f"the distance is {0.5 / np.sqrt(2.0):.9g}, not 0.5",)
    tiny = 1e-170 * SQUARE
    assert check(tiny, 1.5 * tiny - 1e-170, 0.9e-170)
    assert "e-170, not 1.1e-170" in check(tiny, 1.5 * tiny - 1e-170, 1.1e-170).problems[0]
    for wrong in (np.nan, np.inf):
        assert not check(fine, SQUARE, wrong)


@pytest.mark.parametrize("shape", slow_after(1, [islands, letter_a, star, lambda: comb(5, 0.05, per_unit=20)]))
def test_the_largest_distance_agrees_with_its_certificate(shape: Any) -> None:
    fine = shape()
    level = nested_cages(fine, [20], FAST)[0]
    bound = reach(level.cage, fine)  # at most 0.01 % too large
    assert check(fine, level, distance=bound)
    assert "farther than" in check(fine, level, distance=bound / 1.0002).problems[0]


@pytest.mark.parametrize("place", [0.0, 2.0**30])
def test_the_largest_distance_is_exact(place: float) -> None:
    """Of squares: the distance from corner to corner, and not the last digits of it that a coordinate can hold less."""
    rest, cage = 0.25 * SQUARE + 1.5 + place, SQUARE + place
    farthest, digits = 1.5 * np.sqrt(2.0), max(2e-9, 1e-12 * place)
    for around in ((rest, cage), (cage, rest)):  # an inner cage is as far from its drawing
        judged = partial(check, *around, inside=around[0] is cage)
        assert judged(distance=farthest)
        assert judged(distance=farthest * (1.0 - 0.1 * digits))
        assert not judged(distance=farthest * (1.0 - 2.0 * digits))


def test_loops_may_differ_where_the_coarse_mesh_did_or_as_said() -> None:
    fine, coarse = Mesh.from_loops([ring(24), 0.5 * ring(24)]), Mesh.from_loops([ring(9, 1.2)])
    (level,) = nested_cages(fine, [coarse]).levels
    assert check(fine, level)
    assert not check(fine, level, same_loops=True)
    assert check(fine, level.cage, same_loops=False)
    assert not check(fine, level.cage)


def test_images_are_exact_anywhere() -> None:
    """Cages far from the origin on one axis: an image off by a millionth of their size is none."""
    for symmetry in (Mirror(None, (3.0, 4.0)), Rotation(None, 5), Mirror((2.0**20, 0.0), (3.0, 4.0))):
        away = np.array([2.0**20, 0.0])
        half, rest = away + ring(5, 4.0, angle=np.arctan2(4.0, 3.0)), away + ring(5)
        assert check(rest, half, symmetry=symmetry)
        half[1] *= 1.0 + 1e-12
        assert "no image" in check(rest, half, symmetry=symmetry).problems[0]


@pytest.mark.slow
def test_needs_are_checked() -> None:
    for symmetry in (Mirror(None), Mirror((0.0, 0.0), (1.0, 0.3)), Rotation(None, 5)):
        chosen = replace(FAST, symmetry=symmetry, decimation=LineCycles())
        assert check(star(), nested_cages(star(), [20], chosen), symmetry=symmetry)
        assert "no image" in check(star(), star().vertices * 1.3 * (1.0, 1.01), symmetry=symmetry).problems[0]
    on_grid = nested_cages(letter_a(), [24], replace(FAST, grid=0.05))
    assert check(letter_a(), on_grid)
    assert "not multiples of 0.07" in check(letter_a(), on_grid, grid=0.07).problems[0]
    wrong = replace(on_grid[0], cage=on_grid[0].cage.moved(on_grid[0].cage.vertices * (1.0 + 1e-15)))
    assert "not multiples of 0.05" in check(letter_a(), wrong).problems[0]


@pytest.mark.slow
def test_inner_cages_and_cages_that_move_are_checked() -> None:
    assert check(letter_a(), inner_cages(letter_a(), [24, 12], FAST))
    fine = star()
    moving = animated_cages(fine, [fine.vertices * (1.0 + 0.2 * k, 1.0) for k in range(3)], [20], FAST)
    assert check(fine, moving)
    elsewhere = fine.moved(3.0 * fine.vertices - 7.0)  # it gives the topology alone
    assert check(elsewhere, animated_cages(elsewhere, moving.levels[0].fine_steps, [20, 12], FAST))
    assert not check(SimpleNamespace(vertices=fine.vertices, edges=fine.edges[:, ::-1]), moving)
    assert not check(star(5, 40), moving)
    level = moving.levels[0]
    shrunk = replace(level, cage_steps=level.cage_steps * np.linspace(1.0, 0.8, len(level.times))[:, None, None])
    assert "at key" in check(fine, shrunk).problems[0]


@pytest.mark.parametrize(
    ("beside", "between", "meets"),
    [  # Bernstein coefficients, the middle one doubled
        ((-2, -4, 2), (-1, -2, -1), True),  # at √½
        ((-2, -4, 2), (7, 4, -3), True),  # √½ is past 0.7 …
        ((-2, -4, 2), (708, 416, -292), False),  # … but not past 0.708
        ((-2, -4, -1), (-1, -2, -1), False),  # √2 comes too late
        ((1, 0, 0), (-1, -2, -1), True),  # a double root at the very end
        ((1, 2, 2), (-1, -2, -1), False),  # no real root
        ((0, 0, 0), (1, -3, 1), True),  # on one line always, and for a while between the ends
        ((0, 0, 0), (1, -1, 1), False),
        ((-1, 1, 2), (1, -1, -2), True),  # at ⅓, on an end at once
        ((-1, 1, 2), (2, -1, 0), False),
    ],
)
def test_instants_of_contact_are_exact(beside: Any, between: Any, meets: bool) -> None:
    assert touches(beside, between) == meets


def test_contacts_that_last_an_instant_are_known() -> None:
    """A needle's tip reaches the wall between two steps and turns back; one unit in the last place less, and it does
    not."""
    cage = mesh(SQUARE)
    fine = mesh([(1, 1), (3, 1.5), (1, 2)])
    tip = np.array([[3.0, 1.5], [4.0, 1.5], [3.0, 2.0]])
    for x, meets in ((4.0, True), (np.nextafter(4.0, 0.0), False)):
        tip[1, 0] = x
        steps = np.repeat(fine.vertices[None], 3, axis=0)
        steps[:, 1] = tip
        still = np.repeat(cage.vertices[None], 3, axis=0)
        assert bool(faults_of_motion(cage.edges, fine.edges, still, steps, range(2))) == meets


def moved_a_little(values: list[float], cage: Mesh, factor: float) -> Mesh:
    return cage.moved(cage.vertices + factor * np.resize(values, cage.vertices.shape))


offsets = st.lists(st.integers(-8, 8).map(lambda k: k / 8.0), min_size=4, max_size=24)


@settings(max_examples=150)
@given(offsets, st.sampled_from([0.05, 0.3, 1.0]), st.sampled_from(["square", "islands"]))
@pytest.mark.slow
def test_the_certificate_and_the_checker_agree(values: list[float], factor: float, name: str) -> None:
    fine, cage = {
        "square": (square_with_hole(0.5), square_with_hole(0.25)),
        "islands": (islands(), mesh(*(ring(12, r) for r in (1.1, 0.62, 0.35)))),
    }[name]
    if name == "square":
        cage = cage.moved(1.5 * cage.vertices)
    cage = moved_a_little(values, cage, factor)
    assert verify(cage, fine).holds == bool(check(fine, cage))


@settings(max_examples=150)
@given(offsets, offsets)
@pytest.mark.slow
def test_no_motion_is_certified_that_the_checker_refuses(before: list[float], after: list[float]) -> None:
    """Coordinates on a coarse grid, so that exact contacts are common."""
    fine, cage = mesh([(1, 1), (2, 1), (2, 2), (1, 2)]), mesh(SQUARE)
    cage_steps = np.stack([cage.vertices, moved_a_little(before, cage, 1.0).vertices])
    fine_steps = np.stack([fine.vertices, moved_a_little(after, fine, 1.0).vertices])
    certified = bool(verify_motion(cage, fine, cage_steps, fine_steps))
    contacts = faults_of_motion(cage.edges, fine.edges, cage_steps, fine_steps, [0])
    assert not (certified and contacts)


def test_levels_are_checked_when_they_are_made() -> None:
    """The hook of this folder's tests catches a wrong level."""
    hierarchy = nested_cages(letter_a(), [letter_a_coarse()], FAST)
    level = hierarchy.levels[0]
    way = level.reinflation
    wrong = replace(level, cage=level.cage.moved(0.9 * level.cage.vertices))
    with pytest.raises(AssertionError, match="the checker found"):
        Hierarchy(hierarchy.fine, (wrong,))
    steps = way.cage_steps.copy()
    steps[1] *= 0.5
    wrong = replace(level, reinflation=replace(way, cage_steps=steps))
    with pytest.raises(AssertionError, match="between steps 0 and 1"):
        Hierarchy(hierarchy.fine, (wrong,))
    for other, fault in (
        (replace(way, moving_steps=way.moving_steps * (1.0 + 1e-15)), "not back"),
        (replace(way, cage_steps=way.cage_steps * (1.0 + 1e-15)), "do not lead to the cage"),
    ):
        found = check(hierarchy.fine, replace(level, reinflation=other)).problems
        assert any(fault in problem for problem in found)


@pytest.mark.thorough
def test_every_motion_of_random_shapes_is_checked() -> None:
    """All steps of 300 shapes, since this test is marked thorough; see the hook."""
    from benchmarks.random_shapes import random_shape

    judged = 0
    for seed in range(20_000, 20_300):
        drawn = random_shape(seed)
        if drawn is None or len(drawn[1].vertices) > 400:
            continue
        fine = drawn[1]
        try:
            nested_cages(fine, [min(len(fine.vertices), max(5 * len(fine.loops), 24))])
        except NestingError as error:  # fewer than the shape needs: what the refusal advises must do
            nested_cages(fine, [int(str(error).rpartition("ask for at least ")[2].rstrip("."))])
        judged += 1
    assert judged > 100


def test_an_edge_that_shrinks_to_a_point_meets_only_what_is_there() -> None:
    steps = np.array([[(0, 0), (2, 0), (1, 5)], [(1, 0), (1, 0), (1, 5)]], float)
    edges = np.array([[0, 1], [1, 2], [2, 0]])
    for x, meets in ((1.0, True), (3.0, False)):
        point = np.array([[(x, 1), (9, 9), (9, 8)], [(x, 0), (9, 9), (9, 8)]], float)
        assert bool(faults_of_motion(edges, edges, point, steps, [0])) == meets
