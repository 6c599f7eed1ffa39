"""Progress on the standard error stream."""

from __future__ import annotations

import os
import sys
from errno import EINVAL
from time import perf_counter
from typing import TextIO

from ..batch import BatchProgress
from ..levels import Progress

BAR = 24
"""Characters of the progress bar."""

LEAST_PASSED = 1.0
"""Seconds after which the time left is told."""


def tell(text: str, stream: TextIO | None, *, end: str = "\n") -> None:
    """Print a line; a closed stream, or a closed pipe as behind `head`, is ignored."""
    if stream is None or stream.closed:
        return
    try:
        stream.write(f"{text}{end}")
        stream.flush()
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and not (sys.platform == "win32" and error.errno == EINVAL):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # on Windows a closed pipe is an invalid argument


class ProgressLine:
    """A progress bar with the time left on a terminal, one line per stage elsewhere."""

    def __init__(self, stream: TextIO | None, *, silent: bool, files: int = 1) -> None:
        self.stream = None if silent or stream is None or stream.closed else stream
        self.moving = self.stream is not None and self.stream.isatty()
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
        if self.moving:
            done, passed = (self.file + fraction) / self.files, perf_counter() - self.began
            seconds = round(passed * (1.0 - done) / done) if passed >= LEAST_PASSED and done > 0.0 else None
            left = "" if seconds is None else f"{seconds // 60}:{seconds % 60:02} left, "
            where = f"file {self.file + 1} of {self.files}, " if self.files > 1 else ""
            shown = f"[{'#' * round(BAR * done):.<{BAR}}] {100 * done:3.0f} % {left}{where}{text}"
            tell("\r" + shown.ljust(len(self.last)), self.stream, end="")
            self.last = shown
        elif text not in self.seen:
            tell(f"{100 * fraction:3.0f} % {text}", self.stream)
            self.seen.add(text)

    def end(self) -> None:
        """End the line of the bar."""
        if self.last:
            tell("", self.stream)
        self.last = ""
