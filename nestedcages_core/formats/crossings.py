"""What uniting outlines will take, counted before: GEOS takes time by their crossings and by boxes that meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.predicates import orientation
from .limits import Quota

PAIRS_PER_SECOND = 1_000_000
"""Pairs of edges whose boxes meet that are looked at in a second (measured)."""

MEETINGS_PER_SECOND = 50_000
"""Pairs of rings whose boxes meet that are overlaid and offset in a second, whether they touch or not (measured)."""

NESTINGS_PER_SECOND = 500_000
"""The same of rings that become a mesh as they are (measured)."""

Edges = tuple[FloatArray, FloatArray]
"""Starts and ends, (E, 2) each."""


def spend_union(shapely: Any, geometries: Any, quota: Quota | None) -> None:
    """Count what the union of polygons, lines and collections of these will take; no quota: not at all.

    Raises NestedCagesError where it would take longer than the quota allows.
    """
    if quota is not None:
        lines = _rings_in(shapely, geometries)
        low, high = np.hsplit(shapely.bounds(lines), 2)
        _spend_meetings(low, high, MEETINGS_PER_SECOND, quota)
        spend_crossings(_segments_in(shapely, lines), quota)


def edges_in(shapely: Any, geometries: Any) -> Edges:
    """All edges of polygons, lines and collections of these."""
    return _segments_in(shapely, _rings_in(shapely, geometries))


def _rings_in(shapely: Any, geometries: Any) -> Any:
    """All rings and lines of geometries, as an array of objects."""
    parts = shapely.get_parts(shapely.get_parts(np.asarray(geometries, dtype=object)))
    return np.concatenate([shapely.get_rings(parts), parts[shapely.get_dimensions(parts) == 1]])


def _segments_in(shapely: Any, lines: Any) -> Edges:
    points, line = shapely.get_coordinates(lines, return_index=True)
    follows = line[1:] == line[:-1]
    return points[:-1][follows], points[1:][follows]


def spend_nestings(loops: Sequence[FloatArray], quota: Quota | None) -> None:
    """Count what a mesh of loops (k, 2) will take. Raises NestedCagesError for more than the quota allows."""
    if quota is not None:
        points, begins = np.concatenate(loops), np.cumsum([0, *map(len, loops[:-1])])
        low, high = (extreme.reduceat(points, begins) for extreme in (np.minimum, np.maximum))
        _spend_meetings(low, high, NESTINGS_PER_SECOND, quota)


def _spend_meetings(low: FloatArray, high: FloatArray, per_second: int, quota: Quota) -> None:
    """Count the pairs of boxes, (B, 2) corners each, that meet."""
    for i, _ in BoxTree(low, high).blocks():
        quota.spend("seconds", len(i) / per_second)


def spend_crossings(edges: Edges, quota: Quota | None, *, own: bool = False) -> None:
    """Count the pairs of edges that cross or overlap, but not those that meet at ends.

    quota: none if None; own: whether the edges are those of one outline.

    Raises NestedCagesError where uniting them would take longer than the quota allows.
    """
    if quota is None:
        return
    long = (edges[0] != edges[1]).any(axis=1)
    both = np.sort(np.stack([edge[long] @ [1.0, 1j] for edge in edges], axis=1), axis=1)
    different, copies = np.unique(both, axis=0, return_counts=True)
    starts, ends = (np.stack([end.real, end.imag], axis=1) for end in different.T)
    for i, j in BoxTree(starts, ends).blocks():
        crosses = _do_cross(starts[i], ends[i], starts[j], ends[j])
        quota.spend_crossings(int(copies[i[crosses]] @ copies[j[crosses]]), own=own)
        quota.spend("seconds", len(i) / PAIRS_PER_SECOND)


def _do_cross(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> BoolArray:
    """(K,) whether segments a-b and c-d have more than an end in common, and are not the same."""
    first = orientation(a, b, c) * orientation(a, b, d)
    crossing = (first < 0) & (orientation(c, d, a) * orientation(c, d, b) < 0)
    flat: IntArray = np.flatnonzero((orientation(a, b, c) == 0) & (orientation(a, b, d) == 0))
    low, high = np.minimum(a, b)[flat], np.maximum(a, b)[flat]
    other_low, other_high = np.minimum(c, d)[flat], np.maximum(c, d)[flat]
    together = (np.maximum(low, other_low) < np.minimum(high, other_high)).any(axis=1)
    same = ((low == other_low) & (high == other_high)).all(axis=1)
    crossing[flat] = together & ~same
    return np.asarray(crossing)
