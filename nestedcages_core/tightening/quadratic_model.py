"""The quadratic program of one tightening step: a model of energy and distances at the current cage."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..contact.linearisation import Contacts, constraint_rows, local_axes, measure, resolve_corners
from ..contact.pairs import Bodies, CandidateList, Pairs
from ..contact.pruning import not_implied
from ..contact.wanted_distances import WantedDistances
from ..energies import Blocks, CageEnergy
from ..geometry.arrays import FloatArray
from ..solver.quadratic_program import QPSolution, QuadraticProgram
from .curvature import EdgeLoads, contact_curvature
from .trial import Surroundings
from .trust_region import TrustRegion

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

    def measured_at(self, x: FloatArray) -> QuadraticModel:
        """The model with its pairs measured at x (m + n, 2), close to where it was made."""
        contacts = measure(self.around.pairs, x)
        return replace(self, around=replace(self.around, distance=contacts.distance, side=contacts.side))

    def loads(self, solution: QPSolution) -> EdgeLoads:
        """Loads of the edges in the solution of the program."""
        m = len(self.program.radius)
        return EdgeLoads.of(self._rows, self._row_contacts, solution.multipliers, m)


def model_at(
    x: FloatArray,
    bodies: Bodies,
    candidates: CandidateList,
    energy: CageEnergy,
    wanted: WantedDistances,
    region: TrustRegion,
    loads: EdgeLoads,
) -> QuadraticModel:
    """The model at x (m + n, 2), with the curvature of the contacts under the ``loads``."""
    m = bodies.m
    longest = LONGEST_MOTION * float(region.radius.max())
    farthest_motion = np.zeros(len(x))
    farthest_motion[:m] = longest
    within = wanted.largest + 2.0 * longest
    pairs = candidates.meeting(x, wanted.largest, farthest_motion, within, 2.0 * longest)
    contacts = measure(pairs, x)
    required = wanted.of(pairs)

    reach = np.zeros(len(x))
    reach[:m] = region.radius * np.sqrt(2.0)
    near = np.flatnonzero(contacts.distance - required < pairs.approach(reach))
    some, contact = resolve_corners(bodies, pairs.take(near), contacts.take(near), x, wanted.clearance)
    room = contact.distance - wanted.of(some)
    keep = np.flatnonzero(not_implied(some, contact, room))
    some, contact = some.take(keep), contact.take(keep)

    cage, successor = x[:m], bodies.coarse.successor
    curvature = contact_curvature(bodies, cage, loads, region.radius)
    program = QuadraticProgram(
        energy.gradient(cage, successor),
        Blocks.sum([(1.0, energy.hessian(cage, successor)), (1.0, curvature)]),
        constraint_rows(some, contact),
        np.maximum(room[keep], 0.0),
        region.radius,
        local_axes(bodies, x),
    )
    around = Surroundings(pairs, contacts.distance, contacts.side, required, farthest_motion)
    return QuadraticModel(program, around, some, contact)
