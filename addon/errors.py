"""The error that users see, and the type of arrays of coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Fault:
    """The place of a fault: the object's session ID, and world coordinates."""

    identity: int
    places: tuple[tuple[float, ...], ...]

    @classmethod
    def at(cls, identity: int, points: Any) -> Fault:
        """A fault at points (k, 3) of the world."""
        return cls(identity, tuple(map(tuple, points.tolist())))


# The place named by the last message, if there is one, for Show.
last_fault: list[Fault] = []


class UserError(Exception):
    """Invalid input, setting or state. The message names the object and the remedy; operators report it unchanged.

    `fault`: the place of the fault, if there is one.
    """

    def __init__(self, message: str, fault: Fault | None = None) -> None:
        super().__init__(message)
        self.fault = fault


def told(error: Exception) -> str:
    """What an error says, without the number and the path that Python adds to those of files."""
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)


def counted(count: int, noun: str) -> str:
    """A number of things: "1 cage", "3 cages"."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
