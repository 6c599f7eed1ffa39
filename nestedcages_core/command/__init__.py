"""The shell command: certified cages around drawings, maps and pictures."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module

from ..errors import NestedCagesError
from .printing import STANDARD_OUTPUT, drop, sentence_of, tell

DONE, FAILED, INTERRUPTED = 0, 1, 130
"""Exit statuses; the last is that of a program ended by Ctrl-C. Wrong use ends with 2, by argparse."""

OPTIONS = {"cages": ".options", "check": ".check", "puppet": ".puppet_options"}
"""Modules with the options of each command."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; the exit status. Ctrl-C and errors of the operating system end in a sentence."""
    interrupts, process = list[int](), os.getpid()

    def interrupt(number: int, frame: object) -> None:
        if os.getpid() != process:  # a worker that has just begun
            os._exit(INTERRUPTED)
        interrupts.append(number)  # libraries make other errors of a KeyboardInterrupt while they are imported
        raise KeyboardInterrupt

    with suppress(ValueError):  # in another thread than the first
        signal.signal(signal.SIGINT, interrupt)
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError, OSError):  # a replaced stream, without an encoding
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    try:
        status = _run(sys.argv[1:] if arguments is None else list(arguments))
        if not interrupts:
            tell("", sys.stdout, end="")
            return status
        raise KeyboardInterrupt  # one that was lost on its way here
    except BaseException as error:
        if interrupts or isinstance(error, KeyboardInterrupt):
            problem, status = "interrupted", INTERRUPTED
        elif isinstance(error, MemoryError):
            problem, status = "error: there is not enough memory for this input; make it smaller", FAILED
        elif isinstance(error, OSError | NestedCagesError):
            problem, status = f"error: {sentence_of(error, STANDARD_OUTPUT)}", FAILED
        else:
            raise
    finally:
        with suppress(ValueError):
            signal.signal(signal.SIGINT, signal.default_int_handler)
    drop(sys.stdout)
    with suppress(OSError):
        tell(problem, sys.stderr)
    return status


def _run(words: list[str]) -> int:
    """Run the command that the first word names. What it needs is imported when its words have been read."""
    name = words.pop(0) if words[:1] in (["check"], ["puppet"]) else "cages"
    try:
        options = import_module(OPTIONS[name], __name__).parser()
        try:
            given = options.parse_args(words)
        except NestedCagesError as error:
            options.error(str(error))
        return FAILED if import_module(f".{name}", __name__).run(options, given) else DONE
    except SystemExit as end:  # of argparse, which has printed its message
        return int(end.code or 0)
