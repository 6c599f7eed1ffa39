"""Which cases of a family the fast tests leave out."""

from collections.abc import Iterable
from math import inf
from typing import Any

import pytest


def slow_after(fast: int, values: Iterable[Any], *, thorough_after: float = inf) -> list[Any]:
    """Values, or tuples of values: some for all tests, the next for slow ones, the last for thorough ones."""
    return [
        pytest.param(
            *(value if isinstance(value, tuple) else (value,)),
            marks=pytest.mark.thorough if place >= thorough_after else pytest.mark.slow if place >= fast else (),
        )
        for place, value in enumerate(values)
    ]


def slowly(*values: Any) -> list[Any]:
    """Values, or tuples of values, that only slow tests try."""
    return slow_after(0, values)
