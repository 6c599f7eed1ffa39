"""The quadratic program that models the energy and the distances at a cage."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..contact.linearisation import Contacts, constraint_rows, local_axes, measure, resolve_corners
from ..contact.pairs import Bodies, CandidateList, Pairs
from ..contact.pruning import not_implied
from ..energies import Blocks, CageEnergy
from ..geometry.arrays import FloatArray
from ..solver.quadratic_program import QPSolution, QuadraticProgram
from .curvature import EdgeLoads, contact_curvature
from .trial import Surroundings
from .trust_region import TrustRegion

THINNING = 0.02
"""Contacts whose constraints others imply up to this fraction of the clearance are left out; restoration makes up for
them."""

GIVING_WAY = 0.5
"""Fraction of the distance between parts of the cage, as it is modelled, that a step must really keep."""

LONGEST_MOTION = 1.5
"""Longest motion of a vertex in one step with its restoration, in radii; √2 without it. Pairs are looked for so far."""


@dataclass(frozen=True)
class Wanted:
    """Distances that the cage must keep; both lengths."""

    clearance: float
    """From the fine mesh."""
    own: float
    """From other parts of itself."""

    def of(self, pairs: Pairs) -> FloatArray:
        """(K,) distance that each pair is to keep."""
        required = np.full(len(pairs), self.clearance)
        required[pairs.cage_cage] = self.own
        return required

    def at_least(self, pairs: Pairs) -> FloatArray:
        """(K,) distance that each pair must keep: where walls of the cage and the fine mesh compete, the cage gives
        way."""
        required = self.of(pairs)
        required[pairs.cage_cage] *= GIVING_WAY
        return required


@dataclass(frozen=True, eq=False)
class QuadraticModel:
    """The program at a cage, and all contacts around it."""

    program: QuadraticProgram
    around: Surroundings
    """All pairs that can meet in a step."""
    _rows: Pairs
    _row_contacts: Contacts

    def measured_at(self, x: FloatArray) -> QuadraticModel:
        """The same pairs at x (m + n, 2), not far from where the model was made."""
        return replace(self, around=replace(self.around, contacts=measure(self.around.pairs, x)))

    def loads(self, solution: QPSolution) -> EdgeLoads:
        """The loads of the edges in the solution of the program."""
        m = len(self.program.radius)
        return EdgeLoads.of(self._rows, self._row_contacts, solution.multipliers, m)


def model_at(
    x: FloatArray,
    bodies: Bodies,
    candidates: CandidateList,
    energy: CageEnergy,
    wanted: Wanted,
    region: TrustRegion,
    loads: EdgeLoads,
) -> QuadraticModel:
    """The model at x (m + n, 2), with the curvature that the contacts have under the ``loads``."""
    m = bodies.m
    longest = LONGEST_MOTION * float(region.radius.max())
    pairs = candidates.within(x, wanted.clearance + 2.0 * longest, 2.0 * longest)
    contacts = measure(pairs, x)
    required = wanted.at_least(pairs)

    reach = np.zeros(len(x))
    reach[:m] = region.radius * np.sqrt(2.0)
    near = contacts.distance - wanted.of(pairs) < pairs.approach(reach)
    some, contact = resolve_corners(bodies, pairs.subset(near), contacts.where(near), x, wanted.clearance)
    room = contact.distance - wanted.of(some)
    keep = not_implied(some, contact, room, THINNING * wanted.clearance)
    some, contact = some.subset(keep), contact.where(keep)

    cage, successor = x[:m], bodies.cage_successor
    curvature = contact_curvature(bodies, cage, loads, region.radius)
    program = QuadraticProgram(
        energy.gradient(cage, successor),
        Blocks.sum([(1.0, energy.hessian(cage, successor)), (1.0, curvature)]),
        constraint_rows(some, contact),
        np.maximum(room[keep], 0.0),
        region.radius,
        local_axes(bodies, x),
        shift=region.shift,
        order=bodies.cage_order,
    )
    able = np.zeros(len(x))
    able[:m] = longest
    return QuadraticModel(program, Surroundings(pairs, contacts, required, able), some, contact)
