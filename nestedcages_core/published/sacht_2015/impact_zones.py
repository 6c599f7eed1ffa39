"""Impact zones: the nearest velocity without penetration (Harmon et al. 2008; Brochu & Bridson 2009, section 4).

Continuous collision detection finds the impacts. Each becomes a row of a quadratic program, which keeps the pair apart
at the position and along the normal of the impact,

    minimise   ½ |V - V*|² + |e|² / (2 ε)
    subject to g + n · (V_p - (1 - t) V_a - t V_b) + e ≥ margin,

with the distance g along n at the start. The fine mesh has infinite mass: its velocity is prescribed, and only the cage
responds. The new velocity may cause new impacts, whose rows are added, until there are none. Pairs that share vertices
form an impact zone, and V is the nearest velocity for the zone as a whole.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...contact.ccd import impacts
from ...contact.linearisation import Contacts, distance_rows, local_axes, measure
from ...contact.pairs import Bodies, Pairs
from ...energies import Blocks
from ...geometry.arrays import TINY, FloatArray, IntArray
from ...geometry.vectors import rotated_left
from ...solver.quadratic_program import InteriorPoint, QuadraticProgram

MAX_PROGRAMS = 12
"""Maximum number of programs for one velocity; halving the step resolves remaining impacts."""

KEPT_PROXIMITY = 0.7
"""Fraction of its distance that a pair closer than the proximity keeps: more than the feasibility rule requires."""

IMPULSE_COMPLIANCE = 1e-4
"""ε: violation of a row per unit of impulse, so that every program has a solution, even for pinched cages."""

IMPULSE_TOLERANCE = 1e-4
"""Complementarity at which a program is solved in any case, in units of the proximity squared."""

LARGEST_VELOCITY = 4.0
"""Largest motion of a cage vertex along each axis, relative to the largest desired motion plus the proximity."""


@dataclass(frozen=True, eq=False)
class Impacts:
    """K rows: pairs to keep apart, with the position and the normal of their impacts."""

    point: IntArray
    start: IntArray
    end: IntArray
    parameter: FloatArray
    normal: FloatArray
    distance: FloatArray
    """(K,) g, along the normal, at the start."""
    margin: FloatArray
    """(K,) distance to keep."""

    def joined(self, other: Impacts) -> Impacts:
        """The rows of both."""
        return Impacts(*(np.concatenate(both) for both in zip(vars(self).values(), vars(other).values(), strict=True)))

    def where(self, keep: IntArray) -> Impacts:
        """The rows with the indices ``keep``."""
        return Impacts(*(array[keep] for array in vars(self).values()))


@dataclass(frozen=True)
class ImpactZones:
    """Filters velocities."""

    bodies: Bodies
    proximity: float
    """Distance below which pairs are pushed apart before they collide; a length."""
    solver: InteriorPoint = field(
        default_factory=lambda: InteriorPoint(iterations=25, complementarity=0.1, primal=1e-4)
    )

    def nearest(self, pairs: Pairs, x: FloatArray, wished: FloatArray) -> tuple[FloatArray, int]:
        """The filtered velocity (m + n, 2), the desired one on the fine mesh, and the number of systems solved.

        pairs: a superset of those that can meet in the step from x (m + n, 2), which takes unit time.
        """
        contacts = measure(pairs, x)
        rows = self._proximities(pairs, contacts)
        velocity, systems = wished, 0
        for _ in range(MAX_PROGRAMS):
            if len(rows.point):
                velocity, count = self._project(rows, wished, local_axes(self.bodies, x))
                systems += count
            hit, time = impacts(pairs, x, velocity, contacts.distance, self.proximity)
            if len(hit) == 0:
                break
            rows = rows.joined(self._swept(pairs, contacts, x, velocity, hit, time))
        return velocity, systems

    def _proximities(self, pairs: Pairs, contacts: Contacts) -> Impacts:
        """Rows of the pairs that are too close at the start: they recover half of what is missing."""
        close = np.flatnonzero(contacts.distance < self.proximity)
        d = contacts.distance[close]
        return Impacts(
            pairs.point[close], pairs.start[close], pairs.end[close],
            contacts.parameter[close], contacts.normal[close], d, 0.5 * (d + self.proximity),
        )  # fmt: skip

    def _swept(
        self, pairs: Pairs, contacts: Contacts, x: FloatArray, velocity: FloatArray, hit: IntArray, time: FloatArray
    ) -> Impacts:
        """Rows of the pairs that collide, at their time of impact."""
        p, a, b = pairs.point[hit], pairs.start[hit], pairs.end[hit]
        then = time[:, None]
        start, end = x[a] + then * velocity[a], x[b] + then * velocity[b]
        edge, to = end - start, x[p] + then * velocity[p] - start
        squared = np.maximum((edge * edge).sum(axis=1), TINY)
        parameter = np.clip((edge * to).sum(axis=1) / squared, 0.0, 1.0)
        normal = rotated_left(edge) / np.sqrt(squared)[:, None]
        before = x[p] - (1.0 - parameter)[:, None] * x[a] - parameter[:, None] * x[b]
        distance = (normal * before).sum(axis=1)
        normal[distance < 0.0] *= -1.0
        distance = np.abs(distance)
        margin = np.minimum(self.proximity, KEPT_PROXIMITY * contacts.distance[hit])
        return Impacts(p, a, b, parameter, normal, distance, np.minimum(margin, distance))

    def _project(self, rows: Impacts, wished: FloatArray, axes: FloatArray) -> tuple[FloatArray, int]:
        """The nearest velocity that satisfies the rows."""
        m = self.bodies.m
        family = 2 * (rows.point < m) + (rows.start < m)  # F-C is 1, C-F 2, C-C 3
        rows = rows.where(np.argsort(family, kind="stable"))
        first, second, third = np.cumsum(np.bincount(family, minlength=4)[1:]).tolist()
        families = slice(0, first), slice(first, second), slice(second, third)
        t = rows.parameter
        prescribed = wished.copy()
        prescribed[:m] = 0.0
        edge = (1.0 - t)[:, None] * prescribed[rows.start] + t[:, None] * prescribed[rows.end]
        relative = prescribed[rows.point] - edge
        room = rows.distance - rows.margin + (rows.normal * relative).sum(axis=1)
        largest = float(np.abs(wished).max()) + self.proximity
        still = np.arange(m)
        program = QuadraticProgram(
            -wished[:m],
            Blocks(still, still, np.broadcast_to(np.eye(2), (m, 2, 2))),
            distance_rows(Pairs(rows.point, rows.start, rows.end, *families), t, rows.normal),
            room,
            np.full(m, LARGEST_VELOCITY * largest),
            axes,
            softness=np.full(len(t), IMPULSE_COMPLIANCE),
            scale=largest,
        )
        solution = self.solver.solve(program, IMPULSE_TOLERANCE * self.proximity**2, self.bodies.order)
        velocity = wished.copy()
        if np.isfinite(solution.step).all():
            velocity[:m] = solution.step
        return velocity, solution.iterations
