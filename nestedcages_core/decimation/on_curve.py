"""On the curve: a mesh around the fine one with its vertices moved onto that, where flow and reinflation start."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field

from ..errors import NestingError
from ..geometry.mesh import Mesh
from ..parameters import check_part
from .arc_length import ArcLength
from .base import Count, Decimation
from .closest_points import closest_on_curve
from .line_cycles import LineCycles


@dataclass(frozen=True)
class OnCurve:
    """Vertices on the fine mesh, at the places closest to those of a mesh around it: more at features."""

    around: Decimation = field(default_factory=LineCycles)
    """Makes the mesh around it."""

    def __post_init__(self) -> None:
        check_part(self, "around", "decimate", "LineCycles()")

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh whose vertices lie on the fine one, whatever the clearance; loop k on loop k.

        Where there is none, or its loops would cross, `ArcLength` makes it. Raises NestingError as that does.
        """
        coarse = None
        with suppress(NestingError):
            coarse = closest_on_curve(self.around.decimate(fine, count, clearance=clearance), fine)
        return coarse or ArcLength().decimate(fine, count, clearance=clearance)
