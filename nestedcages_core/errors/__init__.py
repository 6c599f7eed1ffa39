"""Errors and notes: a sentence for people (what is wrong, where, what to change), and a code with data for programs."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

UNKNOWN = "unknown"
"""Code of errors that name none, such as those of a user's own methods."""


class Fault(str):
    """A sentence with a code and data.

    Parameters
    ----------
    sentence : str
        What is wrong, where, and what to change.
    code : str
        One of `CODES`.
    **data
        What the sentence refers to; see `CODES`.
    """

    __slots__ = ("code", "data")
    code: str
    data: Mapping[str, Any]

    def __new__(cls, sentence: str, code: str = UNKNOWN, /, **data: Any) -> Fault:
        made = super().__new__(cls, sentence)
        made.code = code
        made.data = {name: _plain(value) for name, value in data.items()}
        return made

    def __getnewargs_ex__(self) -> tuple[tuple[str, str], dict[str, Any]]:
        """What a copy is made of."""
        return (str(self), self.code), dict(self.data)

    def said(self, sentence: str) -> Fault:
        """The same fault in another sentence."""
        return Fault(sentence, self.code, **self.data)


def note(code: str, **data: Any) -> Fault:
    """A note with the sentence of its code."""
    from .notes import sentence  # most runs have none

    return Fault(sentence(code, data), code, **data)


def _plain(value: Any) -> Any:
    """Arrays and lists as tuples, numbers of numpy as plain ones."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return tuple(map(_plain, value)) if isinstance(value, list | tuple) else value


class NestedCagesError(Exception):
    """Base class of all errors of this package.

    Parameters
    ----------
    message : str
        A sentence for people, or a `Fault`.
    partial : Any, optional
        What was finished before the error, such as the levels of a `Hierarchy`.
    code, **data
        For programs; see `CODES`.
    """

    fault: Fault
    """The message, with its code and data."""
    partial: Any

    def __init__(self, message: str, *, partial: Any = None, code: str = UNKNOWN, **data: Any) -> None:
        super().__init__(message)
        self.fault = message if isinstance(message, Fault) and code == UNKNOWN else Fault(message, code, **data)
        self.partial = partial

    @property
    def code(self) -> str:
        """One of `CODES`."""
        return self.fault.code

    @property
    def data(self) -> Mapping[str, Any]:
        """What the message refers to; see `CODES`."""
        return self.fault.data

    def __reduce__(self) -> tuple[Any, ...]:
        """Keep code, data and `partial` when the error is pickled."""
        return functools.partial(type(self), partial=self.partial), (self.fault,)


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


invalid_setting = functools.partial(NestedCagesError, code="setting.invalid")
unreadable = functools.partial(InvalidMeshError, code="mesh.unreadable")
invalid_file = functools.partial(NestedCagesError, code="file.invalid")
no_outline = functools.partial(InvalidMeshError, code="file.invalid")
"""The errors, with a sentence, for a parameter that no method has, for what is no shape, for what is not as a reader or
a writer needs it, and for a file without a valid outline."""
