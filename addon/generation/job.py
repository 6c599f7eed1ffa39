"""Work that goes on in slices while Blender stays usable; the panel shows what ``running()`` says."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

from .generate import Generation, Progress

# Seconds of work per tick of the timer, and seconds between ticks: some ten redraws a second, with most of the time
# spent working.
SLICE = 0.08
TICK = 0.01


class Job:
    """A generation under way: ``fraction`` and ``message`` for display, ``cancelled`` for anybody to set, and ``end``,
    which stops it with all that its operator has set up, given the context.
    """

    def __init__(self, generation: Generation) -> None:
        self.generation = generation
        self.fraction = 0.0
        self.message = "Starting"
        self.cancelled = False
        self.end: Callable[[Any], None] = lambda _context: self.stop()
        self._work: Iterator[Progress] = iter(generation)

    def advance(self, seconds: float = SLICE) -> bool:
        """Works for about `seconds`; True when everything is done. Raises: UserError.

        A stage that begins ends the slice: some report nothing while they work, and what is shown is what is done.
        """
        until = time.perf_counter() + seconds
        for progress in self._work:
            begins = progress.message != self.message
            self.fraction, self.message = progress.fraction, progress.message
            if begins or time.perf_counter() >= until:
                return False
        return True

    def drain(self) -> None:
        """Works to the end. Raises: UserError."""
        while not self.advance(float("inf")):
            pass

    def start(self, end: Callable[[Any], None] | None = None) -> None:
        """Makes this the job that `running` returns."""
        if end is not None:
            self.end = end
        _current.append(self)

    def stop(self) -> None:
        """Drops the work; `running` returns None again."""
        _current.clear()
        self._work = iter(())


_current: list[Job] = []


def running() -> Job | None:
    """The job under way, if there is one."""
    return _current[0] if _current else None
