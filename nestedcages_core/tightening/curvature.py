"""Curvature of the contacts: the second-order change of their distances under a motion of the cage.

An edge a-b with unit tangent τ, inner normal n and length L, and contacts with multipliers z at parameters t and
distances d, contributes

    -Σ z ∂²d = c qᵀ + q cᵀ + Σ z d q qᵀ,   c = (-Σ z (1 - t) τ, -Σ z t τ),   q = (-n, n) / L

over (a, b). Only three sums per edge enter, so an edge that rolls from one fine vertex to the next keeps its curvature.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..contact.linearisation import Contacts
from ..contact.pairs import Bodies, Pairs
from ..energies import Blocks
from ..geometry.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class EdgeLoads:
    """Sums over the contacts on the inner side of each of the m cage edges."""

    force: FloatArray
    """(m,) Σ z."""
    moment: FloatArray
    """(m,) Σ z t."""
    gap: FloatArray
    """(m,) Σ z d."""

    @classmethod
    def none(cls, m: int) -> EdgeLoads:
        """Edges without contacts."""
        return cls(np.zeros(m), np.zeros(m), np.zeros(m))

    @classmethod
    def of(cls, pairs: Pairs, contacts: Contacts, multipliers: FloatArray, m: int) -> EdgeLoads:
        """The loads of K pairs with multipliers (K,); m: number of cage edges."""
        family = pairs.fine_cage
        t = contacts.parameter[family]
        z = np.where(contacts.on_line[family] & (contacts.side[family] > 0.0), multipliers[family], 0.0)
        edge = pairs.start[family]
        loads = (np.bincount(edge, weight, m) for weight in (z, z * t, z * contacts.distance[family]))
        return cls(*(load.astype(np.float64, copy=False) for load in loads))  # bincount of nothing is int


def contact_curvature(bodies: Bodies, cage: FloatArray, loads: EdgeLoads, radius: FloatArray) -> Blocks:
    """-Σ z ∂²d of the contacts on the inner side of the cage (m, 2), three blocks per edge.

    radius: (m,) largest motion of each vertex. Edges count as at least that long, since the second-order term holds for
    shorter motions only.
    """
    after = bodies.cage.successor
    columns = np.ascontiguousarray(cage.T)
    tangent = columns.take(after, axis=1) - columns
    length = np.hypot(tangent[0], tangent[1])
    tangent /= length
    normal = np.empty_like(tangent)
    np.negative(tangent[1], out=normal[0])
    normal[1] = tangent[0]
    nt = normal[:, None] * tangent
    tn = nt.transpose(1, 0, 2)
    both = nt + tn
    length = np.maximum(length, np.maximum(radius, radius.take(after)))
    at_start = (loads.force - loads.moment) / length
    at_end = loads.moment / length
    nn = normal[:, None] * normal * (loads.gap / length**2)
    blocks = np.empty((2, 2, 3, bodies.m))
    np.add(at_start * both, nn, out=blocks[:, :, 0])
    np.subtract(at_end * nt - at_start * tn, nn, out=blocks[:, :, 1])
    np.subtract(nn, at_end * both, out=blocks[:, :, 2])
    vertex = np.arange(bodies.m)
    return Blocks(
        np.concatenate([vertex, vertex, after]),
        np.concatenate([vertex, after, after]),
        blocks.reshape(4, -1).T.reshape(-1, 2, 2),
    )
