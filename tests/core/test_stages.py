"""Stages are generators: drained, mapped, and stopped between any two of their yields."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from nestedcages_core import (
    ArcLength,
    Found,
    InnerCagesRun,
    LineCycles,
    Mesh,
    NestedCagesError,
    NestedCagesRun,
    NestingError,
    OnCurve,
    OuterHull,
    Progress,
    Settings,
    Within,
    animated_cages,
    inner_cages,
    nested_cages,
    verify,
    verify_motion,
)
from nestedcages_core.cache import forget
from nestedcages_core.hierarchy import run
from nestedcages_core.motion.animated import AnimatedCagesRun
from nestedcages_core.tasks import Run, Stage, drain, mapped
from support.marks import slow_after
from support.shapes import letter_a, ring, star


def counting(log: list[str], count: int = 3) -> Stage[int, str]:
    try:
        yield from range(count)
    finally:
        log.append("cleaned up")
    return "result"


def failing() -> Stage[int, str]:
    yield 0
    raise NestingError("it went wrong")


class TestTime:
    """Time to make the cages in; a clock that a test sets."""

    @pytest.fixture
    def clock(self, monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
        now = [0.0]
        monkeypatch.setattr(run, "perf_counter", lambda: now[0])
        return lambda seconds: now.__setitem__(0, now[0] + seconds)

    def test_levels_made_in_time_are_kept(self, clock: Callable[[float], None]) -> None:
        def a_second_each_from_level_2(progress: Progress) -> None:
            clock(float(progress.level > 0))

        with pytest.raises(NestedCagesError, match="The time of 1 s was over during level 2 of 3: ") as caught:
            nested_cages(star(), [8, 6, 4], seconds=1.0, progress=a_second_each_from_level_2)
        error = caught.value
        assert (error.code, error.data["level"], len(error.partial)) == ("time.over", 1, 1)
        assert verify(error.partial[0].cage, error.partial.fine)

    @pytest.mark.parametrize("options", [{"grid": 0.01}, {"symmetry": Found()}, {"stored": np.float32}])
    def test_needs_count(self, clock: Callable[[float], None], options: dict[str, Any]) -> None:
        with pytest.raises(NestedCagesError, match="was over during level 1 of 1"):
            nested_cages(star(), 8, seconds=0.5, progress=lambda _: clock(0.3), **options)

    def test_within_a_tolerance_counts(self, clock: Callable[[float], None]) -> None:
        with pytest.raises(NestedCagesError, match="was over during level 1 of 1"):
            inner_cages(star(), Within(excess=0.5), seconds=0.5, progress=lambda _: clock(0.3))

    @pytest.mark.parametrize(
        ("work", "options"),
        [
            (nested_cages, {"convex": True}),
            pytest.param(nested_cages, {}, marks=pytest.mark.slow),
            pytest.param(nested_cages, {"stored": np.float32}, marks=pytest.mark.thorough),
            pytest.param(nested_cages, {"grid": 0.02}, marks=pytest.mark.thorough),
            pytest.param(inner_cages, {}, marks=pytest.mark.slow),
        ],
        ids=["convex", "around", "stored", "grid", "inside"],
    )
    def test_the_best_cage_by_then_is_kept(
        self, clock: Callable[[float], None], work: Any, options: dict[str, Any]
    ) -> None:
        """Time ends during each stage and each step of the tightening in turn: a cage, or an error where none is."""
        forget()
        steps: list[Progress] = []
        whole = work(star(), 8, progress=steps.append, **options)[0]
        kept = 0
        for last in range(0, len(steps), 3):
            forget()
            calls = iter(range(len(steps) + 99))
            try:
                level = work(
                    star(), 8, seconds=1.0, progress=lambda _, c=calls, k=last: clock(9.0 * (next(c) == k)), **options
                )[0]
            except NestedCagesError as error:
                assert error.code == "time.over"
                assert steps[last].stage in ("decimation", "flow", "reinflation", "tightening")
                assert not kept  # none before it, but always one after it
                continue
            late = [each for each in level.report.notes if each.code == "note.time"]
            pair = (level.fine, level.cage) if level.inside else (level.cage, level.fine)
            assert verify(*pair, level.report.wanted_clearance)
            assert verify_motion(level.cage, level.fine, level.reinflation.cage_steps, level.reinflation.fine_path)
            assert level.side * level.excess >= level.side * whole.excess - 1e-9
            assert len(late) == (last < len(steps) - 1)
            kept += len(late)
        assert kept

    def test_work_is_limited_too(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Whatever a search is about, it ends: with the best cage by then, or in a sentence with what was reached."""
        for most, code in ((5, "work.over"), (24, "note.work")):
            forget()
            monkeypatch.setattr(run, "MOST_STEPS", most - run.STEPS_OF_A_LOOP)
            if code == "work.over":
                with pytest.raises(
                    NestedCagesError, match=r"No cage was found in 5 steps of work, .* level 1 of 1"
                ) as caught:
                    nested_cages(star(), 8, grid=0.02)
                assert (caught.value.code, caught.value.data["steps"]) == (code, most)
            else:
                level = nested_cages(star(), 8)[0]
                (said,) = [each for each in level.report.notes if each.code == code]
                assert said.data["steps"] == most and verify(level.cage, level.fine)

    def test_the_next_level_gets_no_time(self, clock: Callable[[float], None]) -> None:
        """The hierarchy is not shorter in silence: its first level is kept with a note, then comes the error."""
        forget()

        def late(progress: Progress) -> None:
            clock(9.0 * (progress.stage == "tightening"))

        with pytest.raises(NestedCagesError, match="during level 2 of 2") as caught:
            nested_cages(star(), [12, 6], seconds=1.0, progress=late)
        assert [note.code for note in caught.value.partial[0].report.notes if note.code == "note.time"]

    @pytest.mark.slow
    def test_enough_time_changes_nothing(self) -> None:
        limited, free = nested_cages(star(), 8, seconds=1e6), nested_cages(star(), 8)
        assert np.array_equal(limited.cages[0].vertices, free.cages[0].vertices)

    @pytest.mark.parametrize("seconds", [0.0, -1.0, np.nan, np.inf, "long"])
    def test_no_time_is_an_error(self, seconds: Any) -> None:
        with pytest.raises(NestedCagesError, match="seconds must be a finite time above 0"):
            Settings(seconds=seconds)


class TestStages:
    def test_drain_returns_the_result(self) -> None:
        assert drain(counting([])) == "result"
        assert drain(counting([], 0)) == "result"

    def test_mapped_applies_a_function_to_what_is_yielded(self) -> None:
        stage = mapped(counting([]), lambda number: 10 * number)
        assert [next(stage), next(stage), next(stage)] == [0, 10, 20]
        with pytest.raises(StopIteration) as end:
            next(stage)
        assert end.value.value == "result"

    def test_closing_the_outer_stage_closes_the_inner_one(self) -> None:
        log: list[str] = []
        stage = mapped(counting(log), str)
        next(stage)
        del stage
        assert log == ["cleaned up"]


class TestRun:
    def test_it_iterates_over_progress_and_has_a_result_at_the_end(self) -> None:
        run = Run(counting([]))
        with pytest.raises(RuntimeError, match="iterate over it to its end"):
            _ = run.result
        assert list(run) == [0, 1, 2] and run.result == "result"
        assert list(run) == [] and run.result == "result"

    def test_closing_a_finished_run_keeps_its_result(self) -> None:
        run = Run(counting([]))
        list(run)
        run.close()
        assert run.result == "result"

    def test_an_error_is_raised_and_remembered(self) -> None:
        run = Run(failing())
        with pytest.raises(NestingError):
            list(run)
        with pytest.raises(RuntimeError, match="it went wrong"):
            _ = run.result


class StopError(Exception):
    """Raised by a listener to cancel."""


RUNS: dict[str, Callable[[], Run[Any, Any]]] = {
    "cages": lambda: NestedCagesRun(letter_a(2), [24, 14]),
    "inner cages": lambda: InnerCagesRun(star(5, 60), [20, 12]),
    "a motion": lambda: AnimatedCagesRun(star(5, 60), [(1.0 + 0.1 * k) * star(5, 60).vertices for k in range(3)], [12]),
}


@pytest.mark.slow
@pytest.mark.parametrize("make", slow_after(2, RUNS.values()), ids=RUNS.keys())
def test_a_run_can_be_stopped_at_every_yield(make: Callable[[], Run[Any, Any]]) -> None:
    """At places spread over the whole run; what was yielded before is the same each time."""
    whole = list(make())
    for stop in sorted({round(k * (len(whole) - 1) / 3) for k in range(4)}):
        forget()  # a run of its own
        run = make()
        seen = [next(run) for _ in range(stop + 1)]
        assert seen == whole[: stop + 1]
        run.close()
        assert list(run) == []
        with pytest.raises(RuntimeError, match="it was cancelled"):
            _ = run.result


def test_a_listener_that_raises_stops_the_work_at_once() -> None:
    def after(count: int) -> Iterator[None]:
        for _ in range(count):
            yield
        raise StopError

    for work in (nested_cages, inner_cages):
        for count in (0, 1, 7):
            calls = after(count)
            seen: list[object] = []

            def listen(progress: object, seen: list[object] = seen, calls: Iterator[None] = calls) -> None:
                seen.append(progress)
                next(calls)

            with pytest.raises(StopError):
                work(star(), [24], progress=listen)
            assert len(seen) == count + 1
    with pytest.raises(StopError):
        fine = star(5, 60)
        animated_cages(fine, [fine.vertices, 1.1 * fine.vertices], [12], progress=lambda _: next(after(0)))


@pytest.mark.slow
def test_every_stage_yields_often_enough_to_cancel() -> None:
    """Set-up, certificates, rejected steps and halves of a step yield as well: the test counts yields, not seconds.

    The set-up of a hull has a part of its own for gaps, for each scale of them and for the touching edges; a
    certificate has one for each block of steps of the motion.
    """
    turn = ring(1100)
    fine = Mesh.from_loops([turn * (1.0 + 0.2 * (turn[:, :1] * 20.0 % 1.0))])
    settings = Settings(decimation=OnCurve(around=OuterHull()))
    stages = [progress.stage for progress in NestedCagesRun(fine, [24], settings)]
    moves = (len(turn) - 24) // 512  # of the first run of the hull, at least
    assert stages.count("decimation") >= moves + 5
    run = NestedCagesRun(fine, [24], Settings(decimation=ArcLength()))  # a long way
    stages = [progress.stage for progress in run]
    steps = len(run.hierarchy.levels[0].reinflation.moving_steps) - 1
    assert stages.count("reinflation") >= 2 * steps >= 4  # two halves of each step
    assert stages.count("verification") >= 3  # one for each block of steps, whose size is bounded
    forget()
    first_move = next(k for k, progress in enumerate(NestedCagesRun(fine, [24], settings)) if progress.fraction > 0.0)
    assert first_move >= 5
    for cycles in (LineCycles(), OnCurve()):  # candidates, free parts, turns, programs and rounds
        stages = [progress.stage for progress in NestedCagesRun(fine, [24], Settings(decimation=cycles))]
        assert stages.count("decimation") >= 6
