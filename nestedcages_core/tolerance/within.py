"""Levels by a tolerance instead of a vertex count: the fewest vertices found within a distance or an excess."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite

import numpy as np

from ..errors import Fault, NestedCagesError, note
from ..geometry.mesh import Mesh, outer_and_inner


@dataclass(frozen=True)
class Within:
    """A level of the fewest vertices found whose cage stays within a distance, or an excess, of the fine mesh."""

    distance: float | None = None
    """No point of the cage's solid is farther than this from the solid of the fine mesh; unit: the input's."""
    excess: float | None = None
    """area(cage) / area(fine) - 1 is at most this; 0.25 is a quarter."""

    def __post_init__(self) -> None:
        given = [value for value in (self.distance, self.excess) if value is not None]
        if len(given) != 1:
            raise NestedCagesError(
                "Within needs either a distance or an excess, for instance Within(distance=2.0).",
                code="setting.invalid",
            )
        value = given[0]
        if isinstance(value, bool) or not isinstance(value, int | float | np.number):
            raise NestedCagesError(f"Within: a number above 0 is needed, not {value!r}.", code="setting.invalid")
        if not (isfinite(float(value)) and value > 0.0):
            raise NestedCagesError(f"Within: a finite number above 0 is needed, not {value!r}.", code="setting.invalid")

    @property
    def limit(self) -> float:
        """The largest distance or excess."""
        return float(self.distance if self.distance is not None else self.excess or 0.0)

    def measured(self, cage: Mesh, fine: Mesh, side: int = 1, slack: float = 0.0, limit: float = inf) -> float:
        """The excess of a cage on a side, or an upper bound on its distance; slack, limit: as in `reach`."""
        if self.distance is None:
            return side * (cage.area / fine.area - 1.0)
        from .reach import reach  # imports triangulations, which few need

        return reach(*outer_and_inner(cage, fine, side), slack, limit)

    def note(self, count: int, taken: float, fewest: int | None = None) -> Fault:
        """What a cage of that many vertices takes of the limit; fewest: a lower bound on their number."""
        on = "excess" if self.distance is None else "distance" if fewest is None else "bounded"
        return note("note.tolerance", on=on, limit=self.limit, taken=float(taken), count=count, fewest=fewest)

    def is_met(self, cage: Mesh, fine: Mesh, side: int = 1) -> bool:
        """Whether a cage on a side stays within the limit."""
        if self.distance is None:
            return self.measured(cage, fine, side) <= self.limit
        from .reach import stays_within

        return stays_within(*outer_and_inner(cage, fine, side), self.limit)

    def __str__(self) -> str:
        if self.distance is not None:
            return f"within a distance of {self.limit:.6g}"
        return f"within an excess of {100.0 * self.limit:.6g} %"
