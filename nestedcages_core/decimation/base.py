"""The interface of all decimations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol, TypeAlias, runtime_checkable

from ..geometry.mesh import Mesh
from ..tasks import Stage

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


@runtime_checkable
class SeveralStarts(Protocol):
    """A decimation that offers several coarse meshes to start from, and whose search can be cancelled."""

    def starts(self, fine: Mesh, count: Count, *, clearance: float) -> Stage[float, list[Start]]:
        """Different coarse meshes, the most promising first; otherwise like `Decimation.decimate`.

        A generator: yields the fraction done and returns the list.
        """
