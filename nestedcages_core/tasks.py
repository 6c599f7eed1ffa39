"""Stages of a run are generators: they yield while they work and return their result.

The caller iterates over a stage to show its progress, and closes or drops it to cancel.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from contextvars import copy_context
from threading import Semaphore, Thread
from typing import Any, Generic, TypeAlias, TypeVar

from .errors import NestedCagesError

Yielded = TypeVar("Yielded")
Shown = TypeVar("Shown")
Result = TypeVar("Result")

Stage: TypeAlias = Generator[Yielded, None, Result]


def flat_mapped(stage: Stage[Yielded, Result], react: Callable[[Yielded], Iterable[Shown]]) -> Stage[Shown, Result]:
    """The same stage, closed with this one; instead of what it yields come the items that ``react`` makes of it."""
    try:
        while True:
            try:
                yielded = next(stage)
            except StopIteration as end:
                result: Result = end.value
                return result
            yield from react(yielded)
    finally:
        stage.close()


def mapped(stage: Stage[Yielded, Result], show: Callable[[Yielded], Shown]) -> Stage[Shown, Result]:
    """The same stage with ``show`` applied to what it yields."""
    return flat_mapped(stage, lambda yielded: (show(yielded),))


def drain(stage: Stage[Yielded, Result], listener: Callable[[Yielded], None] | None = None) -> Result:
    """Run a stage to its end and return its result; a listener is called with what it yields."""
    run = Run(stage)
    for yielded in run:
        if listener is not None:
            listener(yielded)
    return run.result


def limited(
    stage: Stage[Yielded, Result], is_over: Callable[[], bool], over: Callable[[Yielded], Exception]
) -> Stage[Yielded, Result]:
    """The same stage until something is over, asked at each step; then the error that ``over`` makes of the step."""

    def checked(yielded: Yielded) -> Iterator[Yielded]:
        if is_over():
            raise over(yielded)
        yield yielded

    return flat_mapped(stage, checked)


def listened(run: Run[Shown, Result], listener: Callable[[Shown], None] | bool | None) -> Result:
    """The result of a run; a listener is called with its progress. True: a bar of tqdm, or
    lines where that is not installed.
    """
    if listener is True:
        return _with_bar(run)
    if listener not in (None, False) and not callable(listener):
        said = f"progress must be True or a function, not {listener!r}."
        raise NestedCagesError(said, code="setting.invalid", name="progress", value=listener)
    for step in run:
        if callable(listener):
            listener(step)
    return run.result


def _with_bar(run: Run[Any, Result]) -> Result:
    """The result of a run whose progress has ``fraction`` and ``message``, shown as a bar."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _with_lines(run)
    with tqdm(total=100, bar_format="{l_bar}{bar}| {elapsed}") as bar:
        for step in run:
            bar.set_description_str(step.message, refresh=False)
            bar.update(round(100.0 * step.fraction) - bar.n)
        bar.update(100 - bar.n)
    return run.result


def _with_lines(run: Run[Any, Result]) -> Result:
    """The result of a run whose progress is printed to the standard error, a line for each tenth and each stage."""
    said = None
    for step in run:
        line = int(10.0 * step.fraction), step.message
        if line != said:
            print(f"{10 * line[0]:3} %  {step.message}", file=sys.stderr)
            said = line
    return run.result


def ticking(work: Callable[[Callable[[float], None]], Result]) -> Stage[float, Result]:
    """Work that calls a function with the fraction done, as a stage: in a thread that runs only while the caller waits.

    Closing the stage ends the work at its next call.
    """
    go, shown, steps, outcome = Semaphore(0), Semaphore(0), list[float](), list[Any]()

    def tick(fraction: float) -> None:
        steps.append(fraction)
        shown.release()
        go.acquire()
        if outcome:
            raise _Cancelled

    def run() -> None:
        try:
            outcome[:] = [work(tick), None]
        except BaseException as error:
            outcome[:] = [None, error]
        shown.release()

    thread = Thread(target=copy_context().run, args=(run,), daemon=True)
    thread.start()
    try:
        while True:
            shown.acquire()
            if not steps:
                break
            yield steps.pop()
            go.release()
    finally:
        if not outcome:
            outcome.append(None)
            go.release()
        thread.join()
    result, error = outcome
    if error is not None:
        raise error
    return result  # type: ignore[no-any-return]


class _Cancelled(BaseException):
    """Ends work that is no longer wanted; no handler of errors catches it."""


class Run(Generic[Shown, Result]):
    """A stage as an iterator over its progress, with the result at the end; dropping it cancels the work."""

    def __init__(self, work: Stage[Shown, Result]) -> None:
        self._work = work
        self._results: list[Result] = []
        self._over = False
        self._unfinished = "the run has no result yet: iterate over it to its end first"

    def __iter__(self) -> Iterator[Shown]:
        return self

    def __next__(self) -> Shown:
        try:
            return next(self._work)
        except StopIteration as end:
            if not self._over:
                self._over = True
                self._results.append(end.value)
            raise
        except BaseException as error:
            self._over = True
            self._unfinished = f"the run has no result: it ended with the error '{error}'"
            raise

    @property
    def result(self) -> Result:
        """The result of the stage. Raises RuntimeError before the end, or if the stage failed or was cancelled."""
        if not self._results:
            raise RuntimeError(self._unfinished)
        return self._results[0]

    def close(self) -> None:
        """Cancel the work; does nothing once it is finished."""
        if not self._over:
            self._over, self._unfinished = True, "the run has no result: it was cancelled"
        self._work.close()
