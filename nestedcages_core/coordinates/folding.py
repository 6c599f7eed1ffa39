"""Folds: triangles that a pose turns over, so that the drawing in them lies on itself."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import BoxTree, crossing_pairs, orientation, winding_number


def holding(points: FloatArray, triangles: IntArray, shape: Mesh) -> BoolArray:
    """(T,) whether triangles (T, 3) of points (N, 2), counter-clockwise, hold a part of a shape."""
    held: BoolArray = (winding_number(points, shape.vertices, shape.edge_ends) == 1)[triangles].any(axis=1)
    sides = np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2)
    crossed, _ = crossing_pairs(BoxTree(points[sides[:, 0]], points[sides[:, 1]]), shape.edge_tree)
    held[crossed // 3] = True
    # A loop that crosses no side may lie in a single triangle.
    firsts = shape.vertices[[loop[0] for loop in shape.loops]]
    a, b, c = points[triangles].transpose(1, 0, 2)
    for first in firsts:
        at = np.broadcast_to(first, a.shape)
        held |= (orientation(a, b, at) >= 0) & (orientation(b, c, at) >= 0) & (orientation(c, a, at) >= 0)
    return held


def folded(posed: FloatArray, triangles: IntArray) -> BoolArray:
    """(T,) whether triangles (T, 3), counter-clockwise at rest, are turned over or flat where points (N, 2) are now."""
    a, b, c = posed[triangles].transpose(1, 0, 2)
    turned: BoolArray = orientation(a, b, c) <= 0
    return turned
