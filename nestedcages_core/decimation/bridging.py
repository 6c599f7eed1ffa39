"""Bridges between parts of a solid: the edges of a minimum spanning tree, each as a patch that joins two parts."""

from __future__ import annotations

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


def bridges(shapely: Any, mesh: Mesh) -> list[Any]:
    """Patches that join all parts of a mesh, of the least total length, the shortest first."""
    parts = list(shapely.geometry.shape(mesh.__geo_interface__).geoms)
    rings = [np.array(part.exterior.segmentize(max(part.length / POINTS, TINY)).coords)[:-1] for part in parts]
    points, owner = np.concatenate(rings), np.repeat(np.arange(len(parts)), list(map(len, rings)))
    corners = Delaunay(points - points.mean(axis=0), qhull_options="Qbb QJ").simplices
    pairs = np.sort(owner[np.concatenate((corners[:, :2], corners[:, 1:], corners[:, ::2]))], axis=1)
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).astype(np.int32)
    every, least = np.array(parts, dtype=object), max(INPUT_ROUND_OFF * mesh.diagonal, TINY)
    gaps = np.maximum(shapely.distance(*every[pairs.T]), least)  # scipy takes zeros for missing edges
    tree = minimum_spanning_tree(coo_array((gaps, pairs.T), shape=(len(parts), len(parts))).tocsr()).tocoo()
    order = np.argsort(tree.data, kind="stable")
    lines = shapely.shortest_line(every[tree.row[order]], every[tree.col[order]])
    widths = NECK * tree.data[order]
    return [
        line.buffer(width, cap_style="square" if line.length else "round")
        for line, width in zip(lines, widths, strict=True)
    ]
