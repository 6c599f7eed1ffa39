"""Turns work that reports by a callback into an iterator over its reports.

The work runs in a thread of its own, but never at the same time as its reader: it stands still from each report until
the next one is asked for. So a loop can pause it, look, and go on, or drop the iterator, which ends the work at its
next report.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

Report = TypeVar("Report")
Result = TypeVar("Result")


class _Abandoned(BaseException):
    """Raised inside the work at its next report after the reader has gone; never seen outside."""


class _Exchange(Generic[Report, Result]):
    """What worker and reader share. Holds no reference to the iterator, so that dropping the iterator can end the
    worker."""

    def __init__(self, work: Callable[[Callable[[Report], None]], Result]) -> None:
        self.work = work
        self.proceed = threading.Semaphore(0)
        self.arrived = threading.Semaphore(0)
        self.reports: list[Report] = []
        self.results: list[Result] = []
        self.error: BaseException | None = None
        self.over = False
        self.abandoned = False

    def report(self, report: Report) -> None:
        self.reports.append(report)
        self.pause()

    def pause(self) -> None:
        self.arrived.release()
        self.proceed.acquire()
        if self.abandoned:
            raise _Abandoned

    def run(self) -> None:
        self.proceed.acquire()
        try:
            if not self.abandoned:
                self.results.append(self.work(self.report))
        except _Abandoned:
            pass
        except BaseException as error:  # handed over to the reader, whatever it is
            self.error = error
        self.over = True
        self.arrived.release()


class Stepwise(Generic[Report, Result]):
    """Iterator over the reports of ``work(report)``; ``result`` is what the work returned, once the iterator is
    exhausted."""

    def __init__(self, work: Callable[[Callable[[Report], None]], Result]) -> None:
        self._exchange: _Exchange[Report, Result] = _Exchange(work)
        self._thread: threading.Thread | None = None

    def __iter__(self) -> Iterator[Report]:
        return self

    def __next__(self) -> Report:
        exchange = self._exchange
        if exchange.over or exchange.abandoned:
            raise StopIteration
        if self._thread is None:
            self._thread = threading.Thread(target=exchange.run, name="nested-cages", daemon=True)
            self._thread.start()
        exchange.proceed.release()
        exchange.arrived.acquire()
        if exchange.reports:
            return exchange.reports.pop()
        self._thread.join()
        if exchange.error is not None:
            raise exchange.error
        raise StopIteration

    @property
    def result(self) -> Result:
        """What the work returned; RuntimeError while it has not, or if it never will."""
        exchange = self._exchange
        if exchange.error is not None:
            raise RuntimeError(f"the run has no result: it ended with the error '{exchange.error}'")
        if exchange.abandoned and not exchange.results:
            raise RuntimeError("the run has no result: it was cancelled")
        if not exchange.results:
            raise RuntimeError("the run has no result yet: iterate over it to its end first")
        return exchange.results[0]

    def close(self) -> None:
        """End the work at its next report; nothing happens when it is over."""
        exchange = self._exchange
        exchange.abandoned = True
        if self._thread is not None and self._thread.is_alive():
            exchange.proceed.release()
            self._thread.join()

    def __del__(self) -> None:
        self.close()
