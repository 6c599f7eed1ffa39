"""Results of this session, for reuse when the same is asked for again or only the timing has changed."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import Generic, TypeVar

import numpy as np

from ..core import core

Value = TypeVar("Value")

# Maximum size in bytes of the results kept; the last one is kept whatever its size.
MOST_BYTES = 256 * 2**20


class Memory(Generic[Value]):
    """Values by key, with a limit of memory; the least recently used are forgotten first."""

    def __init__(self) -> None:
        self._values: OrderedDict[str, tuple[Value, int]] = OrderedDict()

    def get(self, key: str) -> Value | None:
        """The value of a key, if it is known."""
        if key not in self._values:
            return None
        self._values.move_to_end(key)
        return self._values[key][0]

    def put(self, key: str, value: Value, size: int) -> None:
        """Stores a value of a size in bytes."""
        self._values[key] = (value, size)
        while len(self._values) > 1 and sum(held for _, held in self._values.values()) > MOST_BYTES:
            self._values.popitem(last=False)

    def clear(self) -> None:
        """Forgets everything."""
        self._values.clear()


def key_of(
    fine: core.Mesh, level: int | core.Mesh | core.Within, clearances: Sequence[float], choices: Mapping[str, object]
) -> str:
    """Everything that a level around a mesh depends on, exactly."""
    chosen = [(name, sorted(value) if isinstance(value, frozenset) else value) for name, value in choices.items()]
    found = hashlib.sha256(repr((tuple(clearances), chosen)).encode())
    for part in (fine, level):
        if isinstance(part, core.Mesh):
            found.update(np.ascontiguousarray(part.vertices).tobytes())
            found.update(np.ascontiguousarray(part.edges).tobytes())
        else:
            need = (part.distance, part.excess) if isinstance(part, core.Within) else part
            found.update(f" {need!r} ".encode())
    return found.hexdigest()
