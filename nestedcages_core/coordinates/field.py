"""A field of weights: a mesh that carries the motion of a cage to whatever lies in it, and the folds of a pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.mesh import Mesh
from ..geometry.predicates import crossing_pairs, orientation, winding_number
from ..geometry.triangulation import Sampling, Triangulation, triangulate
from .harmonic import from_values
from .precision import corrected

INSIDE = Sampling(1.0 / 64.0, at_corners=1.0 / 4.0)
"""Spacing of the triangles in the cage, in cage diagonals: some 1,000 vertices, 0.1 % of error in a bent limb."""
OUTSIDE = Sampling(1.0 / 16.0, growth=1.0)
"""The same for the triangles around it, where only strokes and edits reach."""
REACH = 0.5
"""Distance that the field reaches beyond the cage's bounding box, in cage diagonals."""


@dataclass(frozen=True, eq=False)
class Field:
    """Triangles that cover a cage and its surroundings, and how each of their vertices moves with the cage."""

    vertices: FloatArray
    """(N, 2), first those of the cage."""
    triangles: IntArray
    """(T, 3) corners, counter-clockwise; they cover the cage, its holes and its surroundings once."""
    weights: FloatArray
    """(N, m): weights @ cage.vertices = vertices. Not negative inside the cage."""


def field_of(cage: Mesh, sampling: Sampling | None = INSIDE) -> Field:
    """The field of a cage: harmonic coordinates inside; outside, harmonic between the cage and an affine motion.

    The affine motion, on a box around the cage, is the one that fits the motion of the cage's vertices best, so every
    affine pose is reproduced everywhere. Holes of the cage are covered too. Without a sampling, in cage diagonals, the
    field is linear on the cage's own triangles.
    """
    middle = 0.5 * (cage.vertices.min(axis=0) + cage.vertices.max(axis=0))
    corners, count = cage.vertices - middle, len(cage.vertices)
    extent = cage.diagonal
    reach = np.abs(corners).max(axis=0) + REACH * extent
    box = reach * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    round_ = count + np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    outer = Mesh(np.concatenate((corners, box)), np.concatenate((cage.edges, round_)))
    inside = triangulate(Mesh(corners, cage.edges), sampling and _scaled(sampling, extent))
    outside = triangulate(outer, _scaled(OUTSIDE, extent))
    within = corrected(np.maximum(_values(inside, count), 0.0), inside.vertices, corners)
    around = _values(outside, len(outer.vertices))
    around = corrected(around[:, :count] + around[:, count:] @ _affine(box, corners), outside.vertices, corners)
    # The same points along the outline twice: both grids are linear there between the cage's vertices.
    vertices = np.concatenate((inside.vertices, outside.vertices[count:])) + middle
    number = np.concatenate((np.arange(count), len(inside.vertices) + np.arange(len(outside.vertices) - count)))
    return Field(
        np.concatenate((cage.vertices, vertices[count:])),
        np.concatenate((inside.triangles, number[outside.triangles])),
        np.concatenate((within, around[count:])),
    )


def _scaled(sampling: Sampling, extent: float) -> Sampling:
    return Sampling(sampling.spacing * extent, sampling.at_corners, sampling.growth)


def _values(grid: Triangulation, corners: int) -> FloatArray:
    """(N, corners) values of the harmonic coordinates at all vertices of a triangulation."""
    return from_values(grid, scipy.sparse.eye_array(len(grid.vertices)).tocsr(), corners)


def _affine(points: FloatArray, corners: FloatArray) -> FloatArray:
    """(P, m) weights of the affine motion that fits that of the corners (m, 2) best, in the least squares."""
    ones = np.ones((len(corners), 1))
    fit = np.linalg.pinv(np.concatenate((corners, ones), axis=1))
    return np.concatenate((points, np.ones((len(points), 1))), axis=1) @ fit


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
