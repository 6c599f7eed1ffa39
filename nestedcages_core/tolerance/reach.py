"""The largest distance of a cage's solid from the solid of the fine mesh: an upper bound, not a sample.

The cage, or what it has outside of the fine mesh, is triangulated, and triangles in the solid of the fine mesh are left
out. The distance to one segment of the fine mesh is convex, so on a triangle it is largest at
a corner, and the least such value over some segments bounds the distance to the whole mesh on all of the triangle; so
does the mean of the distances to two segments. Triangles whose bound is above the largest distance found are halved.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import nearest as nearest_places
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_HALVINGS
from ..geometry.predicates import winding_number
from ..geometry.triangulation import triangulate
from ..geometry.vectors import norm

REACH_PRECISION = 1e-4
"""Relative width of the interval that contains the reach; its upper end is returned."""

LONG_EDGES = 2.0
"""Mean edge of the fine mesh, in limits, from which triangles that leave out its solid are fewer."""

APART = 4.0
"""Distance between places that are farther than the limit, in limits."""


def reach(cage: Mesh, fine: Mesh, slack: float = 0.0, limit: float = np.inf) -> float:
    """Upper bound on the distance of a point of the cage's solid from the fine mesh's solid.

    It is too large by at most 0.01 % and the slack, and at most the limit if the distance is; if not, any number above
    the limit. The cage must strictly enclose the fine mesh. A bay that the cage fills counts with its widest place.
    """
    return _reach(cage, fine, limit, slack)[0]


def stays_within(cage: Mesh, fine: Mesh, distance: float) -> bool:
    """Whether the reach of a cage, bounded from above, is at most a distance."""
    return len(_reach(cage, fine, distance)[1]) == 0


def beyond(cage: Mesh, fine: Mesh, limit: float, slack: float) -> tuple[float, FloatArray]:
    """`reach`, and places (P, 2) of the cage, from all parts of it, that are farther than the limit."""
    return _reach(cage, fine, limit, slack, everywhere=True)


def _reach(
    cage: Mesh, fine: Mesh, limit: float, slack: float = np.inf, *, everywhere: bool = False
) -> tuple[float, FloatArray]:
    """`reach`, and places (P, 2) that are farther than the limit; everywhere: not only the first that are found."""
    search = fine.edge_tree
    far = search.closest(cage.vertices).distance
    largest = float(far.max())
    places = cage.vertices[far > limit]
    if len(places) and not everywhere:
        return largest, places
    between = cage
    if float(fine.edge_lengths.sum()) > LONG_EDGES * min(limit, slack + largest) * len(fine.vertices):
        between = Mesh.from_loops([mesh.vertices[loop] for mesh in (cage, fine) for loop in mesh.loops])
    tiles = triangulate(between)
    corners = tiles.vertices[tiles.triangles]
    near = search.closest(corners.reshape(-1, 2)).edge.reshape(-1, 3)
    for _ in range(MOST_HALVINGS):
        corners, near = _longest_first(corners, near)
        middle = 0.5 * (corners[:, 0] + corners[:, 1])
        distance, nearest, _ = search.closest(middle)
        radius = norm(corners[:, 1:] - middle[:, None]).max(axis=1)
        # all of a triangle that is smaller than the distance of its middle is in the solid, or out of it
        apart = np.flatnonzero(distance > radius)
        inside = winding_number(middle[apart], search.starts, search.ends) == 1
        distance[apart[inside]] = -np.inf
        outside = apart[~inside]
        largest = max(largest, float(distance[outside].max(initial=0.0)))
        if largest > limit:
            places = np.concatenate([places, middle[outside[distance[outside] > limit]]])
            if not everywhere:
                return largest, places
        enough = min(limit, slack + (1.0 + REACH_PRECISION) * largest)
        kept = np.flatnonzero(distance + radius > enough)
        edges = np.column_stack((near, nearest))[kept]
        kept = kept[distance_bounds(corners[kept], edges, search.starts, search.ends) > enough]
        if len(places):
            kept = kept[nearest_places(middle[kept], places)[0] > APART * limit]
        if len(kept) == 0:
            return max(enough, largest), places
        corners, near = np.tile(corners[kept], (2, 1, 1)), np.tile(near[kept], (2, 1))
        for part, corner in ((slice(len(kept)), 1), (slice(len(kept), None), 0)):
            corners[part, corner], near[part, corner] = middle[kept], nearest[kept]
    return np.inf, np.concatenate([places, corners.mean(axis=1)])


def _longest_first(corners: FloatArray, near: IntArray) -> tuple[FloatArray, IntArray]:
    """Triangles (T, 3, 2) from their longest side on, and what belongs to their corners (T, 3)."""
    lengths = norm(np.roll(corners, -1, axis=1) - corners)
    rows, turns = np.arange(len(corners))[:, None], (lengths.argmax(axis=1)[:, None] + np.arange(3)) % 3
    return corners[rows, turns], near[rows, turns]


def distance_bounds(corners: FloatArray, edges: IntArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """(T,) upper bounds of the distance of triangles (T, 3, 2) from segments, by some of these for each, (T, K)."""
    a, b = starts[edges][:, :, None], ends[edges][:, :, None]
    distance = point_edge(corners[:, None], a, b).distance
    # half-way between two segments their mean is as small as it gets, and convex too
    one, other = np.triu_indices(edges.shape[1])
    least: FloatArray = (0.5 * (distance[:, one] + distance[:, other])).max(axis=2).min(axis=1)
    return least
