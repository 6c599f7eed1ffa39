"""On the curve: the vertices of an outer hull, each put back onto the part of the fine mesh that it stands for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from .._types import FloatArray
from ..distance import point_edge
from ..errors import InvalidMeshError
from ..mesh import Mesh
from .base import Count, checked_budget
from .hull_search import search_hulls
from .outer_hull import OuterHull
from .outline import Outline, padded
from .resample import ArcLength, same_loops
from .unrolled import unroll


@dataclass(frozen=True)
class OnCurve:
    """Vertices on the fine mesh, shared out between and along its loops as the outer hull does: more at features."""

    hull: OuterHull = field(default_factory=OuterHull)
    """The search whose best hull is used."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh whose vertices lie on the fine one, whatever the clearance; loop k on loop k.

        Where its loops would cross, they are resampled by `ArcLength` instead. Raises NestingError as that does.
        """
        budget = checked_budget(fine, count)
        unrolled = unroll(fine)
        outline = unrolled.outline
        wanted = unrolled.wanted(budget)
        minimum = np.minimum(wanted, outline.sizes).tolist()
        total = budget.total if budget.per_loop is None else sum(minimum)
        best = search_hulls(outline, total, minimum, self.hull.restarts, self.hull.seed)[0]
        if len(best.vertices) <= total:
            try:
                return same_loops(unrolled, padded(list(_snapped(best, outline)), wanted), fine)
            except InvalidMeshError:
                pass  # a coarse mesh that crosses itself is of no use to anybody
        return ArcLength().decimate(fine, count, clearance=clearance)


def _snapped(hull: Outline, outline: Outline) -> Iterator[FloatArray]:
    """Loops of a hull (k, 2) with each vertex at the closest point of the stretch of the outline that it stands for.

    Stretches are disjoint and in order, so the points are.
    """
    spans = np.split(hull.spans, hull.begins[1:])
    for loop, fine, span in zip(hull.loops, outline.loops, spans, strict=True):
        places = []
        for vertex, (first, last) in zip(loop, span.tolist(), strict=True):
            stretch = fine[np.arange(first, last + 1 + (len(fine) if last < first else 0)) % len(fine)]
            if len(stretch) == 1:
                places.append(stretch[0])
                continue
            near = point_edge(vertex, stretch[:-1], stretch[1:])
            k = int(np.argmin(near.distance))
            places.append(stretch[k] + near.parameter[k] * (stretch[k + 1] - stretch[k]))
        yield np.array(places)
