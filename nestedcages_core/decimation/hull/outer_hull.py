"""Outer hull: a coarse mesh that strictly encloses the fine one, for nearly any number of vertices.

It is the start for shapes around which no cycles of lines were found: one greedy run, so it is looser.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ...errors import NestingError
from ...geometry.mesh import Mesh
from ...parameters import check_side
from ...tasks import Stage, drain
from ..base import Count, Start
from ..request import Request

SOURCE, INNER_SOURCE = "outer hull", "inner hull"
"""Names of its meshes in reports."""


def source_of(side: int) -> str:
    """The name of a hull around the fine mesh, or inside it."""
    return SOURCE if side > 0 else INNER_SOURCE


@dataclass(frozen=True)
class OuterHull:
    """Progressive hull of a strict offset of the fine mesh."""

    side: int = 1
    """1 for a mesh around the fine one, -1 for one inside it: the hull of what surrounds it."""

    def __post_init__(self) -> None:
        check_side(self)

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The hull; see `starts`."""
        return drain(self.starts(fine, count, clearance=clearance))[0].coarse

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Stage[float, list[Start]]:
        """One mesh that strictly encloses the fine one, or lies inside it, by exact predicates.

        count: total number of vertices, or one per loop of the fine mesh: exactly these, even if it has fewer itself,
        unless the loops then block each other: their sum is redistributed.
        clearance: distance to keep from the fine mesh where there is space, in input units. Loop k of the mesh belongs
        to loop k of the fine mesh.

        Raises NestingError if the count is impossible, with the smallest one found, or if doubles are too coarse.
        """
        hull = yield from self.hull(Request.of(fine, count, self.side), clearance)
        return [Start(hull, source_of(self.side))]

    def hull(self, request: Request, clearance: float) -> Stage[float, Mesh]:
        """The mesh of `starts`."""
        from .outer_search import greedy_hull  # imports the greedy search, which a default run may not need

        try:
            return (yield from greedy_hull(request, clearance))
        except NestingError:
            if request.per_loop is None:
                raise
        return (yield from greedy_hull(replace(request, per_loop=None), clearance))
