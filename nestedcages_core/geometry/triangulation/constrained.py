"""The constrained Delaunay triangulation of a solid given by points and closed loops of segments.

Every edge that is not a segment has its opposite angles sum up to at most π, so the cotangent Laplacian is an M-matrix
and what is harmonic on the triangles obeys the maximum principle.
"""

from __future__ import annotations

import numpy as np
import scipy

from ...errors import InvalidMeshError
from ..arrays import BoolArray, FloatArray, IntArray
from ..predicates import Signs, orientation
from ..vectors import cross, place
from .flips import Flips

FRAME_DISTANCE = 4.0
"""Distance of the auxiliary corners from the centre, in extents of the points; they keep the points off the hull."""

FRAME_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
"""Directions of the auxiliary corners, counter-clockwise."""

DOUBTFUL_ANGLE = 1e-13
"""Radians by which opposite angles must exceed π for an edge to get the exact in-circle test."""


def constrained_delaunay(points: FloatArray, segments: IntArray) -> IntArray:
    """Triangles (T, 3), counter-clockwise, of the region to the left of the segments; valid for any input.

    points: (N, 2), all different; segments: (S, 2) indices, closed loops that neither cross nor pass through a point.
    Points outside the region are left unused. Corners are judged by exact predicates; an edge is Delaunay to within
    DOUBTFUL_ANGLE. Raises InvalidMeshError where points coincide or segments cross.
    """
    _check_different(points)
    low, high = points.min(axis=0), points.max(axis=0)
    unit = (points - low) / float((high - low).max())  # powers aside; only Qhull sees these
    framed = np.concatenate((unit, 0.5 + FRAME_DISTANCE * FRAME_CORNERS))
    exact = np.concatenate((points, 0.5 * (low + high) + FRAME_DISTANCE * float((high - low).max()) * FRAME_CORNERS))
    triangles = _delaunay(framed, exact)
    suspects, missing = _suspects(exact, triangles, segments), _missing(triangles, segments, len(exact))
    if len(suspects) or missing.any():
        flips = Flips(exact, triangles)
        flips.legalise(map(tuple, suspects.tolist()))
        flips.constrain(np.concatenate((segments[~missing], segments[missing])))
        triangles = flips.triangles()
    return _left_of(triangles, segments, len(exact))


def _check_different(points: FloatArray) -> None:
    order = np.lexsort((points[:, 1], points[:, 0]))
    same = np.flatnonzero((points[order[1:]] == points[order[:-1]]).all(axis=1))
    if len(same):
        raise InvalidMeshError(
            f"Two points lie at {place(points[order[same[0]]])}; remove one of them.",
            code="mesh.repeated_vertex",
            place=points[order[same[0]]],
        )


def _delaunay(framed: FloatArray, exact: FloatArray) -> IntArray:
    """A Delaunay triangulation of the points, up to rounding, that is valid by exact predicates.

    Qhull's where it is valid, which is nearly always; else points are inserted one by one.
    """
    try:
        triangles: IntArray = scipy.spatial.Delaunay(framed).simplices.astype(np.int64)
    except scipy.spatial.QhullError:
        triangles = np.zeros((0, 3), dtype=np.int64)
    turn = orientation(*(exact[triangles[:, k]] for k in range(3)))
    triangles[turn < 0, :2] = triangles[turn < 0, 1::-1]
    if _is_valid(triangles, len(exact), turn):
        return triangles
    first = len(exact) - len(FRAME_CORNERS)
    flips = Flips(exact, first + np.array([[0, 1, 2], [0, 2, 3]]))
    flips.insert(_along_a_curve(framed[:first]))
    return flips.triangles()


def _is_valid(triangles: IntArray, count: int, turn: Signs) -> bool:
    """Whether triangles with exact orientations `turn` tile the frame: Euler's count, each inner edge once each way.

    Without a flat triangle, and with every directed edge once, they cover the frame once.
    """
    if len(triangles) != 2 * (count - 1) - len(FRAME_CORNERS) or not turn.all():
        return False
    if len(np.unique(triangles)) != count:
        return False
    starts, ends = _directed_edges(triangles)
    keys, back = starts * count + ends, ends * count + starts
    return len(np.unique(keys)) == len(keys) and int((~np.isin(keys, back)).sum()) == len(FRAME_CORNERS)


def _along_a_curve(points: FloatArray) -> list[int]:
    """The points row by row, there and back, so that consecutive ones are close."""
    rows = max(int(np.sqrt(len(points) / 2.0)), 1)
    row = np.minimum((points[:, 1] * rows).astype(np.int64), rows - 1)
    x = np.where(row % 2 == 0, points[:, 0], -points[:, 0])
    order: list[int] = np.lexsort((x, row)).tolist()
    return order


def _directed_edges(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """Starts and ends, (3T,) each, of the edges, first those opposite to corner 2."""
    return triangles.T.ravel(), triangles[:, [1, 2, 0]].T.ravel()


def _missing(triangles: IntArray, segments: IntArray, count: int) -> BoolArray:
    """(S,) whether a segment is no edge."""
    starts, ends = _directed_edges(triangles)
    return ~np.isin(segments[:, 0] * count + segments[:, 1], starts * count + ends)


def _suspects(points: FloatArray, triangles: IntArray, segments: IntArray) -> IntArray:
    """Inner edges (K, 2) that may fail the in-circle test, judged by their opposite angles in floating point."""
    starts, ends = _directed_edges(triangles)
    apexes = triangles[:, [2, 0, 1]].T.ravel()
    to_start, to_end = points[starts] - points[apexes], points[ends] - points[apexes]
    angle = np.arctan2(cross(to_start, to_end), (to_start * to_end).sum(axis=1))
    low, high = np.minimum(starts, ends), np.maximum(starts, ends)
    keys, place_of = np.unique(low * len(points) + high, return_inverse=True)
    total = np.bincount(place_of, weights=angle)
    wide = total > np.pi + DOUBTFUL_ANGLE
    fixed = np.sort(segments, axis=1)
    wide &= ~np.isin(keys, fixed[:, 0] * len(points) + fixed[:, 1])
    return np.stack(np.divmod(keys[wide], len(points)), axis=1)


def _left_of(triangles: IntArray, segments: IntArray, count: int) -> IntArray:
    """The triangles that can be reached from the left side of a segment without crossing one."""
    starts, ends = _directed_edges(triangles)
    owner = np.tile(np.arange(len(triangles)), 3)
    keys, back = starts * count + ends, ends * count + starts
    order = np.argsort(keys)
    place_of = np.searchsorted(keys, back, sorter=order).clip(max=len(keys) - 1)
    across = order[place_of]
    fixed = np.concatenate((segments[:, 0] * count + segments[:, 1], segments[:, 1] * count + segments[:, 0]))
    joined = (keys[across] == back) & ~np.isin(keys, fixed)
    links = scipy.sparse.coo_array(
        (np.ones(joined.sum()), (owner[joined], owner[across[joined]])), shape=(len(triangles),) * 2
    )
    piece = scipy.sparse.csgraph.connected_components(links, directed=False)[1]
    seeds = np.unique(piece[owner[np.isin(keys, fixed[: len(segments)])]])
    return triangles[np.isin(piece, seeds)]
