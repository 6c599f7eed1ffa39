"""Work in slices while Blender stays usable; the panel shows the job that ``running()`` returns.

Work is a generator of `Progress` that returns its result. It computes first and writes last; a ``finally`` undoes what
a cancelled job must undo.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import bpy

# Seconds of work per tick of the timer, and seconds between ticks: about ten redraws per second, with most of the time
# spent on work.
SLICE = 0.08
TICK = 0.01

Result = TypeVar("Result")


@dataclass(frozen=True)
class Progress:
    """Fraction of the whole job that is done, and what is being done."""

    fraction: float
    message: str


Work = Generator[Progress, None, Result]


class Job(Generic[Result]):
    """A running job: ``fraction`` and ``message`` for display, ``cancelled`` to request cancelling, and ``end``, which
    stops it together with its operator, given the context. ``result`` is set when it is done.
    """

    result: Result

    def __init__(self, work: Work[Result]) -> None:
        self.fraction = 0.0
        self.message = "Starting"
        self.cancelled = False
        self.end: Callable[[bpy.types.Context], None] = lambda _context: self.stop()
        self._work = work

    def advance(self, seconds: float = SLICE) -> bool:
        """Works for about `seconds`; True when everything is done. Raises: UserError."""
        until = time.perf_counter() + seconds
        while True:
            try:
                progress = next(self._work)
            except StopIteration as done:
                self.result = done.value
                return True
            self.fraction, self.message = progress.fraction, progress.message
            if time.perf_counter() >= until:
                return False

    def start(self, end: Callable[[bpy.types.Context], None] | None = None) -> None:
        """Makes this the job that `running` returns."""
        if end is not None:
            self.end = end
        _current.append(self)

    def stop(self) -> None:
        """Cancels the work; `running` returns None again."""
        _current.clear()
        with suppress(ReferenceError):  # another file was opened: there is nothing left to undo
            self._work.close()


def part(work: Work[Result], number: int, count: int, begin: float = 0.0, end: float = 1.0) -> Work[Result]:
    """Work on one of several things, with its progress scaled to that of all, which goes from `begin` to `end`."""
    try:
        while True:
            try:
                step = next(work)
            except StopIteration as done:
                result: Result = done.value
                return result
            yield Progress(begin + (end - begin) * (number + step.fraction) / count, step.message)
    finally:
        work.close()


def completed(work: Work[Result]) -> Result:
    """Runs work to its end at once and returns its result. Raises: UserError."""
    while True:
        try:
            next(work)
        except StopIteration as done:
            result: Result = done.value
            return result


_current: list[Job[Any]] = []


def running() -> Job[Any] | None:
    """The running job, if there is one."""
    return _current[0] if _current else None
