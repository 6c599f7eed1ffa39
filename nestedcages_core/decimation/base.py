"""The interface of all decimations, and what they are told."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeAlias, runtime_checkable

from ..errors import Fault
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from ..progress import Tick, no_tick

if TYPE_CHECKING:
    from ..geometry.arrays import FloatArray, IntArray
    from .importance import Importance
    from .outline import Lines, Outline
    from .sampling import NormalFrame

Count: TypeAlias = int | Sequence[int]
"""Vertices of a level: a total, or one number per loop in the order of `fine.loops`."""

MIN_PER_LOOP = 3
"""Vertices of the smallest polygon."""

REACH = 1.5
"""How far new vertices may run away, in diameters: from the centre, or along an edge from its contact. Tightening needs
no limit, since edges of least area touch what is inside at their middle or on either side of it."""


class Decimation(Protocol):
    """A way to make a coarse mesh with a wanted number of vertices."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh of the fine one whose loop k stands for loop k of the fine mesh.

        count: the total number of vertices, distributed over the loops, or one number per loop.
        clearance: the distance to the fine mesh that the cage must keep, in input units.

        Raises NestingError.
        """


class Start(NamedTuple):
    """A coarse mesh to start a level from."""

    coarse: Mesh
    source: str
    """What it is, such as "line cycles"."""
    on_curve: Mesh | None = None
    """The mesh with its vertices on the fine mesh, where that is preferred; the flow leads from it to a cage."""
    rivals: tuple[Start, ...] = ()
    """Starts that are about as good, around other outlines: the cage may be tighter from one of these."""


class LevelTarget(NamedTuple):
    """What cages are made around, or inside."""

    mesh: Mesh
    """What is decimated: the fine mesh, or it and its images."""
    fine: Mesh
    """What cages are solved around: the fine mesh, or hulls that stand for it."""
    inner: Mesh | None = None
    """The mesh that levels are about where hulls stand for it, resting in them; None: the fine one."""
    per_loop: bool = False
    """Whether a number of vertices is that of each loop, not of all together."""
    notes: tuple[Fault, ...] = ()
    """What differs from the fine mesh."""


class LineRule(Protocol):
    """A constraint, as the search for lines sees it; see `nestedcages_core.constraints.Constraint`."""

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The least length of an edge, in the input's units, and angle, in degrees."""

    def distances(self, fine: Mesh) -> FloatArray | None:
        """(L,) distance from each loop of a mesh, in the input's units; None: none."""

    def candidates(self, outline: Outline, at: IntArray, lines: Lines, frame: NormalFrame, shift: float) -> Lines:
        """The candidate lines, or others."""

    def reach(self, outline: Outline, lines: Lines, shift: float) -> FloatArray:
        """(2, K) how far these run from their contacts forwards and backwards."""

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """(2, K) how far lines run forwards and backwards, in the units of the frame; negative: not at all."""


@dataclass(frozen=True)
class Kept:
    """What coarse meshes keep, as far as lines along a shape show it."""

    symmetry: Symmetry | None = None
    """Symmetry of the fine mesh that they have too; None: they need not be symmetric."""
    preferred: Symmetry | None = None
    """Symmetry of the fine mesh that they have where that costs little area."""
    importance: Importance | None = None
    """Where vertices matter; None: everywhere alike."""
    rules: tuple[LineRule, ...] = ()
    """Constraints."""

    @property
    def is_free(self) -> bool:
        """Whether nothing is kept."""
        return self.symmetry is None and self.importance is None and not self.rules


NOTHING_KEPT = Kept()
"""Nothing is kept."""


@runtime_checkable
class Starts(Protocol):
    """A decimation that offers several coarse meshes, which can keep something."""

    def starts(
        self, fine: Mesh, count: Count, *, clearance: float, kept: Kept = NOTHING_KEPT, tick: Tick = no_tick
    ) -> Iterator[Start]:
        """Coarse meshes to start from, the most promising first, each made when it is asked for.

        Otherwise like `Decimation.decimate`; raises NestingError where there is none.
        """
