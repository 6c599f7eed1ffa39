"""On the curve: the vertices of an outer hull, each put back onto the part of the fine mesh that it stands for."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import InvalidMeshError, NestingError
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from .arc_length import ArcLength
from .base import Count
from .hull_search import search_hulls
from .outer_hull import OuterHull
from .outline import Outline
from .request import Request


@dataclass(frozen=True)
class OnCurve:
    """Vertices on the fine mesh, shared out between and along its loops as the outer hull does: more at features."""

    hull: OuterHull = field(default_factory=OuterHull)
    """The search whose best hull is used."""

    def __post_init__(self) -> None:
        if not isinstance(self.hull, OuterHull):
            raise NestingError(f"OnCurve: hull must be an OuterHull, not {self.hull!r}.")

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh whose vertices lie on the fine one, whatever the clearance; loop k on loop k.

        Where its loops would cross, they are resampled by `ArcLength` instead. Raises NestingError as that does.
        """
        request = Request.of(fine, count)
        outline = request.outline
        hull = search_hulls(outline, request.target, request.minimum, restarts=self.hull.restarts, seed=self.hull.seed)[
            0
        ]
        if len(hull.vertices) <= request.target:
            try:
                return request.same_roles(request.coarse(_snapped(hull, outline)))
            except InvalidMeshError:
                pass  # self-intersecting: fall back to arc length
        return ArcLength().decimate(fine, count, clearance=clearance)


def _snapped(hull: Outline, outline: Outline) -> Outline:
    """A hull with each vertex at the closest point of the stretch of the outline that it stands for.

    Stretches are disjoint and in order, so the points are.
    """
    places = np.empty_like(hull.vertices)
    of_loop = np.repeat(np.arange(len(hull.sizes)), hull.sizes)
    loops = outline.loops
    for vertex, ((first, last), k) in enumerate(zip(hull.spans.tolist(), of_loop.tolist(), strict=True)):
        fine = loops[k]
        stretch = fine[np.arange(first, last + 1 if first <= last else last + 1 + len(fine)) % len(fine)]
        starts, ends = stretch[: max(1, len(stretch) - 1)], stretch[min(1, len(stretch) - 1) :]
        near = point_edge(hull.vertices[vertex], starts, ends)
        closest = int(np.argmin(near.distance))
        places[vertex] = starts[closest] + near.parameter[closest] * (ends[closest] - starts[closest])
    return hull.moved(places)
