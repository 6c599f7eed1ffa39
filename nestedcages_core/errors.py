"""Errors. Each message is one sentence for users: what is wrong, where, and what to change."""

from __future__ import annotations

from typing import Any


class NestedCagesError(Exception):
    """Base class of all errors of this package; `partial` is what was finished before it."""

    partial: Any

    def __init__(self, message: str, *, partial: Any = None) -> None:
        super().__init__(message)
        self.partial = partial

    def __reduce__(self) -> tuple[Any, ...]:
        """Keep `partial` when the error is pickled."""
        return _rebuilt, (type(self), str(self), self.partial)


def _rebuilt(kind: type[NestedCagesError], message: str, partial: Any) -> NestedCagesError:
    return kind(message, partial=partial)


class InvalidMeshError(NestedCagesError):
    """The input is not the boundary of a planar solid; the message names the vertex or loop and its place."""


class FlowError(NestedCagesError):
    """The fine mesh could not be brought strictly inside the coarse one; the message names the loop and the cause."""


class ReinflationError(NestedCagesError):
    """The fine mesh could not return to its place without contact; the message names the place."""


class NestingError(NestedCagesError):
    """The wanted levels cannot be built or certified; the message says which level and what to change."""


class NestedCagesWarning(UserWarning):
    """Something was repaired or left out; the message says what and where."""
