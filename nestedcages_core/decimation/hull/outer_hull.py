"""Outer hull: a coarse mesh that strictly encloses the fine one from the start, with any number of vertices."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...errors import NestingError
from ...geometry.group import Symmetry
from ...geometry.mesh import Mesh
from ...parameters import check_count
from ...tasks import Stage, drain
from ..base import Count, Start
from ..outline import Outline
from ..request import Request

if TYPE_CHECKING:
    from .importance import Importance

SOURCE = "outer hull"
"""Name of its meshes in reports."""


@dataclass(frozen=True)
class OuterHull:
    """Progressive hull of a strict offset of the fine mesh, the best of several seeded runs."""

    restarts: int = 3
    """Number of runs with varied weights, at least 1, each of which ends in five ways; more for several loops, fewer
    for large vertex counts."""
    seed: int = 0
    """Seed of the random weights."""
    symmetry: Symmetry | None = None
    """Symmetry of the fine mesh that the hulls have too; None: the hulls need not be symmetric."""
    importance: Importance | None = None
    """Where vertices matter; None: everywhere alike."""

    def __post_init__(self) -> None:
        check_count(self, "restarts")
        check_count(self, "seed", least=0)

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The hull of least area; see `starts`."""
        return drain(self.starts(fine, count, clearance=clearance, most=1))[0].coarse

    def candidates(self, fine: Mesh, count: Count, *, clearance: float = 0.0, keep: int = 3) -> list[Mesh]:
        """Up to `keep` hulls, least area first; see `starts`."""
        return [start.coarse for start in drain(self.starts(fine, count, clearance=clearance, most=keep))]

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0, most: int = 3) -> Stage[float, list[Start]]:
        """Up to `most` different meshes that strictly enclose the fine one, by exact predicates, least area first.

        count: total number of vertices, or one per loop of the fine mesh: exactly these, even if it has fewer itself,
        unless the loops then block each other: their sum is redistributed.
        clearance: distance to keep from the fine mesh where there is space, in input units. Loop k of each mesh belongs
        to loop k of the fine mesh.

        Raises NestingError if the count is impossible, with the smallest one found, or if doubles are too coarse.
        """
        hulls = yield from self.hulls(Request.of(fine, count), clearance, most)
        return [Start(mesh, SOURCE) for mesh, _ in hulls]

    def hulls(self, request: Request, clearance: float, most: int) -> Stage[float, list[tuple[Mesh, Outline]]]:
        """The meshes of `starts`, each with the hull of the request's outline that it is made of.

        See docs/ablation.md: counts shared out again.
        """
        from .outer_search import best_hulls  # imports the greedy search, which a default run may not need

        try:
            return (yield from best_hulls(self, request, clearance, most))
        except NestingError:
            if request.per_loop is None:
                raise
        return (yield from best_hulls(self, replace(request, per_loop=None), clearance, most))
