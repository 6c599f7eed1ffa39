"""The largest distance of a cage's solid from the solid of the fine mesh: an upper bound, not a sample.

The cage is triangulated, or the region between the two if triangles as small as the distance would be more than the
vertices. Triangles in the solid of the fine mesh are left out. The distance to one segment of the fine
mesh is convex, so on a triangle it is largest at a corner, and the least such value over some segments bounds the
distance to the whole mesh on all of the triangle; so does the mean of the distances to two segments. Triangles whose
bound is above the largest distance found are halved.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.signed_distance import SignedDistance
from ..geometry.triangulation import triangulate
from ..geometry.vectors import norm

REACH_PRECISION = 1e-4
"""Relative width of the interval that contains the reach; its upper end is returned."""

RESOLVED = 0.5
"""Size of triangles, in distances, down to which all places that are too far are looked for."""

MAX_TRIANGLE_HALVINGS = 60
"""Cap on the halvings of a triangle: its sides are then shorter by a factor of a billion."""


def reach(cage: Mesh, fine: Mesh, slack: float = 0.0, limit: float = np.inf) -> float:
    """Upper bound on the distance of a point of the cage's solid from the fine mesh's solid.

    It is too large by at most 0.01 % and the slack, and at most the limit if the distance is; if not, any number above
    the limit. The cage must strictly enclose the fine mesh. A bay that the cage fills counts with its widest place.
    """
    return _reach(cage, fine, limit, slack)[0]


def stays_within(cage: Mesh, fine: Mesh, distance: float) -> bool:
    """Whether the reach of a cage, bounded from above, is at most a distance."""
    return len(_reach(cage, fine, distance)[1]) == 0


def beyond(cage: Mesh, fine: Mesh, distance: float) -> FloatArray:
    """(P, 2) places of a cage that are farther than a distance; none if its reach, bounded from above, is not."""
    return _reach(cage, fine, distance, resolved=RESOLVED * distance)[1]


def _reach(
    cage: Mesh, fine: Mesh, limit: float, slack: float = np.inf, resolved: float = 0.0
) -> tuple[float, FloatArray]:
    """The reach, or any number above the limit, and places (P, 2) that are farther than the limit.

    resolved: size of triangles down to which more such places are looked for, if above 0.
    """
    signed = SignedDistance.of(fine)
    search = signed.search
    far = search.closest(cage.vertices).distance
    largest = float(far.max())
    places = cage.vertices[far > limit]
    if len(places) and not resolved:
        return largest, places
    between = cage
    if float(fine.edge_lengths.sum()) > min(limit, slack + largest) * len(fine.vertices):
        between = Mesh.from_loops([mesh.vertices[loop] for mesh in (cage, fine) for loop in mesh.loops])
    tiles = triangulate(between)
    corners, near = tiles.vertices[tiles.triangles], search.closest(tiles.vertices).edge[tiles.triangles]
    for _ in range(MAX_TRIANGLE_HALVINGS):
        corners, near = _longest_first(corners, near)
        middle = 0.5 * (corners[:, 0] + corners[:, 1])
        distance, nearest, _ = search.closest(middle)
        radius = norm(corners[:, 1:] - middle[:, None]).max(axis=1)
        # all of a triangle that is smaller than the distance of its middle is in the solid, or out of it
        apart = np.flatnonzero(distance > radius)
        inside = apart[signed.winding(middle[apart]) == 1]
        distance[inside] = -np.inf
        largest = max(largest, float(distance[apart].max(initial=0.0)))
        if largest > limit:
            too_far = apart[distance[apart] > limit]
            places = np.concatenate((places, middle[too_far]))
            if not resolved:
                return largest, places
            distance[(radius < resolved) & (distance <= limit)] = -np.inf
            distance[too_far] = -np.inf
        enough = min(limit, slack + (1.0 + REACH_PRECISION) * largest)
        kept = np.flatnonzero(distance + radius > enough)
        kept = kept[_bounds(corners[kept], np.column_stack((near, nearest))[kept], fine) > enough]
        if len(kept) == 0:
            return max(enough, largest), places
        corners, near = np.tile(corners[kept], (2, 1, 1)), np.tile(near[kept], (2, 1))
        for part, corner in ((slice(len(kept)), 1), (slice(len(kept), None), 0)):
            corners[part, corner], near[part, corner] = middle[kept], nearest[kept]
    return np.inf, corners.mean(axis=1)


def _bounds(corners: FloatArray, edges: IntArray, fine: Mesh) -> FloatArray:
    """(T,) upper bound of the distance of triangles (T, 3, 2) from the fine mesh, by some of its edges (T, 4)."""
    shape = (len(corners), 4, 3, 2)
    starts = np.broadcast_to(fine.vertices[edges][:, :, None], shape).reshape(-1, 2)
    ends = np.broadcast_to(fine.edge_ends[edges][:, :, None], shape).reshape(-1, 2)
    points = np.broadcast_to(corners[:, None], shape).reshape(-1, 2)
    distance = point_edge(points, starts, ends).distance.reshape(shape[:3])
    # half-way between two segments their mean is as small as it gets, and convex too
    one, other = np.triu_indices(4)
    means = 0.5 * (distance[:, one] + distance[:, other])
    least: FloatArray = means.max(axis=2).min(axis=1)
    return least


def _longest_first(corners: FloatArray, near: IntArray) -> tuple[FloatArray, IntArray]:
    """Triangles (T, 3, 2) from their longest side on, and what belongs to their corners (T, 3)."""
    lengths = norm(np.roll(corners, -1, axis=1) - corners)
    rows, turns = np.arange(len(corners))[:, None], (lengths.argmax(axis=1)[:, None] + np.arange(3)) % 3
    return corners[rows, turns], near[rows, turns]
