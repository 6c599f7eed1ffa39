"""Notes that are found when they are read: programs that read none do not wait for them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import Any, overload

from ..errors import Fault


class NotesWhenRead(Sequence[Fault]):
    """Notes, the last of which are found when any is first read; equal to the tuple of them."""

    def __init__(self, told: Iterable[Fault], find: Callable[[], tuple[Fault, ...]]) -> None:
        self._told, self._find = tuple(told), find

    @cached_property
    def _all(self) -> tuple[Fault, ...]:
        return self._told + self._find()

    def __len__(self) -> int:
        return len(self._all)

    @overload
    def __getitem__(self, index: int) -> Fault: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Fault, ...]: ...
    def __getitem__(self, index: int | slice) -> Fault | tuple[Fault, ...]:
        return self._all[index]

    def __eq__(self, other: object) -> bool:
        return self._all == (other._all if isinstance(other, NotesWhenRead) else other)

    def __hash__(self) -> int:
        return hash(self._all)

    def __repr__(self) -> str:
        return repr(self._all)

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy is the tuple."""
        return tuple, (self._all,)
