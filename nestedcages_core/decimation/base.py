"""The interface of all decimations."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeAlias, runtime_checkable

from ..errors import Fault
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from ..tasks import Stage

if TYPE_CHECKING:
    from .importance import Importance
    from .line_cycles.rules import LineRule

Count: TypeAlias = int | Sequence[int]
"""Vertices of a level: a total, or one number per loop in the order of `fine.loops`."""

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
    """What it is, such as "outer hull"."""
    on_curve: Mesh | None = None
    """The mesh with its vertices on the fine mesh, where that is preferred; the flow leads from it to a cage."""


class Outline(NamedTuple):
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
class SeveralStarts(Protocol):
    """A decimation that offers several coarse meshes to start from, and whose search can be cancelled."""

    def starts(self, fine: Mesh, count: Count, *, clearance: float) -> Stage[float, list[Start]]:
        """Different coarse meshes, the most promising first; otherwise like `Decimation.decimate`.

        A generator: yields the fraction done and returns the list.
        """


@runtime_checkable
class KeepingStarts(Protocol):
    """A decimation whose coarse meshes can keep something."""

    def starts_keeping(self, fine: Mesh, count: Count, kept: Kept, *, clearance: float) -> Stage[float, list[Start]]:
        """As `SeveralStarts.starts`."""


def in_words(decimation: Decimation) -> str:
    """The name of a decimation in words: "outer hull" for ``OuterHull()``."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(decimation).__name__).lower()
