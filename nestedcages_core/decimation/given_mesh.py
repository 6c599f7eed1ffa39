"""A given start, as a decimation: for what goes on from it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..geometry.mesh import Mesh
from .base import NOTHING_KEPT, Count, Kept, Start, Tick, no_tick


@dataclass(frozen=True, eq=False)
class GivenStart:
    """One start, whatever is asked for."""

    start: Start

    @property
    def on_curve(self) -> bool:
        """Whether it comes with a mesh on the fine one."""
        return self.start.on_curve is not None

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """Its mesh."""
        return self.start.coarse

    def starts(
        self, fine: Mesh, count: Count, *, clearance: float = 0.0, kept: Kept = NOTHING_KEPT, tick: Tick = no_tick
    ) -> Iterator[Start]:
        """It alone."""
        yield self.start
