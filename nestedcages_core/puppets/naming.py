"""Names that are given once."""

from __future__ import annotations

from collections.abc import Iterable


class Names:
    """Makes names that differ: one that was given before gets a number, as in Blender."""

    def __init__(self, taken: Iterable[str] = (), separator: str = ".") -> None:
        self._taken, self._separator = set(taken), separator

    def new(self, stem: str, ending: str = "") -> str:
        """The next free name of a stem, with an ending such as .L: tail, tail.001; leg.L, leg.001.L."""
        name, count = stem + ending, 0
        while name in self._taken:
            count += 1
            name = f"{stem}{self._separator}{count:03d}{ending}"
        self._taken.add(name)
        return name
