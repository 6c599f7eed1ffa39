"""The driver of all work in slices, while Blender stays usable; the panel shows the job that ``running()`` returns.

Work is a generator of `Progress` that returns its result. It computes first and writes last; a ``finally`` undoes what
a cancelled job must undo. Operators advance their jobs themselves. What goes on in the background is advanced by one
timer, while no other job is at work.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import bpy

# Seconds of work per tick of an operator's timer, and seconds between ticks: about ten redraws per second, with most of
# the time spent on work.
SLICE = 0.08
TICK = 0.01
# The same of the background, which leaves more to Blender.
BACKGROUND_SLICE, LOOK_INTERVAL = 0.03, 0.02

Result = TypeVar("Result")


@dataclass(frozen=True)
class Progress:
    """Fraction of the whole job that is done, what is being done, and seconds until there is something to do."""

    fraction: float
    message: str
    rest: float = 0.0


Work = Generator[Progress, None, Result]


class Job(Generic[Result]):
    """A job: ``fraction`` and ``message`` for display, ``cancelled`` to request cancelling, and ``end``, which stops it
    together with what has started it, given the context. ``result`` is set when it is done. ``rests``: whether there is
    nothing to do until ``due``. ``scene``: of a job in the background, the name of the scene whose window it works in.
    """

    result: Result

    def __init__(self, work: Work[Result], scene: str | None = None) -> None:
        self.fraction, self.message, self.cancelled = 0.0, "Starting", False
        self.scene, self.rests, self.due = scene, scene is not None, 0.0
        self.end: Callable[[bpy.types.Context], None] = lambda _context: self.stop()
        self._work = work

    def advance(self, seconds: float = SLICE) -> bool:
        """Works for about `seconds`, or until it rests; True when everything is done. Raises: UserError."""
        until = time.perf_counter() + seconds
        while True:
            try:
                progress = next(self._work)
            except StopIteration as done:
                self.result = done.value
                return True
            now = time.perf_counter()
            self.fraction, self.message = progress.fraction, progress.message
            self.rests, self.due = progress.rest > 0.0, now + progress.rest
            if self.rests or now >= until:
                return False

    def start(self, end: Callable[[bpy.types.Context], None] | None = None) -> None:
        """Makes this a job that `running` may return."""
        if end is not None:
            self.end = end
        _jobs.append(self)

    def stop(self) -> None:
        """Cancels the work; `running` does not return this job any more."""
        if self in _jobs:
            _jobs.remove(self)
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


_jobs: list[Job[Any]] = []


def running() -> Job[Any] | None:
    """The job that is at work, if there is one."""
    return next((job for job in _jobs if not job.rests), None)


def drive(work: Work[None], scene: str = "", end: Callable[[bpy.types.Context], None] | None = None) -> Job[None]:
    """Starts a job in the background."""
    job = Job(work, scene)
    job.start(end)
    if not bpy.app.timers.is_registered(_on_timer):
        bpy.app.timers.register(_on_timer, first_interval=LOOK_INTERVAL, persistent=True)
    return job


def _on_timer() -> float | None:
    """Goes on with the jobs in the background; seconds until the next look, None when nothing is left."""
    for job in [job for job in _jobs if job.scene is not None]:
        if job in _jobs and running() in {None, job} and time.perf_counter() >= job.due:
            done = True
            try:
                with in_window(window_of(job.scene, bpy.context.window_manager.windows)):
                    done = job.advance(BACKGROUND_SLICE)
            except Exception:  # shown like errors of timers, but the other jobs go on
                traceback.print_exc()
            if done:
                job.end(bpy.context)
    return LOOK_INTERVAL if any(job.scene is not None for job in _jobs) else None


def end_all(context: bpy.types.Context) -> None:
    """Ends all jobs."""
    for job in list(_jobs):
        job.end(context)
    if bpy.app.timers.is_registered(_on_timer):
        bpy.app.timers.unregister(_on_timer)


def window_of(scene: str | None, windows: Any) -> Any:
    """The window that shows a scene, or else the first one; None if there are no windows."""
    return next((window for window in windows if window.scene.name == scene), windows[0] if len(windows) else None)


def in_window(window: Any) -> AbstractContextManager[Any]:
    """The context of a window, which shows its own scene; None: that of now, as in the background."""
    return bpy.context.temp_override(window=window) if window is not None else nullcontext()
