"""Levels as they are asked for: counts, shares of the vertices of a mesh, the user's own meshes, tolerances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeGuard, TypeVar

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..errors import Fault, note
from ..geometry.mesh import Mesh, MeshLike
from ..tolerance.within import Within

LEAST_OF_A_SHARE = 4
"""Minimum number of vertices per loop for a percentage where all loops are kept, if the loop has them: a triangle
around a rectangle is twice as large."""


@dataclass(frozen=True)
class Share:
    """A level with a fraction of the mesh's own number of vertices, or the least that the shape can have."""

    fraction: float
    """Above 0, and at most 1."""

    def of(self, sizes: Sequence[int], *, keeps: bool = True) -> int:
        """The number of vertices for loops of these sizes: enough for each, or for one where not all are kept."""
        least = sum(min(size, LEAST_OF_A_SHARE) for size in sizes) if keeps else MIN_PER_LOOP
        return max(round(sum(sizes) * self.fraction), least)


class Rising(int):
    """A number of vertices that rises to the least that the shape can have, with a note, instead of being rejected."""

    asked: int
    """The number before it rose."""

    def __new__(cls, count: int, asked: int | None = None) -> Rising:
        self = super().__new__(cls, count)
        self.asked = int(count if asked is None else asked)
        return self

    def raised(self, least: int) -> Rising:
        """At least this many vertices."""
        return Rising(max(self, least), self.asked)

    def notes(self) -> tuple[Fault, ...]:
        """What became of it; empty if it did not rise."""
        rose = note("note.count", asked=self.asked, given=int(self), on="least")
        return () if self == self.asked else (rose,)


Wanted: TypeAlias = int | str | Share | MeshLike | Within
"""A level as asked for."""

Item = TypeVar("Item")


def is_count(level: object) -> TypeGuard[int]:
    """Whether a level is a number of vertices."""
    return isinstance(level, int | np.integer) and not isinstance(level, bool)


def in_order(levels: Sequence[Item], size: int | None = None) -> list[Item]:
    """Levels from the finest to the coarsest; as they are where meshes are among them, or what cannot be compared.

    size: vertices of the mesh, which shares and counts are compared by.
    """

    def fineness(level: Any) -> tuple[str, float]:
        if isinstance(level, Within):
            return ("excess", level.limit) if level.distance is None else ("distance", level.limit)
        if isinstance(level, Share):
            return ("share", -level.fraction) if size is None else ("count", -level.fraction * size)
        return ("count", -float(level)) if is_count(level) else ("other", 0.0)

    kinds = {fineness(level)[0] for level in levels}
    return sorted(levels, key=fineness) if len(kinds) == 1 else list(levels)


def wanted_levels(levels: Sequence[Any], mesh: Mesh, *, keeps: bool = True) -> list[Any]:
    """The levels around a mesh, with shares as numbers of vertices, which rise to what its loops need.

    keeps: whether all loops are kept.
    """
    whole = [len(mesh.vertices)]
    sizes = [len(loop) for loop in mesh.loops] if keeps else whole
    return [
        Rising(level.of(sizes, keeps=keeps), level.of(whole, keeps=keeps)) if isinstance(level, Share) else level
        for level in levels
    ]
