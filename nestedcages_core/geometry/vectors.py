"""Products, lengths, bounds and quarter turns of vectors in the plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arrays import FloatArray


def cross(u: FloatArray, v: FloatArray) -> FloatArray:
    """(...,) u × v = u_x v_y - u_y v_x of vectors (..., 2): positive if v is to the left of u."""
    product: FloatArray = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return product


def dot(u: FloatArray, v: FloatArray) -> FloatArray:
    """(...,) u · v of vectors (..., 2); by columns, since numpy sums rows of two in a tenth of their speed."""
    along: FloatArray = u[..., 0] * v[..., 0]
    return along + u[..., 1] * v[..., 1]


def column_cross(u: FloatArray, v: FloatArray) -> FloatArray:
    """(...,) u × v of vectors (2, ...)."""
    product: FloatArray = u[0] * v[1] - u[1] * v[0]
    return product


def column_dot(u: FloatArray, v: FloatArray) -> FloatArray:
    """(...,) u · v of vectors (2, ...)."""
    product: FloatArray = u[0] * v[0] + u[1] * v[1]
    return product


def bounds(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest coordinates (2,) of points (K, 2), K > 0."""
    x, y = points.T
    return np.array([x.min(), y.min()]), np.array([x.max(), y.max()])


def norm(v: FloatArray) -> FloatArray:
    """(...,) Euclidean lengths of vectors (..., 2)."""
    length: FloatArray = np.hypot(v[..., 0], v[..., 1])
    return length


def inner(u: FloatArray, v: FloatArray) -> float:
    """Σ u v over all entries. The order of the sum depends on the shape alone: that of the BLAS depends on threads."""
    return float((u * v).sum())


def rotated_left(v: FloatArray) -> FloatArray:
    """(..., 2) vectors turned counter-clockwise by 90°: (-y, x)."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


def rotated_right(v: FloatArray) -> FloatArray:
    """(..., 2) vectors turned clockwise by 90°: (y, -x). From an edge with the solid on its left, this points out."""
    return np.stack([v[..., 1], -v[..., 0]], axis=-1)


def crossing_point(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    """Where segments a-b and c-d, each (2,), cross, rounded; their common middle if they are parallel."""
    along, across = b - a, d - c
    determinant = along[0] * across[1] - along[1] * across[0]
    if determinant == 0.0:
        return np.asarray(0.25 * (a + b + c + d))
    share = ((c - a)[0] * across[1] - (c - a)[1] * across[0]) / determinant
    return np.asarray(a + np.clip(share, 0.0, 1.0) * along)


def format_point(point: Sequence[float] | FloatArray) -> str:
    """A point in words, for messages."""
    return f"({float(point[0]):.6g}, {float(point[1]):.6g})"
