"""Progress on the standard error stream."""

from __future__ import annotations

import os
import sys
from errno import EINVAL
from typing import TextIO

from ..batch import BatchProgress
from ..hierarchy import Progress

BAR = 24
"""Characters of the progress bar."""


def tell(text: str, stream: TextIO) -> None:
    """Print a line; a closed pipe, as behind `head`, is ignored."""
    _write(f"{text}\n", stream)


def _write(text: str, stream: TextIO) -> None:
    try:
        stream.write(text)
        stream.flush()
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and not (sys.platform == "win32" and error.errno == EINVAL):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # on Windows a closed pipe is an invalid argument


class ProgressLine:
    """A progress bar on a terminal, one line per stage elsewhere."""

    def __init__(self, stream: TextIO, *, silent: bool) -> None:
        self.stream = stream
        self.silent = silent
        self.moving = stream.isatty()
        self.last = ""
        self.seen: set[str] = set()

    def of_run(self, progress: Progress) -> None:
        stage = f"level {progress.level + 1}, {progress.stage}"
        self._show(progress.fraction, progress.message if self.moving else stage)

    def of_batch(self, progress: BatchProgress) -> None:
        self._show(progress.fraction, f"{progress.finished} of {progress.total} features")

    def _show(self, fraction: float, text: str) -> None:
        if self.silent:
            return
        if self.moving:
            full = round(BAR * fraction)
            shown = f"[{'#' * full}{'.' * (BAR - full)}] {100 * fraction:3.0f} % {text}"
            _write("\r" + shown.ljust(len(self.last)), self.stream)
            self.last = shown
        elif text not in self.seen:
            _write(f"{100 * fraction:3.0f} % {text}\n", self.stream)
            self.seen.add(text)

    def end(self) -> None:
        """End the line of the bar."""
        if self.moving and self.last:
            _write("\n", self.stream)
        self.last = ""
