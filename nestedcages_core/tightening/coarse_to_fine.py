"""Coarse to fine: a cage is tightened around few vertices of a large mesh, then around all of those near it too.

What is left out lies within a distance of the edge that stands for it, by which the cage keeps farther away from that.
Where this decides, vertices near the cage are put back, so that in the end the cage is tight around the mesh itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.broad_phase import near_pairs
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh, Nesting
from ..geometry.precision import MOST_ROUNDS, NEGLIGIBLE
from ..geometry.thinning import stretches, thinned, tolerance_for

MIN_POINTS, POINTS_PER_VERTEX, MANY = 500, 16, 3
"""Vertices that are left first: at least, and per vertex of the cage; how many times as many a thinned mesh has."""

ACTIVE, NEAR = 1.05, 4.0
"""Distance of an edge from the cage, above the clearance and relative to that of what it stands for, up to which it
decides; distance, relative to the largest of these, up to which vertices are put back then."""

MAX_BACK, FINER = 100_000, 1.0 / 16.0
"""Number of vertices from which not all are put back at once; relative to that distance, what those tell that are."""


def coarse_to_fine(
    fine: Mesh, original: Mesh, cage: Mesh, clearance: float, reached: Callable[[], FloatArray]
) -> Iterator[tuple[Mesh, FloatArray | None]]:
    """Meshes to tighten a cage around in turn, and the distances to keep from each of their vertices, where these are
    larger than the clearance. original: the fine mesh in other units; reached: vertices (m, 2) of the cage so far."""
    points = MIN_POINTS + POINTS_PER_VERTEX * len(cage.vertices)
    if len(fine.vertices) > MANY * points:
        significance = original.loop_order.significance * (fine.diagonal / original.diagonal)
        kept, least = significance > tolerance_for(significance, points, fine.diagonal), NEGLIGIBLE * fine.diagonal
        with suppress(InvalidMeshError):
            for _ in range(MOST_ROUNDS):
                thin, stretch = thinned(fine, kept), stretches(fine, kept)
                if Nesting(cage.moved(reached()), thin).contact is not None:
                    break
                missed = np.zeros(len(thin.vertices))
                np.maximum.at(missed, stretch, np.where(kept, 0.0, np.maximum(significance, least)))
                yield thin, clearance + np.maximum(missed, missed[thin.predecessor])
                cage = cage.moved(reached())
                active = near(thin, cage, clearance, ACTIVE * missed)
                if not active.any():
                    return
                largest = float(missed[active].max())
                back = near(thin, cage, clearance, np.where(missed > 0.0, NEAR * largest, 0.0))[stretch]
                if np.count_nonzero(back) > MAX_BACK and largest > least:
                    back &= significance > FINER * missed[stretch]
                kept |= back
    yield fine, None


def near(fine: Mesh, cage: Mesh, clearance: float, beyond: FloatArray) -> BoolArray:
    """(n,) which edges of a mesh, by their first vertices, are closer to a cage than the clearance and a distance (n,)
    beyond it; not those where that is 0."""
    found, reach = np.zeros(len(fine.vertices), bool), np.where(beyond > 0.0, clearance + beyond, 0.0)
    for points, edges in ((fine, cage), (cage, fine)):
        point, edge = near_pairs(points.vertices, edges.vertices, edges.edge_ends, float(reach.max()))
        segments = edges.vertices[edge], edges.edge_ends[edge]
        distance = point_edge(points.vertices[point], *segments).distance
        for own in (edge,) if edges is fine else (point, fine.predecessor[point]):
            found[own[distance < reach[own]]] = True
    return found
