"""Results of this session, kept for when the same is asked for again: redo with other colours computes nothing."""

from __future__ import annotations

import io
import pickle
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from hashlib import sha256
from typing import Any, TypeVar

from .core import core

Result = TypeVar("Result")

# Maximum size in bytes of the results kept.
MOST_BYTES = 512 * 2**20

_results: OrderedDict[bytes, tuple[Any, int]] = OrderedDict()


def known(key: bytes) -> Any:
    """The result of a key; None if there is none."""
    if key not in _results:
        return None
    _results.move_to_end(key)
    return _results[key][0]


def remember(key: bytes, result: object, size: int) -> None:
    """Keeps a result of this many bytes, if it has room, in place of those that have not been used for longest."""
    if size > MOST_BYTES:
        return
    _results[key] = result, size
    while sum(each for _, each in _results.values()) > MOST_BYTES:
        _results.popitem(last=False)


def remembered(make: Callable[[], Result], size: int, *parts: object) -> Result:
    """What `make` returns, computed once for the same parts; size: of it in bytes. Errors are not remembered."""
    key = key_of(*parts)
    result: Result | None = known(key)
    if result is None:
        result = make()
        remember(key, result, size)
    return result


def key_of(*parts: object) -> bytes:
    """The key of meshes, arrays, numbers, strings, method objects, and tuples of these, by their values."""
    written = io.BytesIO()
    _Values(written, core.Mesh).dump(parts)
    return sha256(written.getvalue()).digest()


class _Values(pickle.Pickler):
    """Writes what things were made of, without what they have computed since."""

    def __init__(self, written: io.BytesIO, mesh: type[core.Mesh]) -> None:
        super().__init__(written)
        self._mesh = mesh

    def reducer_override(self, obj: Any) -> Any:
        if isinstance(obj, self._mesh):
            return tuple, ((obj.vertices, obj.edges, obj.loop_signs),)
        if is_dataclass(obj) and not isinstance(obj, type):
            return type(obj), tuple(getattr(obj, each.name) for each in fields(obj))
        return NotImplemented
