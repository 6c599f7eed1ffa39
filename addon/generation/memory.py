"""Results of this session, for reuse when the same is asked for again: redo with other colours computes nothing."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

from ..core import memory

Result = TypeVar("Result")

# Maximum size in bytes of the results kept.
MOST_BYTES = 512 * 2**20


@cache
def known() -> memory.Memory[Any]:
    """What has been computed in this session, by the name of what it is and all that it depends on."""
    return memory.Memory(MOST_BYTES, largest_share=1.0)


def remembered(make: Callable[[], Result], size: int, name: str, *parts: object) -> Result:
    """What `make` returns, computed once for the same parts; size: of it in bytes. Errors are not remembered."""
    found: Result = known().value(memory.key_of(name, *parts), make, size)
    return found
