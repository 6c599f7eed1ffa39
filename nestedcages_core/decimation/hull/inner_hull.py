"""Inner hull: a coarse mesh strictly inside the fine one.

It is the outer hull of the complement: the loops are reversed, so the solid on their left is what surrounds the fine
mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.mesh import Mesh, Nesting
from ...tasks import Stage, drain
from ..base import Count, Start
from ..outline import Outline
from ..request import Request
from .outer_hull import OuterHull

SOURCE = "inner hull"
"""Name of its meshes in reports."""


@dataclass(frozen=True, eq=False)
class InnerRequest(Request):
    """A request for a coarse mesh inside the fine one; the loops of the outline are reversed."""

    side = -1

    @classmethod
    def of(cls, fine: Mesh, count: Count) -> InnerRequest:
        """The request for a count as in `Decimation.decimate`. Raises NestingError."""
        request = Request.of(fine, count)
        return cls(fine, _walked_back(request.outline), request.loop_order, request.total, request.per_loop)

    def with_room(self, coarse: Mesh, clearance: float) -> Mesh:
        """The coarse mesh itself: unlike the holes of outer cages, its loops have space."""
        return coarse

    def nests(self, coarse: Mesh) -> bool:
        """Whether each loop of the fine mesh encloses its coarse one; for holes, lies inside it."""
        return Nesting(self.fine, coarse).encloses_loop_by_loop()


@dataclass(frozen=True)
class InnerHull:
    """A mesh strictly inside the fine one."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The hull; see `starts`."""
        return drain(self.starts(fine, count, clearance=clearance, most=1))[0].coarse

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0, most: int = 1) -> Stage[float, list[Start]]:
        """One mesh strictly inside the fine one.

        count and clearance are those of `OuterHull.starts`. Raises NestingError if the count is impossible, with the
        smallest one found.
        """
        return [Start((yield from OuterHull().hull(InnerRequest.of(fine, count), clearance)), SOURCE)]


def _walked_back(outline: Outline) -> Outline:
    """The reversed loops, each with the same first vertex."""
    order = np.concatenate(
        [begin + (-np.arange(size)) % size for begin, size in zip(outline.begins.tolist(), outline.sizes, strict=True)]
    )
    return Outline(outline.vertices[order], outline.sizes)
