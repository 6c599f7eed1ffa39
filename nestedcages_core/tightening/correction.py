"""Correction of a step that misses rows of bounds: the smallest motion that makes up for them, to first order.

Rows and contacts that the motion would break hold too, so that neither the restoration after it nor the next correction
has much to undo.
"""

from __future__ import annotations

import numpy as np

from ..constraints.base import terms_of
from ..contact.linearisation import OVERSHOOT, Contacts, constraint_rows
from ..contact.pairs import Bodies, Pairs
from ..geometry.arrays import FloatArray
from ..geometry.precision import NEGLIGIBLE
from ..solver.banded import Rows

JOINING_PASSES = 6
"""Maximum number of times that further rows join."""

LACK_REACH = 10.0
"""Motion that rows may be broken by, in what is missed most."""


def correction(
    bodies: Bodies, pairs: Pairs, contacts: Contacts, required: FloatArray, cage: FloatArray, lacking: FloatArray
) -> FloatArray | None:
    """(m, 2) the motion of a cage (m, 2); None if it misses nothing.

    required: (K,) distances that the pairs keep; lacking: (m,) what was lacking before; rows of vertices that lacked
    anything are left as they are.
    """
    reach = 0.0
    for _ in range(2):  # the rows that are missed; then those that a motion of that size can break
        rows, room = terms_of(bodies.bounds, cage, reach)
        kept = np.concatenate([np.zeros(0, bool), *((lacking[group.vertex] == 0.0).all(axis=0) for group in rows)])
        missed = float(room[kept].min(initial=0.0))
        if missed == 0.0:
            return None
        reach = -LACK_REACH * missed
    room = np.concatenate((room[kept], np.maximum(contacts.distance - required, 0.0)))
    slopes = np.concatenate((_slopes(bodies, rows)[kept], _slopes(bodies, [*constraint_rows(pairs, contacts)])))
    held = room < 0.0
    for _ in range(JOINING_PASSES):
        unknowns = _smallest(slopes[held], -np.where(room < 0.0, OVERSHOOT, 1.0)[held] * room[held])
        broken = (room + slopes @ unknowns < 0.0) & ~held
        if not broken.any():
            break
        held |= broken
    motion: FloatArray = unknowns.reshape(-1, 2)
    return motion if bodies.elimination is None else bodies.elimination.motion(motion)


def _slopes(bodies: Bodies, rows: list[Rows]) -> FloatArray:
    """(K, 2m) the rows, or those over the unknowns of the cage."""
    if bodies.elimination is None:
        return np.concatenate([group.dense(bodies.m) for group in rows])
    return np.concatenate([bodies.elimination.rows(group).dense(bodies.elimination.count) for group in rows])


def _smallest(slopes: FloatArray, missing: FloatArray) -> FloatArray:
    """(N,) the smallest vector v with slopes v = missing, nearly where slopes (K, N) depend on each other."""
    products = np.einsum("ij,kj->ik", slopes, slopes)
    products[np.diag_indices(len(missing))] += NEGLIGIBLE * products.trace() / len(missing)
    vector: FloatArray = np.einsum("i,ij->j", np.linalg.solve(products, missing), slopes)
    return vector
