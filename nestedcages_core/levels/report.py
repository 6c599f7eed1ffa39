"""Results of a run: levels with their steps and reports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

from ..contact.reinflation import Reinflation
from ..errors import Fault
from ..flow import FlowResult
from ..geometry.arrays import FloatArray
from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh
from ..verification import LostLoops
from ..verification.lost_loops import NONE_LOST


@dataclass(frozen=True)
class NestingReport:
    """How a level was made and what was certified."""

    strict: bool
    """Certified: one of fine mesh and cage lies strictly inside the other, as `side` says, component by component."""
    simple: bool
    """Certified: the cage does not touch or cross itself."""
    clearance: float
    """Measured smallest distance between cage and fine mesh; unit: the input's."""
    wanted_clearance: float
    """The clearance that was certified: the one asked for, or the default, which is reduced in narrow gaps."""
    excess: float
    """area(cage) / area(fine) - 1; negative for inner cages."""
    start: str
    """How the fine mesh came to lie inside the coarse one: by "flow", or what the start is called, such as "box"."""
    iterations: Mapping[str, int]
    """Iterations per phase."""
    seconds: Mapping[str, float]
    """Wall-clock seconds per phase."""
    notes: Sequence[Fault] = ()
    """Deviations from the request, such as the use of the fallback: sentences with a code and data."""
    fewest: int | None = None
    """No cage within the distance asked for has fewer vertices; None where none was asked for."""
    grid: float | None = None
    """Certified: all coordinates of the cage are multiples of this length; None where none was asked for."""
    stored: str | None = None
    """Certified: the coordinates of the cage are numbers of this type, such as "float32"; None for doubles."""
    lost: LostLoops = NONE_LOST
    """Holes of the fine mesh that the cage fills, and loops that share one of the cage, by their numbers."""

    def with_count(self, note: Fault) -> NestingReport:
        """The report with a note on the number of vertices instead of that on the grid."""
        return replace(self, notes=(*(other for other in self.notes if other.data.get("on") != "grid"), note))

    def __str__(self) -> str:
        measures = (
            f"strictly nested: {_yes(self.strict)}",
            f"simple: {_yes(self.simple)}",
            f"clearance {self.clearance:.3g} (wanted {self.wanted_clearance:.3g})",
            f"excess {100.0 * self.excess:.2f} %",
            *([f"on a grid of {self.grid:.6g}"] if self.grid is not None else []),
            f"start: {self.start}",
            f"{sum(self.seconds.values()):.2f} s",
        )
        return "\n".join([", ".join(measures), *self.notes])


@dataclass(frozen=True, eq=False, repr=False)
class Level(Drawable):
    """One cage, and flow and reinflation that lead to it."""

    fine: Mesh
    """The mesh that this level's cage encloses, or is inside of: the input, or the cage of the level before."""
    coarse: Mesh
    """The mesh that the cage started from: its first step. Of a cage without steps it is the cage."""
    cage: Mesh
    flow: FlowResult
    reinflation: Reinflation
    report: NestingReport
    side: int = 1
    """1 for a cage around `fine`, -1 for one inside it, as those of `inner_cages`."""

    @property
    def inside(self) -> bool:
        """Whether the cage lies inside `fine`; verify(fine, cage) is then its certificate."""
        return self.side < 0

    @property
    def vertices(self) -> FloatArray:
        """(m, 2) vertices of the cage."""
        return self.cage.vertices

    @property
    def excess(self) -> float:
        """area(cage) / area(fine) - 1; negative for inner cages."""
        return self.report.excess

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """The cage as a Polygon or MultiPolygon: ``shapely.geometry.shape(level)``."""
        return self.cage.__geo_interface__

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """The fine mesh and the cage."""
        return self.fine, self.cage

    def __repr__(self) -> str:
        report = self.report
        return f"Level({_sizes(self)}, clearance {report.clearance:.3g}, start {report.start!r})"


@dataclass(frozen=True, eq=False, repr=False)
class Hierarchy(Drawable, Sequence[Level]):
    """Nested cages: level k encloses level k - 1, and all enclose the fine mesh; inner cages the other way round.

    It is also the sequence of its levels.
    """

    fine: Mesh
    levels: tuple[Level, ...]

    def __len__(self) -> int:
        return len(self.levels)

    @overload
    def __getitem__(self, index: int) -> Level: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Level, ...]: ...
    def __getitem__(self, index: int | slice) -> Level | tuple[Level, ...]:
        return self.levels[index]

    def __iter__(self) -> Iterator[Level]:
        return iter(self.levels)

    def __repr__(self) -> str:
        return f"Hierarchy({len(self.fine.vertices)} vertices; cages: {'; '.join(map(_sizes, self)) or 'none'})"

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """The fine mesh and the cages, from the finest to the coarsest."""
        return self.fine, *self.cages

    @property
    def cages(self) -> tuple[Mesh, ...]:
        """The cages, from the finest to the coarsest."""
        return tuple(level.cage for level in self.levels)


def _sizes(level: Level) -> str:
    return f"{len(level.vertices)} vertices, excess {100.0 * level.excess:.2f} %"


def _yes(truth: bool) -> str:
    return "yes" if truth else "no"
