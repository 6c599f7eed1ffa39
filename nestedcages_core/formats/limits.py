"""Limits of what a reader takes, against hostile or broken files."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from ..errors import NestedCagesError, invalid_file

GREATEST = 10**18
"""Greatest value of a limit: no machine has as much."""


@dataclass(frozen=True)
class Limits:
    """Maximum input of a reader; each limit is checked before memory is allocated."""

    bytes: int = 2**27
    """Size of a file."""
    elements: int = 250_000
    """Features of a map, polygons of a collision outline."""
    points: int = 1_000_000
    """Points of all outlines together: a million of them take about 1 GB of memory."""
    seconds: int = 10
    """Time for reading features and uniting outlines, as the numbers of features, of crossings and of boxes that meet
    tell it beforehand."""
    pixels: int = 2**26
    """Pixels of a picture: 256 MB as 8-bit RGBA."""

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not isinstance(value, int | np.integer) or isinstance(value, bool) or not 1 <= value <= GREATEST:
                raise invalid_file(f"Limits: {name} must be a whole number from 1 to {GREATEST}, not {value!r:.60}.")

    def check(self, what: str, found: int) -> None:
        """Raise NestedCagesError if an amount exceeds the limit of a field."""
        allowed = getattr(self, what)
        if found > allowed:
            raise _beyond(what, f"{found:,} {what}, more than the {allowed:,} allowed")


class LimitError(NestedCagesError):
    """More than a limit allows."""


def _beyond(what: str, has: str) -> LimitError:
    """The error for an input that has more than the limit of a field."""
    problem = f"The input has {has}; raise the limit for {what}, or make the input smaller."
    return LimitError(problem, code="limit.exceeded", what=what)


class Quota:
    """What a document has used of its limits, counted as it is read."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.used: dict[str, float] = defaultdict(float)

    def spend(self, what: str, amount: float) -> None:
        """Add to what a field counts. Raises NestedCagesError beyond the limit."""
        self.used[what] += amount
        allowed = getattr(self.limits, what)
        if self.used[what] > allowed:
            has = f"more than the {allowed:,} {what} allowed"
            late = f"more features, or outlines over each other, than can be read in the {allowed:,} seconds allowed"
            raise _beyond(what, late if what == "seconds" else has)
