"""What becomes of a call: a result or one sentence, in bounded time and memory; anything else is a fault."""

from __future__ import annotations

import os
import signal
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nestedcages_core import NestedCagesError

SECONDS = 20.0
"""Processor time that a call may take."""

MEGABYTES = 700
"""Memory that a call may ask for beyond what the process has."""

LONGEST_SENTENCE = 1500
"""Characters of a message: it may quote an input's name, but not the whole input."""


@dataclass(frozen=True)
class Outcome:
    """How a call ended."""

    fault: str
    """What is wrong with that; empty if nothing."""
    told: str = ""
    """The sentence of the error, if there was one."""
    result: Any = None


class TooSlowError(BaseException):
    """Raised where a call has taken too long; no `except Exception` catches it."""


def outcome(call: Callable[[], Any], *, errors: type[Exception] = NestedCagesError) -> Outcome:
    """Run a call within the limits; its errors may be of one kind only."""
    try:
        with limits(), warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            result = call()
    except errors as error:
        told = str(error)
        return Outcome(fault_of_sentence(told), told)
    except TooSlowError:
        return Outcome(f"took more than {SECONDS:g} s")
    except MemoryError:
        return Outcome(f"asked for more than {MEGABYTES} MB")
    except Exception as error:
        return Outcome(f"{type(error).__name__}: {str(error)[:200]}")
    return Outcome("", "", result)


def fault_of_sentence(told: str) -> str:
    """What is wrong with a message: it must be a sentence, or one on each line where several things are wrong."""
    if len(told) > LONGEST_SENTENCE:
        return f"{len(told)} characters: {told[:200]!r}"
    wrong = [line for line in told.splitlines() or [""] if not line.endswith(".") or line[0] != line[0].upper()]
    return f"not a sentence: {wrong[0][:200]!r}" if wrong else ""


@contextmanager
def limits() -> Iterator[None]:
    """Bounds on time and, on Linux, memory; only in the main thread, as signals are."""
    if os.name != "posix":
        begin = time.process_time()
        yield
        if time.process_time() - begin > SECONDS:
            raise TooSlowError
        return

    def too_slow(*_: Any) -> None:
        raise TooSlowError

    before = signal.signal(signal.SIGPROF, too_slow)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        with memory_limit():
            yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def memory_limit() -> Iterator[None]:
    """No more address space than the process has now, and so many megabytes."""
    statistics = Path("/proc/self/statm")
    if not statistics.exists():
        yield
        return
    import resource

    pages = int(statistics.read_text(encoding="ascii").split()[0])
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = pages * os.sysconf("SC_PAGE_SIZE") + MEGABYTES * 2**20
    resource.setrlimit(resource.RLIMIT_AS, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
