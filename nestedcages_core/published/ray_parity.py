"""Containment as the paper's program tests it, for comparison: parity along a ray, and crossing edges.

In the order of operations of the program, whose roundings decide rays through a vertex: an inverse 2 x 2 matrix times a
vector.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray


def inside_by_parity(points: FloatArray, starts: FloatArray, ends: FloatArray) -> BoolArray:
    """(P,) whether a ray from each point (P, 2) along +x crosses an odd number of edges (E, 2) between their ends.

    A ray through a vertex is not counted, so the result is wrong for every point at the height of a vertex.
    """
    edge, away = ends - starts, points[:, None] - starts
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / edge[:, 1]
        t = inverse * away[..., 1]
        s = edge[:, 1] * inverse * away[..., 0] - edge[:, 0] * inverse * away[..., 1]
    crosses = (edge[:, 1] != 0.0) & (t > 0.0) & (t < 1.0) & (s < 0.0)
    return np.asarray(crosses.sum(axis=1) % 2 == 1)


def edges_meet(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> bool:
    """Whether any edge of a-b (E, 2) meets any of c-d (K, 2), in floating point; parallel edges are skipped."""
    u, w, apart = (b - a)[:, None], (d - c)[None], c[None] - a[:, None]
    turn = u[..., 1] * w[..., 0] - u[..., 0] * w[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / turn
        s = w[..., 0] * inverse * apart[..., 1] - w[..., 1] * inverse * apart[..., 0]
        t = u[..., 0] * inverse * apart[..., 1] - u[..., 1] * inverse * apart[..., 0]
    return bool(((turn != 0.0) & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)).any())


def contained_by_parity(cage: FloatArray, cage_successor: IntArray, fine: FloatArray, fine_successor: IntArray) -> bool:
    """Whether all fine vertices are inside by parity and no edges meet (Gurditta & Jacobson 2022, section 3.2)."""
    ends = cage[cage_successor]
    if not inside_by_parity(fine, cage, ends).all():
        return False
    return not edges_meet(cage, ends, fine, fine[fine_successor])
