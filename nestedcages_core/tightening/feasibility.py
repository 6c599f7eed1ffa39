"""Feasibility phase: the smallest motion of a cage until it keeps its bounds, before its energy counts."""

from __future__ import annotations

import numpy as np

from ..constraints.base import short_of
from ..contact.contact_response import ContactResponse, Distances, FeasibilityRule
from ..contact.pairs import Bodies
from ..geometry.arrays import FloatArray
from ..geometry.precision import MOST_STEPS
from ..solver.quadratic_program import InteriorPoint
from ..tasks import Stage

LONGEST_STEP = 0.05
"""Longest motion of a vertex in one step, in mean edges of the cage: the first radius of the tightening."""

LEAST_GAIN = 1e-3
"""Fraction of all that is lacking which a step must gain."""


def feasible(bodies: Bodies, x: FloatArray, clearance: float, solver: InteriorPoint) -> Stage[FloatArray, FloatArray]:
    """Positions (m + n, 2) at which the cage keeps its bounds, or as many as small steps reach.

    Yields every intermediate x; the linear motion from the one before is free of collisions.
    """
    m, radius = bodies.m, LONGEST_STEP * bodies.cage_edge_length
    lacking = float(short_of(bodies.bounds, x[:m]).sum())
    response = ContactResponse(bodies, Distances(clearance, clearance, clearance), solver)
    rule = FeasibilityRule(bodies, clearance, clearance)
    at_rest = np.zeros((bodies.n, 2))
    for _ in range(MOST_STEPS):
        if lacking == 0.0:
            break
        found = response.to(at_rest, x, radius)
        pairs, contacts = rule.concerned(found.pairs, found.contacts, found.motion)
        tried = x + rule.fractions(pairs, contacts, x, found.motion)[:, None] * found.motion
        left = float(short_of(bodies.bounds, tried[:m]).sum())
        if not left < (1.0 - LEAST_GAIN) * lacking:
            break
        x, lacking = tried, left
        yield x
    return x
