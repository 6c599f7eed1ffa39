"""The driver of all work in slices, while Blender stays usable; the panel shows the job that ``running()`` returns.

Work is a generator of `Progress` that returns its result. It computes first and writes last, in one slice; a
``finally`` undoes what a cancelled job must undo. One timer goes on with all jobs: those of operators first, whose
`modal` only shows progress, and what goes on in the background while no other job is at work.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Generator, Iterator
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass
from typing import Any, TypeVar

import bpy
from bpy.types import Context

# Seconds of work per slice of an operator's job, and seconds between slices: about ten redraws per second, with most of
# the time spent on work.
SLICE, TICK = 0.08, 0.01
# The same of the background, which leaves more to Blender.
BACKGROUND_SLICE, LOOK_INTERVAL = 0.03, 0.02

Result = TypeVar("Result")
Shown = TypeVar("Shown")


@dataclass(frozen=True)
class Progress:
    """Fraction of the whole job that is done, what is being done, and seconds until there is something to do."""

    fraction: float
    message: str
    rest: float = 0.0


Work = Generator[Progress, None, Result]


class Job:
    """A job: ``fraction`` and ``message`` for display, ``cancelled`` to request cancelling, and ``end``, which stops it
    together with what has started it, given the context. ``done``: whether it has ended, maybe with an ``error``.
    ``rests``: whether there is nothing to do until ``due``. ``scene``: the name of the scene whose window it works in.
    """

    def __init__(self, work: Work[Any], scene: str = "", *, background: bool = False) -> None:
        self.fraction, self.message, self.cancelled = 0.0, "Starting", False
        self.done = False
        self.error: Exception | None = None
        self.scene, self.background, self.rests, self.due = scene, background, background, 0.0
        self.end: Callable[[Context], None] = lambda _context: self.stop()
        self._work = work

    def advance(self, seconds: float) -> bool:
        """Works for about `seconds`, or until it rests; True when it has ended."""
        until = time.perf_counter() + seconds
        try:
            while True:
                progress = next(self._work)
                now = time.perf_counter()
                self.fraction, self.message = progress.fraction, progress.message
                self.rests, self.due = progress.rest > 0.0, now + progress.rest
                if self.rests or now >= until:
                    return False
        except StopIteration:
            self.done = True
        except Exception as error:
            self.done, self.error = True, error
        return True

    def start(self, end: Callable[[Context], None] | None = None) -> None:
        """Hands this job to the driver."""
        self.end = end or self.end
        _jobs.append(self)
        if not bpy.app.timers.is_registered(_on_timer):
            bpy.app.timers.register(_on_timer, first_interval=TICK, persistent=True)

    def stop(self) -> None:
        """Cancels the work; `running` does not return this job any more."""
        if self in _jobs:
            _jobs.remove(self)
        with suppress(ReferenceError):  # another file was opened: there is nothing left to undo
            self._work.close()


def share(work: Work[Result], number: int, count: int, begin: float = 0.0, end: float = 1.0) -> Work[Result]:
    """Work on one of several things, with its progress scaled to that of all, which goes from `begin` to `end`."""

    def scaled(step: Progress) -> Progress:
        return Progress(begin + (end - begin) * (number + step.fraction) / count, step.message)

    return mapped(work, scaled)


def mapped(steps: Iterator[Shown], show: Callable[[Shown], Progress]) -> Work[Any]:
    """Work that shows the progress of a run, or of other work, and returns its result."""
    try:
        while True:
            try:
                step = next(steps)
            except StopIteration as end:
                return end.value
            yield show(step)
    finally:
        steps.close()  # type: ignore[attr-defined]


def drain(work: Work[Result]) -> Result:
    """The result of work, done at once."""
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value


_jobs: list[Job] = []


def running() -> Job | None:
    """The job that is at work, if there is one."""
    return next((job for job in _jobs if not job.rests), None)


def _on_timer() -> float | None:
    """Goes on with all jobs; seconds until the next look, None when nothing is left."""
    for job in list(_jobs):
        waits = job.done or (job.cancelled and not job.background)  # for its operator
        if waits or job not in _jobs or running() not in {None, job} or time.perf_counter() < job.due:
            continue
        with in_window(window_of(job.scene, bpy.context.window_manager.windows)):
            job.advance(BACKGROUND_SLICE if job.background else SLICE)
        if job.done and job.background:
            if job.error is not None:  # shown like errors of timers, but the other jobs go on
                traceback.print_exception(job.error)
            job.end(bpy.context)
    if not _jobs:
        return None
    return LOOK_INTERVAL if all(job.background for job in _jobs) else TICK


def end_all(context: Context) -> None:
    """Ends all jobs."""
    for job in list(_jobs):
        job.end(context)
    if bpy.app.timers.is_registered(_on_timer):
        bpy.app.timers.unregister(_on_timer)


def window_of(scene: str, windows: Any) -> Any:
    """The window that shows a scene, or else the first one; None if there are no windows."""
    return next((window for window in windows if window.scene.name == scene), windows[0] if len(windows) else None)


def in_window(window: Any) -> AbstractContextManager[Any]:
    """The context of a window, which shows its own scene; None: that of now, as in the background."""
    return bpy.context.temp_override(window=window) if window is not None else nullcontext()
