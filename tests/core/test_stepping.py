"""Work that reports by a callback, as an iterator."""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable

import pytest

from nestedcages_core.hierarchy.stepping import Stepwise


def counting(report: Callable[[int], None]) -> str:
    for k in range(3):
        report(k)
    return "counted"


def test_reports_come_in_order_and_the_result_at_the_end() -> None:
    run: Stepwise[int, str] = Stepwise(counting)
    assert list(run) == [0, 1, 2]
    assert run.result == "counted"
    assert list(run) == []


def test_there_is_no_result_before_the_end() -> None:
    run: Stepwise[int, str] = Stepwise(counting)
    next(run)
    with pytest.raises(RuntimeError, match="no result yet"):
        _ = run.result


def test_the_work_stands_still_between_reports() -> None:
    done = []

    def work(report: Callable[[int], None]) -> None:
        for k in range(3):
            done.append(k)
            report(k)

    run: Stepwise[int, None] = Stepwise(work)
    assert done == []
    next(run)
    assert done == [0]
    next(run)
    assert done == [0, 1]


def test_errors_reach_the_reader() -> None:
    def work(report: Callable[[int], None]) -> None:
        report(1)
        raise ValueError("broken")

    run: Stepwise[int, None] = Stepwise(work)
    assert next(run) == 1
    with pytest.raises(ValueError, match="broken"):
        next(run)
    with pytest.raises(StopIteration):
        next(run)
    with pytest.raises(RuntimeError, match="it ended with the error 'broken'"):
        _ = run.result


@pytest.mark.parametrize("how", ["close", "drop"])
def test_leaving_early_ends_the_work(how: str) -> None:
    cleaned = threading.Event()

    def work(report: Callable[[int], None]) -> None:
        try:
            for k in range(1000):
                report(k)
        finally:
            cleaned.set()

    run: Stepwise[int, None] = Stepwise(work)
    next(run)
    if how == "close":
        run.close()
        assert list(run) == []
        with pytest.raises(RuntimeError, match="it was cancelled"):
            _ = run.result
    else:
        del run
        gc.collect()
    assert cleaned.wait(5.0)


def test_a_run_that_never_started_can_be_dropped() -> None:
    run: Stepwise[int, str] = Stepwise(counting)
    run.close()
    assert list(run) == []
