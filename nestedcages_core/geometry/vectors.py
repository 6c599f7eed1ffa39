"""Cross product, length and quarter turns of vectors in the plane."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray


def cross(u: FloatArray, v: FloatArray) -> FloatArray:
    """(...,) u × v = u_x v_y - u_y v_x of vectors (..., 2): positive if v is to the left of u."""
    product: FloatArray = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return product


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
