"""The quadratic program of one tightening step: a model of energy and distances at the current cage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..contact.linearisation import Contacts, constraint_rows, local_axes, measure, resolve_corners
from ..contact.pairs import Bodies, CandidateList, Pairs, WantedDistances
from ..contact.pruning import not_implied
from ..energies import Blocks, CageEnergy
from ..geometry.arrays import FloatArray
from ..solver.quadratic_program import QPSolution, QuadraticProgram
from .trust_region import Surroundings

LONGEST_MOTION = 1.5
"""Longest motion of a vertex in one step, restoration included, in radii; √2 without restoration."""


@dataclass(frozen=True, eq=False)
class QuadraticModel:
    """The program at a cage, and the pairs that can meet in its step."""

    program: QuadraticProgram
    around: Surroundings
    """All pairs that can meet in a step."""
    _rows: Pairs
    _row_contacts: Contacts

    def loads(self, solution: QPSolution) -> EdgeLoads:
        """Loads of the edges in the solution of the program."""
        of_contacts = solution.multipliers[: len(self._rows)]
        return EdgeLoads.of(self._rows, self._row_contacts, of_contacts, len(solution.step))


def model_at(
    x: FloatArray,
    bodies: Bodies,
    candidates: CandidateList,
    energy: CageEnergy,
    wanted: WantedDistances,
    radius: float,
    loads: EdgeLoads,
    missed: float = 0.0,
) -> QuadraticModel:
    """The model at x (m + n, 2), with the curvature of the contacts under the ``loads``; radius: Δ.

    missed: ε of the rows of bounds that the cage misses, which pull it; 0: they may not get worse.
    """
    m = bodies.m
    longest = LONGEST_MOTION * radius
    farthest_motion = np.zeros(len(x))
    farthest_motion[:m] = longest
    pairs = candidates.meeting(x, wanted.largest, farthest_motion, wanted.largest + longest, 2.0 * longest)
    contacts = measure(pairs, x)
    required = wanted.of(pairs)

    reach = np.zeros(len(x))
    reach[:m] = radius * np.sqrt(2.0)
    near = np.flatnonzero(contacts.distance - required < pairs.approach(reach))
    some, contact = resolve_corners(bodies, pairs.take(near), contacts.take(near), x, wanted.clearance)
    room = contact.distance - wanted.of(some)
    keep = np.flatnonzero(not_implied(some, contact, room))
    some, contact = some.take(keep), contact.take(keep)

    cage, successor = x[:m], bodies.coarse.successor
    curvature = contact_curvature(bodies, cage, loads, radius)
    rows, rooms, softness = [*constraint_rows(some, contact)], np.maximum(room[keep], 0.0), None
    if bodies.bounds:
        from ..constraints.base import terms_of

        more, further = terms_of(bodies.bounds, cage, radius)
        softness = np.where(np.concatenate((rooms, further)) < 0.0, missed, 0.0) if missed else None
        rows, rooms = [*rows, *more], np.concatenate((rooms, further if missed else np.maximum(further, 0.0)))
    program = QuadraticProgram(
        energy.gradient(cage, successor),
        Blocks.sum([(1.0, energy.hessian(cage, successor)), (1.0, curvature)]),
        rows,
        rooms,
        np.full(m, radius),
        local_axes(bodies, x),
        softness=softness,
    )
    around = Surroundings(pairs, contacts.distance, contacts.side, required, farthest_motion)
    return QuadraticModel(program, around, some, contact)


class EdgeLoads(NamedTuple):
    """Sums over the contacts on the inner side of each of the m cage edges.

    An edge a-b with unit tangent τ, inner normal n and length L, and contacts with multipliers z at parameters t and
    distances d, contributes to the second-order change of these distances

        -Σ z ∂²d = c qᵀ + q cᵀ + Σ z d q qᵀ,   c = (-Σ z (1 - t) τ, -Σ z t τ),   q = (-n, n) / L

    over (a, b). Only three sums per edge enter, so an edge that rolls from one fine vertex to the next keeps its
    curvature.
    """

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


def contact_curvature(bodies: Bodies, cage: FloatArray, loads: EdgeLoads, radius: float) -> Blocks:
    """-Σ z ∂²d of the contacts on the inner side of the cage (m, 2), three blocks per edge.

    radius: largest motion of a vertex. Edges count as at least that long, since the second-order term holds for shorter
    motions only.
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
    length = np.maximum(length, radius)
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
