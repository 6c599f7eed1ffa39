"""Bridges between parts of a solid: the edges of a minimum spanning tree, each as a patch that joins two parts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import Delaunay

from ..geometry.arrays import TINY
from ..geometry.precision import INPUT_ROUND_OFF

NECK = 0.05
"""Half the width of a bridge, in its lengths."""

POINTS = 64
"""Points of each outline, at least, that tell which parts are neighbours."""


def bridges(shapely: Any, parts: Sequence[Any]) -> Iterator[tuple[int, int, Any, float]]:
    """Pairs of polygons whose joins connect all, of the least total distance: the two, a patch, and what it adds."""
    for i, j in _spanning_tree(shapely, parts):
        patch = _patch(shapely, parts[i], parts[j])
        yield i, j, patch, float(patch.difference(shapely.union_all([parts[i], parts[j]])).area)


def _spanning_tree(shapely: Any, parts: Sequence[Any]) -> list[tuple[int, int]]:
    if len(parts) == 1:
        return []
    rings = [np.array(part.exterior.segmentize(max(part.length / POINTS, TINY)).coords)[:-1] for part in parts]
    points, owner = np.concatenate(rings), np.repeat(np.arange(len(parts)), list(map(len, rings)))
    corners = Delaunay(points - points.mean(axis=0), qhull_options="Qbb QJ").simplices
    pairs = np.sort(owner[np.concatenate((corners[:, :2], corners[:, 1:], corners[:, ::2]))], axis=1)
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).astype(np.int32)
    every = np.array(parts, dtype=object)
    gaps = shapely.distance(every[pairs[:, 0]], every[pairs[:, 1]])
    gaps = np.maximum(gaps, max(INPUT_ROUND_OFF * float(gaps.max()), TINY))  # scipy takes zeros for missing edges
    tree = minimum_spanning_tree(coo_array((gaps, pairs.T), shape=(len(parts), len(parts))).tocsr()).tocoo()
    return list(zip(tree.row.tolist(), tree.col.tolist(), strict=True))


def _patch(shapely: Any, one: Any, other: Any) -> Any:
    """A bridge between the nearest points of two polygons."""
    bridge = shapely.shortest_line(one, other)
    gap = max(bridge.length, INPUT_ROUND_OFF * float(np.ptp(one.bounds)))
    return bridge.buffer(NECK * gap, cap_style="square" if bridge.length else "round")
