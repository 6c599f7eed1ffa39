"""Coarse to fine: a cage is tightened around few vertices of a large mesh, then around all of those near it too.

What is left out lies within a tolerance of the edges that stand for it, from which the cage keeps so much more. Where
this decides, all vertices near it are put back, so that in the end the cage is tight around the mesh itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.broad_phase import near_pairs
from ..geometry.mesh import Mesh, Nesting
from ..geometry.precision import MOST_ROUNDS
from ..geometry.thinning import stretches, thinned, tolerance_for

MIN_POINTS, POINTS_PER_VERTEX, MANY = 500, 16, 3
"""Vertices that are left first: at least, and per vertex of the cage; how many times as many a thinned mesh has."""

ACTIVE, NEAR = 1.05, 4.0
"""Distance from the cage, above the clearance and in tolerances, up to which an edge decides; up to which all vertices
are put back then."""


def coarse_to_fine(
    fine: Mesh, original: Mesh, cage: Mesh, clearance: float, reached: Callable[[], FloatArray]
) -> Iterator[tuple[Mesh, FloatArray | None]]:
    """Meshes to tighten a cage around in turn, and the distances to keep from each of their vertices, where these are
    larger than the clearance. original: the fine mesh in other units; reached: vertices (m, 2) of the cage so far."""
    points = MIN_POINTS + POINTS_PER_VERTEX * len(cage.vertices)
    if len(fine.vertices) > MANY * points:
        significance = original.loop_order.significance * (fine.diagonal / original.diagonal)
        tolerance = tolerance_for(significance, points, fine.diagonal)
        kept = significance > tolerance
        with suppress(InvalidMeshError):
            for _ in range(MOST_ROUNDS):
                thin, stretch = thinned(fine, kept), stretches(fine, kept)
                if Nesting(cage.moved(reached()), thin).contact is not None:
                    break
                coarse = np.bincount(stretch, minlength=len(thin.vertices)) > 1
                yield thin, clearance + np.where(coarse | coarse[thin.predecessor], tolerance, 0.0)
                cage = cage.moved(reached())
                if not (coarse & near(thin, cage, clearance + ACTIVE * tolerance)).any():
                    return
                kept |= near(thin, cage, clearance + NEAR * tolerance)[stretch]
    yield fine, None


def near(fine: Mesh, cage: Mesh, reach: float) -> BoolArray:
    """(n,) which edges of a mesh are closer to a cage than a reach, by their first vertices."""
    found = np.zeros(len(fine.vertices), bool)
    vertex = near_pairs(fine.vertices, cage.vertices, cage.edge_ends, reach)[0]
    found[vertex] = found[fine.predecessor[vertex]] = True
    found[near_pairs(cage.vertices, fine.vertices, fine.edge_ends, reach)[1]] = True
    return found
