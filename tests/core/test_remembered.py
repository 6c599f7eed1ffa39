"""Runs of hulls that go on where others have ended give the same hulls, to the last bit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from nestedcages_core import Found, InteriorARAP, Mesh, OuterHull, Settings, Within, nested_cages
from nestedcages_core.cache import forget
from nestedcages_core.decimation.hull import remembered
from nestedcages_core.decimation.hull.hull_search import EVEN_WEIGHTS, RESTART_WEIGHTS, middle_size, stage_size
from nestedcages_core.decimation.hull.progressive_hull import ProgressiveHull
from nestedcages_core.decimation.hull.remembered import RememberedHull, remembered_hull
from nestedcages_core.decimation.outline import Outline
from nestedcages_core.decimation.request import canonical_order
from nestedcages_core.level.builder import LevelBuilder
from nestedcages_core.tasks import drain
from shapes import islands, letter_a, star

SHAPES = pytest.mark.parametrize("shape", [letter_a, star, islands])


def outline_of(mesh: Mesh) -> Outline:
    return canonical_order(mesh)[0]


def assert_same(one: Outline, other: Outline) -> None:
    assert one.sizes == other.sizes
    assert (one.vertices == other.vertices).all()
    assert (one.spans == other.spans).all()


@SHAPES
@pytest.mark.parametrize("weights", [EVEN_WEIGHTS, *RESTART_WEIGHTS])
def test_hulls_of_any_order_of_counts_are_those_of_runs_of_their_own(shape, weights) -> None:
    start = outline_of(shape())
    minimum = [3] * len(start.sizes)
    run = RememberedHull(start, weights, minimum)
    for count in (60, 90, 31, 30, 16, 200, 3, 24, len(start.vertices), 1):
        assert_same(run.run(count), ProgressiveHull(start, weights, minimum).run(count))


def test_runs_that_are_interleaved_do_not_disturb_each_other() -> None:
    start = outline_of(star(9, 3000))
    both = [RememberedHull(start, EVEN_WEIGHTS, [3])] * 2
    first, second = (run.steps(count) for run, count in zip(both, (700, 40), strict=True))
    next(first), next(second), next(first)
    for stage, count in ((second, 40), (first, 700)):
        assert_same(drain(stage), ProgressiveHull(start, EVEN_WEIGHTS, [3]).run(count))


@SHAPES
def test_cages_are_the_same_bits_whatever_was_asked_for_before(shape) -> None:
    fine = shape()
    fewest = 4 * len(fine.loops)
    counts = [fewest, fewest + 9, fewest + 30, fewest + 10]
    alone = []
    for count in counts:
        forget()
        alone.append(nested_cages(fine, [count]).levels[0])
    forget()
    for count, level in zip(counts, alone, strict=True):
        again = nested_cages(fine, [count]).levels[0]
        assert (again.cage.vertices == level.cage.vertices).all()
        assert (again.coarse.vertices == level.coarse.vertices).all()
        assert again.reinflation.cage_steps.shape == level.reinflation.cage_steps.shape


def test_another_clearance_or_a_need_gives_the_same_as_a_fresh_start() -> None:
    fine = star(5, 60)
    for levels, settings in (([16], Settings(clearance=0.02)), ([Within(excess=0.1)], None)):
        forget()
        fresh = nested_cages(fine, levels, settings).cages[0]
        nested_cages(fine, [24, 16])
        assert (nested_cages(fine, levels, settings).cages[0].vertices == fresh.vertices).all()


def test_known_runs_make_no_moves(monkeypatch) -> None:
    fine = star()
    OuterHull().decimate(fine, 20)

    def fail(*_: object) -> None:
        raise AssertionError("a move")

    for move in ("_drop", "_extend", "_pivot"):
        monkeypatch.setattr(ProgressiveHull, move, fail)
    for count in (20, 22, 24):
        OuterHull().decimate(fine, count)
    with pytest.raises(AssertionError, match="a move"):
        OuterHull().decimate(star(9, 181), 20)


def test_counts_close_to_each_other_restart_from_the_same_size() -> None:
    counts = range(3, 200)
    for size_of, factor, most in ((stage_size, 3.0, 12), (middle_size, 2.0, 22)):
        sizes = [size_of(count) for count in counts]
        assert sizes == sorted(sizes)
        assert len(set(sizes)) < most
        assert all(size >= 0.89 * factor * count - 0.5 for size, count in zip(sizes, counts, strict=True))


def test_a_run_that_was_interrupted_in_a_move_is_not_used_again(monkeypatch) -> None:
    start = outline_of(star())
    run = remembered_hull(start, EVEN_WEIGHTS, [3])
    assert remembered_hull(start, EVEN_WEIGHTS, [3]) is run

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(RememberedHull, "_extend", interrupted)
        with pytest.raises(KeyboardInterrupt):
            run.run(20)
    other = remembered_hull(start, EVEN_WEIGHTS, [3])
    assert other is not run
    assert_same(other.run(20), ProgressiveHull(start, EVEN_WEIGHTS, [3]).run(20))


def test_memory_is_bounded_and_forgets_the_oldest() -> None:
    largest = remembered.CAPACITY // (4 * remembered.BYTES_PER_VERTEX)
    first = outline_of(star(9, largest))
    oldest = remembered_hull(first, EVEN_WEIGHTS, [3])
    for k in range(3):
        remembered_hull(first.moved(first.vertices + k + 1.0), EVEN_WEIGHTS, [3])
    assert remembered_hull(first, EVEN_WEIGHTS, [3]) is oldest
    for k in range(4):
        remembered_hull(first.moved(first.vertices - k - 1.0), EVEN_WEIGHTS, [3])
    assert remembered_hull(first, EVEN_WEIGHTS, [3]) is not oldest
    larger = outline_of(star(9, largest + 1))
    assert not isinstance(remembered_hull(larger, EVEN_WEIGHTS, [3]), RememberedHull)


def test_what_is_asked_for_is_told_apart() -> None:
    start = outline_of(star())
    run = remembered_hull(start, EVEN_WEIGHTS, [3])
    others = [
        remembered_hull(start, RESTART_WEIGHTS[-1], [3]),
        remembered_hull(start, EVEN_WEIGHTS, [4]),
        remembered_hull(start.moved(np.nextafter(start.vertices, 9.0)), EVEN_WEIGHTS, [3]),
        remembered_hull(Outline(start.vertices, start.sizes, start.spans[::-1]), EVEN_WEIGHTS, [3]),
    ]
    assert all(other is not run for other in others)


@pytest.mark.parametrize("options", [{}, {"grid": 0.01}, {"symmetry": Found()}, {"energy": InteriorARAP()}])
def test_the_very_same_request_is_answered_at_once(options: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    fine = star()
    forget()
    first = nested_cages(fine, [24, 12], **options)

    def computed(*_: object) -> Iterator[None]:
        pytest.fail("computed again")
        yield

    monkeypatch.setattr(LevelBuilder, "build", computed)
    again = nested_cages(Mesh(fine.vertices, fine.edges), [24, 12], **options)
    assert again.cages == first.cages
    assert again[0].report == first[0].report
    assert not np.shares_memory(again[0].flow.steps, first[0].flow.steps)
