"""A clearance of each loop of the fine mesh: a second one for holes, or for some parts."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import NestingError, invalid_setting
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .base import Constraint


@dataclass(frozen=True)
class LoopClearance(Constraint):
    """Distances that cages keep from the loops of a drawing, where these are more than the clearance of the settings.

    Its rows are those of contact.
    """

    outer: float = 0.0
    """From outer loops."""
    holes: float = 0.0
    """From holes."""
    loops: tuple[float, ...] = ()
    """One for each loop of the drawing, in the order of `Mesh.loops`, instead of the others."""
    must: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        lengths = (self.outer, self.holes, *self.loops)
        if not all(isinstance(length, int | float | np.number) and 0.0 <= float(length) < np.inf for length in lengths):
            raise invalid_setting(f"LoopClearance: distances must be finite lengths of at least 0, not {lengths!r}.")
        object.__setattr__(self, "loops", tuple(float(length) for length in self.loops))

    def of(self, about: Mesh, side: int) -> LoopClearance:
        """The distances. Raises NestingError where their number is not that of the loops."""
        self.distances(about)
        return self

    def distances(self, fine: Mesh) -> FloatArray:
        """Those from the loops of a mesh. Raises NestingError where their number is another one."""
        if self.loops and len(self.loops) != len(fine.loops):
            raise NestingError(
                f"LoopClearance has {len(self.loops)} distances, but the mesh has {len(fine.loops)} loops; give one "
                "for each, or one for outer loops and one for holes.",
                code="priorities.mismatch",
                given=len(self.loops),
                available=len(fine.loops),
            )
        return np.array(self.loops) if self.loops else np.where(fine.loop_signs > 0, self.outer, self.holes)
