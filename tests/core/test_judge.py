"""The judge itself: it knows wrong cages and motions by hand, and the certificates never say more than it does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from judge import faults_of_cage, faults_of_motion, squared_distance, touches, whole_numbers
from nestedcages_core import Hierarchy, Mesh, NestingError, OuterHull, Settings, nested_cages, verify, verify_motion
from shapes import disc, islands, letter_a, letter_a_coarse, ring, square_with_hole

SQUARE = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
FAST = Settings(starts=1, decimation=OuterHull(restarts=1), fallback=OuterHull(restarts=1))


def mesh(*loops: object) -> Mesh:
    return Mesh.from_loops([np.array(loop, float) for loop in loops])


SMALL = mesh(disc(8, 0.5, 2.0, 2.0))
TWO = mesh(disc(8, 0.2, 1.0, 1.0), disc(8, 0.2, 3.0, 3.0))


@pytest.mark.parametrize(
    ("cage", "fine", "fault"),
    [
        (mesh(disc(8, 0.4, 2.0, 2.0)), SMALL, "outside of the cage"),
        (mesh(disc(8, 0.4, 2.3, 2.0)), SMALL, "meets fine edge"),
        (mesh(disc(8, 0.5, 2.0, 2.0)), SMALL, "meets fine edge"),
        (mesh(disc(8, 0.6, 2.0, 2.0), disc(8, 0.4, 2.0, 2.0)), SMALL, "inside of the fine solid"),
        (mesh(SQUARE), TWO, "no partner of its own"),
        (mesh(SQUARE, disc(8, 0.2, 7.0, 7.0)), TWO, "no partner of its own"),
        (mesh(SQUARE, disc(8, 0.2, 7.0, 7.0)), SMALL, "the cage has 2 loops"),
        (SMALL.moved(SMALL.vertices[[0, 2, 1, 3, 4, 5, 6, 7]]), mesh(disc(8, 0.1, 2.0, 2.0)), "cage: edges"),
        (Mesh(SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]]).moved(SQUARE[::-1]), SMALL, "turns the wrong way"),
        (mesh(SQUARE).moved(SQUARE[[0, 0, 2, 3]]), SMALL, "stands still"),
        (mesh(SQUARE).moved(np.full((4, 2), np.nan)), SMALL, "not finite"),
    ],
)
def test_wrong_cages_are_known(cage: Mesh, fine: Mesh, fault: str) -> None:
    assert fault in "; ".join(faults_of_cage(cage, fine, 0.0))


def test_one_loop_may_wrap_two_where_that_is_wanted() -> None:
    assert not faults_of_cage(mesh(SQUARE), TWO, 0.0, same_loops=False)


def test_the_distance_is_exact() -> None:
    fine = mesh([(1, 1), (2, 1), (2, 2), (1, 2)])
    assert not faults_of_cage(mesh(SQUARE), fine, 1.0)
    assert "the distance is 1," in faults_of_cage(mesh(SQUARE), fine, 1.0 + 1e-8)[0]
    (points,), factor = whole_numbers(np.array([[0.5, 0.25], [0.0, 0.0], [1.0, 0.0]]))
    assert squared_distance(*points) == (0.25 * factor) ** 2


@pytest.mark.parametrize(
    ("side", "past_start", "before_end", "meets"),
    [
        ((-2, 0, 4), (1, 0, 0), (1, 0, 0), True),  # at √½
        ((-2, 0, 4), (-7, 10, 0), (1, 0, 0), True),  # √½ is past 0.7 …
        ((-2, 0, 4), (-708, 1000, 0), (1, 0, 0), False),  # … but not past 0.708
        ((-2, 0, 1), (1, 0, 0), (1, 0, 0), False),  # √2 comes too late
        ((1, -2, 1), (1, 0, 0), (1, 0, 0), True),  # a double root at the very end
        ((1, 0, 1), (1, 0, 0), (1, 0, 0), False),  # no real root
        ((0, 0, 0), (-1, 4, 0), (3, -8, 0), True),  # on one line always: from ¼ on, until ⅜
        ((0, 0, 0), (-3, 8, 0), (1, -4, 0), False),  # from ⅜ on, until ¼
        ((-1, 3, 0), (1, -3, 0), (-1, 3, 0), True),  # at ⅓, on both ends at once
    ],
)
def test_instants_of_contact_are_exact(side: object, past_start: object, before_end: object, meets: bool) -> None:
    assert touches(side, past_start, before_end) == meets  # type: ignore[arg-type]


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
        assert bool(faults_of_motion(cage.edges, fine.edges, still, steps)) == meets


def moved_a_little(values: list[float], cage: Mesh, factor: float) -> Mesh:
    return cage.moved(cage.vertices + factor * np.resize(values, cage.vertices.shape))


offsets = st.lists(st.integers(-8, 8).map(lambda k: k / 8.0), min_size=4, max_size=24)


@settings(max_examples=150)
@given(offsets, st.sampled_from([0.05, 0.3, 1.0]), st.sampled_from(["square", "islands"]))
@pytest.mark.slow
def test_the_certificate_and_the_judge_agree(values: list[float], factor: float, name: str) -> None:
    fine, cage = {
        "square": (square_with_hole(0.5), square_with_hole(0.25)),
        "islands": (islands(), mesh(*(ring(12, r) for r in (1.1, 0.62, 0.35)))),
    }[name]
    if name == "square":
        cage = cage.moved(1.5 * cage.vertices)
    cage = moved_a_little(values, cage, factor)
    assert verify(cage, fine).holds == (not faults_of_cage(cage, fine, 0.0))


@settings(max_examples=150)
@given(offsets, offsets)
@pytest.mark.slow
def test_no_motion_is_certified_that_the_judge_refuses(before: list[float], after: list[float]) -> None:
    """Coordinates on a coarse grid, so that exact contacts are common."""
    fine, cage = mesh([(1, 1), (2, 1), (2, 2), (1, 2)]), mesh(SQUARE)
    cage_steps = np.stack([cage.vertices, moved_a_little(before, cage, 1.0).vertices])
    fine_steps = np.stack([fine.vertices, moved_a_little(after, fine, 1.0).vertices])
    certified = bool(verify_motion(cage, fine, cage_steps, fine_steps))
    contacts = faults_of_motion(cage.edges, fine.edges, cage_steps, fine_steps)
    assert not (certified and contacts)


def test_levels_are_judged_when_they_are_made() -> None:
    """The hook of this folder's tests catches a wrong level."""
    hierarchy = nested_cages(letter_a(), [letter_a_coarse()], FAST)
    level = hierarchy.levels[0]
    wrong = replace(level, cage=level.cage.moved(0.9 * level.cage.vertices))
    with pytest.raises(AssertionError, match="the judge found"):
        Hierarchy(hierarchy.fine, (wrong,))
    way = level.reinflation
    steps = way.cage_steps.copy()
    steps[1] *= 0.5
    wrong = replace(level, reinflation=replace(way, cage_steps=steps))
    with pytest.raises(AssertionError, match="between steps 0 and 1"):
        Hierarchy(hierarchy.fine, (wrong,))


@pytest.mark.thorough
def test_every_motion_of_random_shapes_by_the_judge() -> None:
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
    always = (0, 0, 0)  # the products with an edge of length zero
    assert not touches(always, always, always, squared_length=always, squared_distance=(9, 0, 0))
    assert touches(always, always, always, squared_length=always, squared_distance=(0, 0, 0))
