"""Checks of the parameters of method objects, called from their ``__post_init__``."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from .errors import NestedCagesError


def check_positive(method: object, *names: str) -> None:
    """NestedCagesError unless the named parameters are finite numbers above 0."""
    _check(method, names, lambda value: 0.0 < value < math.inf, "must be positive and finite")


def check_not_negative(method: object, *names: str) -> None:
    """NestedCagesError unless the named parameters are finite numbers of at least 0."""
    _check(method, names, lambda value: 0.0 <= value < math.inf, "must be finite and at least 0")


def check_fraction(method: object, *names: str) -> None:
    """NestedCagesError unless the named parameters are numbers above 0 and at most 1."""
    _check(method, names, lambda value: 0.0 < value <= 1.0, "must be above 0 and at most 1")


def check_reduction(method: object, *names: str) -> None:
    """NestedCagesError unless the named parameters are numbers above 0 and below 1."""
    _check(method, names, lambda value: 0.0 < value < 1.0, "must be above 0 and below 1")


def check_flag(method: object, *names: str) -> None:
    """NestedCagesError unless the named parameters are True or False."""
    for name in names:
        if not isinstance(getattr(method, name), bool | np.bool_):
            raise _error(method, name, "must be True or False", getattr(method, name))


def check_count(method: object, *names: str, least: int = 1) -> None:
    """NestedCagesError unless the named parameters are whole numbers of at least ``least``."""
    for name in names:
        value = getattr(method, name)
        if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < least:
            raise _error(method, name, f"must be a whole number of at least {least}", value)


def check_side(method: object) -> None:
    """NestedCagesError unless ``side`` is 1 or -1."""
    side = getattr(method, "side", None)
    if side not in (1, -1):
        raise _error(method, "side", "must be 1 or -1", side)


def check_part(method: object, name: str, needed: str, example: str) -> None:
    """NestedCagesError unless the named parameter is an object, not a class, with an attribute ``needed``."""
    value = getattr(method, name)
    if isinstance(value, type) or not hasattr(value, needed):
        raise _error(method, name, f"must be an object such as {example}", value)


def has_method(value: object, name: str) -> bool:
    """Whether a value is an object, not a class, with a method of that name."""
    return not isinstance(value, type) and callable(getattr(value, name, None))


def _check(method: object, names: tuple[str, ...], valid: Callable[[float], bool], rule: str) -> None:
    for name in names:
        value = getattr(method, name)
        if not isinstance(value, int | float | np.number) or isinstance(value, bool) or not valid(float(value)):
            raise _error(method, name, rule, value)


def _error(method: object, name: str, rule: str, value: object) -> NestedCagesError:
    return NestedCagesError(
        f"{type(method).__name__}: {name} {rule}, not {value!r}.", code="setting.invalid", name=name, value=value
    )
