"""Work as an iterator over what it reports, or with a bar that shows it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextvars import copy_context
from threading import Semaphore, Thread
from typing import Any, Generic, TypeVar

Shown = TypeVar("Shown")
Result = TypeVar("Result")


class Cancelled(BaseException):
    """Ends work that is no longer wanted; no handler of errors catches it."""


class Run(Generic[Shown, Result]):
    """Work as an iterator over what it reports, with the result at the end; dropping it cancels the work.

    The work runs in a thread of its own, but only while `next` waits for it: nothing runs at the same time.
    """

    def __init__(self, work: Callable[[Callable[[Shown], None]], Result]) -> None:
        """work: called with a function to report by."""
        self._turns = _Turns[Shown, Result](work)
        self._over = False
        self._unfinished = "the run has no result yet: iterate over it to its end first"

    def __iter__(self) -> Iterator[Shown]:
        return self

    def __next__(self) -> Shown:
        if self._over:
            raise StopIteration
        turns = self._turns
        turns.next()
        if turns.reports:
            return turns.reports.pop()
        self._over = True
        error, turns.error = turns.error, None
        if error is not None:
            self._unfinished = f"the run has no result: it ended with the error '{error}'"
            raise error
        raise StopIteration(self.result)

    @property
    def result(self) -> Result:
        """The result of the work. Raises RuntimeError before the end, or if it failed or was cancelled."""
        if not self._turns.results:
            raise RuntimeError(self._unfinished)
        return self._turns.results[0]

    def close(self) -> None:
        """Cancel the work; does nothing once it is finished."""
        if not self._over:
            self._over, self._unfinished = True, "the run has no result: it was cancelled"
            self._turns.cancel()

    def __del__(self) -> None:
        self.close()


class _Turns(Generic[Shown, Result]):
    """Work and its caller take turns. The thread of the work knows this, and not the run, which may be dropped."""

    def __init__(self, work: Callable[[Callable[[Shown], None]], Result]) -> None:
        self.reports: list[Shown] = []
        self.results: list[Result] = []
        self.error: BaseException | None = None
        self._work, self._cancelled = work, False
        self._thread: Thread | None = None
        self._go, self._stopped = Semaphore(0), Semaphore(0)

    def next(self) -> None:
        """Let the work go on until it reports or ends."""
        if self._thread is None:
            self._thread = Thread(target=copy_context().run, args=(self._all,), daemon=True)
            self._thread.start()
        else:
            self._go.release()
        self._stopped.acquire()
        if not self.reports:
            self._thread.join()

    def cancel(self) -> None:
        """End the work where it is."""
        if self._thread is not None and self._thread.is_alive():
            self._cancelled = True
            self._go.release()
            self._thread.join()

    def _all(self) -> None:
        try:
            self.results.append(self._work(self._report))
        except BaseException as error:
            self.error = error
        self._stopped.release()

    def _report(self, shown: Shown) -> None:
        self.reports.append(shown)
        self._stopped.release()
        self._go.acquire()
        if self._cancelled:
            raise Cancelled


def with_bar(work: Callable[[Callable[[Any], None]], Result]) -> Result:
    """The result of work whose reports have ``fraction`` and ``message``, shown as a bar."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return work(_Lines().show)
    with tqdm(total=100, bar_format="{l_bar}{bar}| {elapsed}") as bar:

        def show(progress: Any) -> None:
            bar.set_description_str(progress.message, refresh=False)
            bar.update(round(100.0 * progress.fraction) - bar.n)

        result = work(show)
        bar.update(100 - bar.n)
    return result


class _Lines:
    """Prints progress to the standard error, a line for each tenth and each message."""

    def __init__(self) -> None:
        self._said: object = None

    def show(self, progress: Any) -> None:
        line = int(10.0 * progress.fraction), progress.message
        if line != self._said:
            print(f"{10 * line[0]:3} %  {progress.message}", file=sys.stderr)
            self._said = line
