"""On the curve: the mesh of another decimation with its vertices moved onto the fine mesh."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...errors import NestingError
from ...geometry.mesh import Mesh
from ...parameters import check_part
from ...tasks import Stage, drain
from ..base import Count, Decimation, SeveralStarts, Start
from ..line_cycles import LineCycles
from ..on_curve import closest_on_curve
from .arc_length import ArcLength


@dataclass(frozen=True)
class OnCurve:
    """Vertices on the fine mesh, at the places closest to those of a mesh around it: more at features."""

    around: Decimation = field(default_factory=LineCycles)
    """Makes the mesh around it."""

    def __post_init__(self) -> None:
        check_part(self, "around", "decimate", "LineCycles()")

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh whose vertices lie on the fine one, whatever the clearance; loop k on loop k.

        Where its loops would cross, they are resampled by `ArcLength` instead. Raises NestingError as that does.
        """
        return drain(self.starts(fine, count, clearance=clearance))[0].coarse

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Stage[float, list[Start]]:
        """The mesh of `decimate`. A generator: yields the fraction done and returns the list."""
        return [Start((yield from self._coarse(fine, count, clearance)), "on curve")]

    def _coarse(self, fine: Mesh, count: Count, clearance: float) -> Stage[float, Mesh]:
        try:
            if isinstance(self.around, SeveralStarts):
                starts = yield from self.around.starts(fine, count, clearance=clearance)
                around = starts[0].coarse
            else:
                around = self.around.decimate(fine, count, clearance=clearance)
        except NestingError as error:
            try:
                return ArcLength().decimate(fine, count, clearance=clearance)
            except NestingError:
                raise error from None
        return closest_on_curve(around, fine) or ArcLength().decimate(fine, count, clearance=clearance)
