"""What is printed: lines on the standard streams, and progress."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from errno import EINVAL
from time import perf_counter
from typing import TextIO

from ..errors import NestedCagesError

STANDARD_OUTPUT = "standard output"
"""Its name in messages."""

BAR = 24
"""Characters of the progress bar."""


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
    """A bar with the time left on a terminal, elsewhere a line for each tenth."""

    def __init__(self, files: int) -> None:
        self.files, self.file = files, 0
        self._began, self._tenth, self._last = perf_counter(), -1, ""

    def show(self, fraction: float, text: str) -> None:
        """Show how far the file with the number `file` is, and what is being done."""
        done, passed = (self.file + fraction) / self.files, perf_counter() - self._began
        if sys.stderr is not None and not sys.stderr.closed and sys.stderr.isatty():
            seconds = round(passed * (1.0 - done) / max(done, 1e-9))
            left = f"{seconds // 60}:{seconds % 60:02} left, " if passed > 1.0 else ""
            line = f"[{'#' * round(BAR * done):.<{BAR}}] {100 * done:3.0f} % {left}{text}"
            tell("\r" + line.ljust(len(self._last)), sys.stderr, end="")
            self._last = line
        elif int(10.0 * done) > self._tenth:
            self._tenth = int(10.0 * done)
            tell(f"{10 * self._tenth:3} %  {text}", sys.stderr)

    def end(self) -> None:
        """End the line of the bar."""
        if self._last:
            tell("", sys.stderr)
        self._last = ""
