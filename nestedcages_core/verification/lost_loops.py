"""Loops of a fine mesh that have none of their own in the cage around it: filled holes, and parts that share a loop."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Set
from typing import NamedTuple

import numpy as np

from ..geometry.mesh import Mesh, Nesting


class LostLoops(NamedTuple):
    """By their numbers in the fine mesh."""

    filled: tuple[int, ...] = ()
    """Holes that the cage's solid covers; what lies in them is not named."""
    joined: tuple[tuple[int, ...], ...] = ()
    """Groups of loops that share one of the cage: outer loops in one outer loop, or a hole and the outer loops in it
    that lie next to the cage's hole there."""

    def __str__(self) -> str:
        filled, shared = len(self.filled), sum(map(len, self.joined))
        said = [f"{filled} hole{'s are' if filled > 1 else ' is'} filled"] if filled else []
        if self.joined:
            said.append(f"{shared} parts share {'a loop' if len(self.joined) == 1 else f'{len(self.joined)} loops'}")
        return " and ".join(said)

    @property
    def note(self) -> dict[str, object]:
        """Data of a note."""
        said = str(self)
        return {"filled": self.filled, "joined": self.joined, "lost": f": {said}" if said else ""}

    @classmethod
    def of(cls, cage: Mesh, fine: Mesh, nesting: Nesting | None = None) -> LostLoops:
        """Those of a cage that strictly encloses a fine mesh."""
        kept, parent = len(cage.loops), (nesting or Nesting(cage, fine)).parents
        of_cage, of_fine = parent[:kept], parent[kept:]
        holes = np.flatnonzero(fine.loop_signs < 0)
        owners = of_cage[cage.loop_signs < 0] - kept
        filled = set(np.setdiff1d(holes, owners).tolist())
        filled -= {hole for hole in filled if _is_in(fine, hole, filled)}
        groups: dict[int, list[int]] = defaultdict(list)
        for loop in np.flatnonzero(fine.loop_signs > 0).tolist():
            around = int(of_fine[loop])
            if not _is_in(fine, loop, filled):
                groups[around].append(loop)
        for around, loops in groups.items():
            if around >= kept:
                loops.insert(0, around - kept)
        return cls(tuple(sorted(filled)), tuple(tuple(loops) for loops in groups.values() if len(loops) > 1))


def _is_in(fine: Mesh, loop: int, holes: Set[int]) -> bool:
    """Whether a loop lies in one of some holes, and is covered where that is filled."""
    while (loop := int(fine.parent_of_loop[loop])) >= 0:
        if loop in holes:
            return True
    return False


NONE_LOST = LostLoops()
