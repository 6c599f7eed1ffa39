"""What is printed: lines on the standard streams, and progress."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from errno import EINVAL
from time import perf_counter
from typing import Any, TextIO

from ..errors import NestedCagesError

STANDARD_OUTPUT = "standard output"
"""Its name in messages."""

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
        drop(stream)
        # on Windows a closed pipe is an invalid argument
        if not isinstance(error, BrokenPipeError) and not (sys.platform == "win32" and error.errno == EINVAL):
            raise OSError(error.errno, error.strerror or str(error), STANDARD_OUTPUT) from error


def drop(stream: TextIO | None) -> None:
    """Lead a stream that takes no more to nowhere, so that what it still holds is no error at exit."""
    with suppress(OSError, ValueError, AttributeError):  # closed, or none of the operating system's
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # type: ignore[union-attr]


def sentence_of(error: OSError | NestedCagesError, path: str) -> str:
    """The message of an error; that of the operating system with its file."""
    if not isinstance(error, OSError):
        return str(error)
    name = error.filename if error.filename is not None else path
    return f"{name}: {error.strerror or error or type(error).__name__}"


class ProgressLine:
    """A progress bar with the time left on a terminal, one line per stage elsewhere."""

    def __init__(self, stream: TextIO | None, *, silent: bool, files: int = 1) -> None:
        self.stream = None if silent or stream is None or stream.closed else stream
        self.moving = self.stream is not None and self.stream.isatty()
        self.files, self.file = files, 0
        self.began = perf_counter()
        self.last = ""
        self.seen: set[tuple[int, str]] = set()

    def show(self, progress: Any) -> None:
        """Show the progress of a run or a batch, of the file with the number `file`."""
        stage = getattr(progress, "stage", "")
        text = progress.message if self.moving or not stage else f"level {progress.level + 1}, {stage}"
        if self.moving:
            done, passed = (self.file + progress.fraction) / self.files, perf_counter() - self.began
            seconds = round(passed * (1.0 - done) / done) if passed >= LEAST_PASSED and done > 0.0 else None
            left = "" if seconds is None else f"{seconds // 60}:{seconds % 60:02} left, "
            where = f"file {self.file + 1} of {self.files}, " if self.files > 1 else ""
            shown = f"[{'#' * round(BAR * done):.<{BAR}}] {100 * done:3.0f} % {left}{where}{text}"
            tell("\r" + shown.ljust(len(self.last)), self.stream, end="")
            self.last = shown
        elif (self.file, text) not in self.seen:
            tell(f"{100 * progress.fraction:3.0f} % {text}", self.stream)
            self.seen.add((self.file, text))

    def end(self) -> None:
        """End the line of the bar."""
        if self.last:
            tell("", self.stream)
        self.last = ""
