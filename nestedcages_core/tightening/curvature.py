"""Curvature of the contacts: how much a motion of a cage edge brings it closer to its contacts to second order.

An edge a-b with unit tangent τ, inner normal n and length L that carries contacts with multipliers z at the parameters
t and distances d has

    -Σ z ∂²d = c qᵀ + q cᵀ + Σ z d q qᵀ,   c = (-Σ z (1 - t) τ, -Σ z t τ),   q = (-n, n) / L

over (a, b). The contacts enter only through three sums per edge. So an edge that rolls from one fine vertex to the next
keeps its curvature.
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
    """Sums of the multipliers of the contacts on the inner side of each of the m cage edges."""

    force: FloatArray
    """(m,) Σ z."""
    moment: FloatArray
    """(m,) Σ z t."""
    gap: FloatArray
    """(m,) Σ z d."""

    @classmethod
    def none(cls, m: int) -> EdgeLoads:
        return cls(np.zeros(m), np.zeros(m), np.zeros(m))

    @classmethod
    def of(cls, pairs: Pairs, contacts: Contacts, multipliers: FloatArray, m: int) -> EdgeLoads:
        family = pairs.fine_cage
        t = contacts.parameter[family]
        z = np.where(contacts.on_line[family] & (contacts.side[family] > 0.0), multipliers[family], 0.0)
        edge = pairs.start[family]
        loads = (np.bincount(edge, weight, m) for weight in (z, z * t, z * contacts.distance[family]))
        return cls(*(load.astype(np.float64, copy=False) for load in loads))  # integers when there are no contacts


def contact_curvature(bodies: Bodies, cage: FloatArray, loads: EdgeLoads, radius: FloatArray) -> Blocks:
    """-Σ z ∂²d of the contacts on the inner side of the cage (m, 2), three blocks per edge.

    radius: (m,) how far each vertex is about to move. An edge that is shorter than that counts as so long, for its own
    curvature holds only for motions that are shorter than itself.
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
