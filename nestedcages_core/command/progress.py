"""Progress on the standard error stream."""

from __future__ import annotations

import os
import sys
from errno import EINVAL
from time import perf_counter
from typing import TextIO

from ..batch import BatchProgress
from ..hierarchy import Progress

BAR = 24
"""Characters of the progress bar."""

LEAST_PASSED = 1.0
"""Seconds after which the time left is told."""


def tell(text: str, stream: TextIO | None) -> None:
    """Print a line; a closed stream, or a closed pipe as behind `head`, is ignored."""
    _write(f"{text}\n", stream)


def _write(text: str, stream: TextIO | None) -> None:
    if stream is None or stream.closed:
        return
    try:
        stream.write(text)
        stream.flush()
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and not (sys.platform == "win32" and error.errno == EINVAL):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # on Windows a closed pipe is an invalid argument


class ProgressLine:
    """A progress bar with the time left on a terminal, one line per stage elsewhere."""

    def __init__(self, stream: TextIO | None, *, silent: bool, files: int = 1) -> None:
        self.stream = stream
        self.silent = silent or stream is None or stream.closed
        self.moving = not self.silent and stream is not None and stream.isatty()
        self.files = files
        self.began = perf_counter()
        self.file = 0
        self.last = ""
        self.seen: set[str] = set()

    def next_file(self, number: int) -> None:
        """Tell which of the files, from 0, is read next."""
        self.file = number
        self.seen.clear()

    def of_run(self, progress: Progress) -> None:
        stage = f"level {progress.level + 1}, {progress.stage}"
        self._show(progress.fraction, progress.message if self.moving else stage)

    def of_batch(self, progress: BatchProgress) -> None:
        self._show(progress.fraction, f"{progress.finished} of {progress.total} features")

    def _show(self, fraction: float, text: str) -> None:
        if self.silent:
            return
        if self.moving:
            whole = (self.file + fraction) / self.files
            full = round(BAR * whole)
            where = f"file {self.file + 1} of {self.files}, " if self.files > 1 else ""
            shown = f"[{'#' * full}{'.' * (BAR - full)}] {100 * whole:3.0f} % {self._left(whole)}{where}{text}"
            _write("\r" + shown.ljust(len(self.last)), self.stream)
            self.last = shown
        elif text not in self.seen:
            _write(f"{100 * fraction:3.0f} % {text}\n", self.stream)
            self.seen.add(text)

    def _left(self, done: float) -> str:
        """The time left in words, once it can be told."""
        passed = perf_counter() - self.began
        if passed < LEAST_PASSED or done <= 0.0:
            return ""
        seconds = round(passed * (1.0 - done) / done)
        return f"{seconds // 60}:{seconds % 60:02} left, "

    def end(self) -> None:
        """End the line of the bar."""
        if self.moving and self.last:
            _write("\n", self.stream)
        self.last = ""
