"""Results of this session, kept for reuse when the same is asked for again: redo with other colours computes nothing.

No result depends on that.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import fields, is_dataclass
from hashlib import sha256
from threading import Lock
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from .core import core

Result = TypeVar("Result")

Key: TypeAlias = Hashable
"""Everything that a result depends on; None: it depends on something that can change, so it is not remembered."""

# Maximum size in bytes of the results kept.
MOST_BYTES = 512 * 2**20


class Memory:
    """Results by key; where they take too much memory, those that have not been used for longest are forgotten."""

    def __init__(self, capacity: int) -> None:
        """capacity: of all results, in bytes."""
        self.capacity = capacity
        self._results: OrderedDict[Key, tuple[Any, int]] = OrderedDict()
        self._size = 0
        self._lock = Lock()

    def get(self, key: Key) -> Any:
        """The result of a key; None if it is not known."""
        with self._lock:
            if key is None or key not in self._results:
                return None
            self._results.move_to_end(key)
            return self._results[key][0]

    def put(self, key: Key, result: object, size: int) -> None:
        """Remember a result of this many bytes, if it has room."""
        if key is None or size > self.capacity:
            return
        with self._lock:
            self._size += size - self._results.pop(key, (None, 0))[1]
            self._results[key] = result, size
            while self._size > self.capacity:
                self._size -= self._results.popitem(last=False)[1][1]


known = Memory(MOST_BYTES)
"""What has been computed in this session, by the name of what it is and all that it depends on."""


def remembered(make: Callable[[], Result], size: int, name: str, *parts: object) -> Result:
    """What `make` returns, computed once for the same parts; size: of it in bytes. Errors are not remembered."""
    key = key_of(name, *parts)
    result: Result | None = known.get(key)
    if result is None:
        result = make()
        known.put(key, result, size)
    return result


PLAIN, GROUPS = (type(None), bool, int, float, str, bytes), (tuple, frozenset)
"""Types whose values are told apart by themselves, and by their members."""


def key_of(*parts: object) -> Key:
    """The key of meshes, arrays, numbers, strings, method objects, and tuples of these.

    Method objects are told apart by value if they are frozen dataclasses of such parts, as those of the core are.
    None if there is anything else: it could change without notice.
    """
    listed: list[Any] = []
    for part in parts:
        listed += (part.vertices, part.edges, part.loop_signs) if isinstance(part, core.Mesh) else (part,)
    if not all(isinstance(part, np.ndarray) or _is_value(part) for part in listed):
        return None
    digests = tuple(_digest(part) if isinstance(part, np.ndarray) else part for part in listed)
    return repr(digests), digests  # repr tells 0 from 0.0, -0.0 and False; the objects tell classes of one name apart


def _digest(array: NDArray[Any]) -> tuple[str, tuple[int, ...], bytes]:
    return array.dtype.str, array.shape, sha256(array.tobytes()).digest()


def _is_value(part: object) -> bool:
    """Whether something is equal to another one, and hashed like it, if and only if they always behave the same."""
    if isinstance(part, PLAIN):
        return True
    if isinstance(part, GROUPS):
        return all(map(_is_value, part))
    parameters: Any = vars(type(part)).get("__dataclass_params__")  # not those of a base class
    if parameters is None or not is_dataclass(part):
        return False
    by_value = parameters.frozen and parameters.eq and all(field.compare for field in fields(part))
    return by_value and all(_is_value(getattr(part, field.name)) for field in fields(part))
