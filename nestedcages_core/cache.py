"""Results are remembered: the same step of a run on the same input takes no time. No result depends on that.

So with another number of vertices, clearance or energy around the same shape, a run repeats only what these change.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import fields, is_dataclass
from hashlib import sha256
from threading import Lock
from typing import Any, Generic, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from .tasks import Result, Stage, Yielded

Value = TypeVar("Value")

Key: TypeAlias = Hashable
"""Everything that a result depends on; None: it depends on something that can change, so it is not remembered."""

LARGEST_SHARE = 0.25
"""Largest share of a memory that a single value may take, unless it says otherwise."""


CAPACITY = 16_000_000
"""Bytes that a memory may take, unless it says otherwise."""


class Memory(Generic[Value]):
    """Values by key; where they take too much memory, those that have not been used for longest are forgotten."""

    def __init__(self, capacity: int = CAPACITY, largest_share: float = LARGEST_SHARE) -> None:
        """capacity: of all values, in bytes. largest_share: of it, for a single value."""
        self.capacity, self.largest = capacity, largest_share * capacity
        self._values: OrderedDict[Key, tuple[Value, int]] = OrderedDict()
        self._size = 0
        self._lock = Lock()
        _memories.append(self)

    def __len__(self) -> int:
        return len(self._values)

    def get(self, key: Key) -> Value | None:
        """The value of a key; None if it is not known."""
        with self._lock:
            if key is None or key not in self._values:
                return None
            self._values.move_to_end(key)
            return self._values[key][0]

    def has_room(self, size: int) -> bool:
        """Whether a value of this many bytes is remembered."""
        return size <= self.largest

    def put(self, key: Key, value: Value, size: int) -> None:
        """Remember a value of this many bytes, if it has room."""
        if key is None or not self.has_room(size):
            return
        with self._lock:
            self._size += size - self._values.pop(key, (value, 0))[1]
            self._values[key] = value, size
            while self._size > self.capacity:
                self._size -= self._values.popitem(last=False)[1][1]

    def stage(self, key: Key, work: Stage[Yielded, Result], size: Callable[[Result], int]) -> Stage[Yielded, Result]:
        """The result of a stage, which runs only if that is not known. size: of the result in bytes."""
        known: Any = self.get(key)
        if known is not None:
            return known  # type: ignore[no-any-return]
        result: Any = yield from work
        self.put(key, result, size(result))
        return result  # type: ignore[no-any-return]

    def value(self, key: Key, make: Callable[[], Value], size: int) -> Value:
        """The value of a key, which is made only if it is not known. size: its bytes."""
        known = self.get(key)
        if known is not None:
            return known
        made = make()
        self.put(key, made, size)
        return made

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._values.clear()
            self._size = 0


_memories: list[Memory[Any]] = []


def forget() -> None:
    """Forget all results: frees their memory, and the next run starts from nothing."""
    for memory in _memories:
        memory.clear()


PLAIN, GROUPS = (type(None), bool, int, float, str, bytes), (tuple, frozenset)
"""Types whose values are told apart by themselves, and by their members."""


def key_of(*parts: object) -> Key:
    """The key of meshes, arrays, numbers, strings, method objects, and tuples of these.

    Method objects are told apart by value if they are frozen dataclasses of such parts, as those of this package are.
    None if there is anything else: it could change without notice.
    """
    listed = [each for part in parts for each in getattr(part, "defining_arrays", (part,))]  # those of a mesh
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
