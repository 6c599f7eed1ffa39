"""The number of vertices that a cage can have, next to the one asked for."""

from __future__ import annotations

from ..decimation.base import clamped
from ..geometry.mesh import Mesh
from ..geometry.symmetry import Symmetry
from .priorities import Priorities
from .symmetric import possible_count


def possible(
    wanted: int, outline: Mesh, symmetry: Symmetry | None, priorities: Priorities | None
) -> tuple[int, tuple[str, ...]]:
    """A number that the outline, the shortest edge and the symmetry allow; and a note for each replacement."""
    count, notes = clamped(wanted, outline)
    if priorities is not None:
        count, replaced = priorities.possible_count(count, outline)
        notes += replaced
    if symmetry is not None:
        count, replaced = possible_count(count, outline, symmetry)
        notes += replaced
    return count, notes
