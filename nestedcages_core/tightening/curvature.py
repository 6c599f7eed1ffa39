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
from ..geometry.vectors import rotated_left


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
    edge = cage[bodies.cage_successor] - cage
    length = np.hypot(edge[:, 0], edge[:, 1])
    tangent = edge / length[:, None]
    normal = rotated_left(tangent)
    tn = tangent[:, :, None] * normal[:, None, :]
    nt = tn.transpose(0, 2, 1)
    length = np.maximum(length, np.maximum(radius, radius[bodies.cage_successor]))
    at_start = ((loads.force - loads.moment) / length)[:, None, None]
    at_end = (loads.moment / length)[:, None, None]
    nn = normal[:, :, None] * normal[:, None, :] * (loads.gap / length**2)[:, None, None]
    vertex = np.arange(bodies.m)
    after = bodies.cage_successor
    return Blocks(
        np.concatenate([vertex, vertex, after]),
        np.concatenate([vertex, after, after]),
        np.concatenate([at_start * (tn + nt) + nn, at_end * nt - at_start * tn - nn, nn - at_end * (tn + nt)]),
    )
