"""Work reports its progress by calling a function, which may raise to end it; `run.py` makes an iterator of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar

from .errors import NestedCagesError

Result = TypeVar("Result")

Tick: TypeAlias = Callable[[float], None]
"""Called between parts of the work with the fraction done, in [0, 1]; what it raises ends the work."""


def no_tick(fraction: float) -> None:
    """A `Tick` that does nothing."""


def listened(work: Callable[[Callable[[Any], None]], Result], listener: Callable[[Any], None] | bool | None) -> Result:
    """The result of work that reports `Progress` or the like to a listener. True: to a bar of tqdm, or in lines where
    that is not installed.
    """
    if listener is True:
        from .run import with_bar

        return with_bar(work)
    if listener in (None, False):
        return work(lambda shown: None)
    if not callable(listener):
        said = f"progress must be True or a function, not {listener!r}."
        raise NestedCagesError(said, code="setting.invalid", name="progress", value=listener)
    return work(listener)
