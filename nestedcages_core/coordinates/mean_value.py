"""Mean value coordinates: closed form, any cage, smooth inside; weights may be negative in concave cages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .precision import CHUNK_ENTRIES, corrected


@dataclass(frozen=True)
class MeanValue:
    """w_i = (tan(α_{i-1}/2) + tan(α_i/2)) / r_i over the edges of all loops (Hormann & Floater 2006, section 4)."""

    def weights(self, points: FloatArray, cage: Mesh) -> FloatArray:
        """Coordinates of points.

        Parameters
        ----------
        points : (P, 2) array
            Anywhere; on the cage, the coordinates are linear along each edge.
        cage : Mesh
            A cage of m vertices.

        Returns
        -------
        (P, m) array
        """
        corners = cage.vertices
        chunk = max(CHUNK_ENTRIES // len(corners), 1)
        parts = [np.zeros((0, len(corners)))]
        for first in range(0, len(points), chunk):
            some = points[first : first + chunk]
            parts.append(corrected(_mean_values(some, corners, cage), some, corners))
        return np.concatenate(parts)


def _mean_values(points: FloatArray, corners: FloatArray, cage: Mesh) -> FloatArray:
    """Coordinates (P, m) up to a factor per row, whose sum is not zero."""
    ahead, before = cage.successor, cage.predecessor
    x, y = corners[:, 0] - points[:, :1], corners[:, 1] - points[:, 1:]
    r = np.hypot(x, y)
    dot = x * x[:, ahead] + y * y[:, ahead]
    cross = x * y[:, ahead] - y * x[:, ahead]
    product = r * r[:, ahead]
    sharp = dot > 0.0
    on_edge = (cross == 0.0) & ~sharp
    with np.errstate(divide="ignore", invalid="ignore"):
        # tan(α/2) = sin α / (1 + cos α) = (1 - cos α) / sin α, whichever does not cancel
        half_tangent = np.where(sharp, cross / (product + dot), (product - dot) / cross)
        weights: FloatArray = (half_tangent + half_tangent[:, before]) / r
    row, edge = np.nonzero(on_edge)  # both ends lie in opposite directions, or one of them is the point
    weights[row] = 0.0
    ends = ahead[edge]
    whole = r[row, edge] + r[row, ends]
    weights[row, edge] = r[row, ends] / whole
    weights[row, ends] = r[row, edge] / whole
    return weights
