"""Bridges between parts of a solid: the edges of a minimum spanning tree, each as a patch that joins two parts."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heapify, heappop, heappush
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import Delaunay

from ..geometry.arrays import TINY
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF

NECK = 0.05
"""Half the width of a bridge, in its lengths."""

POINTS = 64
"""Points of each outline, at least, that tell which parts are neighbours."""


def bridges(shapely: Any, mesh: Mesh, room: float) -> list[Any]:
    """Patches that join all parts of a mesh: over gaps narrower than some room first, then where the hulls of what is
    joined, with all that was joined to it before, leave the least area between them."""
    parts = list(shapely.geometry.shape(mesh.__geo_interface__).geoms)
    joins = [(i, j, shapely.shortest_line(parts[i], parts[j])) for i, j in _spanning_tree(shapely, parts)]
    group, hulls = np.arange(len(parts)), [part.convex_hull for part in parts]

    def between(k: int) -> float:
        i, j, gap = joins[k]
        one, other = hulls[group[i]], hulls[group[j]]
        return float(gap.length >= room and max(0.0, one.union(other).convex_hull.area - one.area - other.area))

    waiting = [(between(k), gap.length, k) for k, (_, _, gap) in enumerate(joins)]
    heapify(waiting)
    patches = []
    while waiting:
        _, length, k = heappop(waiting)
        area = between(k)  # now, since something was joined
        if waiting and area > waiting[0][0]:
            heappush(waiting, (area, length, k))
            continue
        i, j, gap = joins[k]
        hulls[group[i]] = hulls[group[i]].union(hulls[group[j]]).convex_hull
        group[group == group[j]] = group[i]
        patches.append(_patch(gap, mesh.diagonal))
    return patches


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


def _patch(gap: Any, size: float) -> Any:
    """A bridge along a line between polygons of a size."""
    length = max(gap.length, INPUT_ROUND_OFF * size)
    return gap.buffer(NECK * length, cap_style="square" if gap.length else "round")
