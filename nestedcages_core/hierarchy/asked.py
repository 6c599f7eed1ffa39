"""Levels as they are asked for: alone or in a list, as text, in any order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeAlias, TypeVar

import numpy as np

from ..errors import NestingError
from ..geometry.mesh import Mesh, MeshLike
from ..tolerance.within import Within
from .levels import Share

Wanted: TypeAlias = int | str | Share | MeshLike | Within
"""A level as asked for."""

Item = TypeVar("Item")


def listed_levels(levels: Wanted | Sequence[Wanted]) -> list[Any]:
    """The levels as a list, with texts read; a single one needs none. Raises NestedCagesError."""
    single = int, np.integer, Share, Within, Mesh, Mapping, str
    is_loop = isinstance(levels, np.ndarray) and levels.ndim == 2
    if isinstance(levels, single) or hasattr(levels, "__geo_interface__") or is_loop:
        given: Iterable[Any] = [levels]
    elif isinstance(levels, Iterable):
        given = levels
    else:
        raise NestingError(
            f'A level must be a vertex count, a text such as "8%", a Mesh or Within(…), for instance [64, 16], not '
            f"{levels!r}.",
            code="level.invalid",
        )
    return [read for level in given for read in (_read(level) if isinstance(level, str) else [level])]


def _read(text: str) -> list[int | Share | Within]:
    from .level_text import level_words, parse_level

    return [parse_level(word) for word in level_words(text) or [text]]


def in_order(levels: Sequence[Item], size: int | None = None) -> list[Item]:
    """Levels from the finest to the coarsest; as they are where meshes are among them, or what cannot be compared.

    size: vertices of the mesh, which shares and counts are compared by.
    """

    def fineness(level: object) -> tuple[str, float]:
        if isinstance(level, Within):
            return ("excess", level.limit) if level.distance is None else ("distance", level.limit)
        if isinstance(level, Share):
            return ("share", -level.fraction) if size is None else ("count", -level.fraction * size)
        is_count = isinstance(level, int | np.integer) and not isinstance(level, bool)
        return ("count", -float(level)) if is_count else ("other", 0.0)  # type: ignore[arg-type]

    kinds = {fineness(level)[0] for level in levels}
    return sorted(levels, key=fineness) if len(kinds) == 1 else list(levels)
