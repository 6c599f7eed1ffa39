"""Stages of a run are generators: they yield while they work and return their result.

Whoever pumps a stage shows its progress, and stops it by closing it or letting it go.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any, TypeAlias, TypeVar

Yielded = TypeVar("Yielded")
Shown = TypeVar("Shown")
Result = TypeVar("Result")

Stage: TypeAlias = Generator[Yielded, None, Result]


def drain(stage: Stage[Any, Result]) -> Result:
    """Run a stage to its end and return its result."""
    while True:
        try:
            next(stage)
        except StopIteration as end:
            result: Result = end.value
            return result


def mapped(stage: Stage[Yielded, Result], show: Callable[[Yielded], Shown]) -> Stage[Shown, Result]:
    """The same stage with ``show`` applied to what it yields."""
    while True:
        try:
            yielded = next(stage)
        except StopIteration as end:
            result: Result = end.value
            return result
        yield show(yielded)
