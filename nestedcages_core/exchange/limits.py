"""Limits that keep a hostile or broken file from taking all time and memory."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import NestedCagesError


@dataclass(frozen=True)
class Limits:
    """Maximum input of a reader; each limit is checked before memory is allocated."""

    bytes: int = 2**27
    """Size of a file: 128 MB of JSON take about 1.5 GB of memory."""
    elements: int = 250_000
    """Features of a map, polygons of a collision outline."""
    points: int = 5_000_000
    """Points of all outlines together."""
    pixels: int = 2**26
    """Pixels of a picture: 256 MB as 8-bit RGBA."""

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < 1:
                raise NestedCagesError(f"Limits: {name} must be a whole number of at least 1, not {value!r}.")

    def check(self, what: str, found: int) -> None:
        """Raise NestedCagesError if an amount exceeds the limit of a field."""
        allowed = getattr(self, what)
        if found > allowed:
            raise NestedCagesError(
                f"The input has {found:,} {what}, more than the {allowed:,} allowed; raise the limit for {what}, or "
                "make the input smaller."
            )
