"""Expansion with a velocity filter by quadratic programs: the filter of Sacht et al. (2015), simplified.

In place of El Topo's sequence of impulses and impact zones (:mod:`el_topo`), one quadratic program over all impacts
gives the nearest velocity without penetration. Where that leaves too little of a step, single vertices are slowed down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...contact.base import ContactOutcome
from ...contact.feasibility_rule import FeasibilityRule
from ...contact.ipc import waypoints
from ...contact.linearisation import measure
from ...contact.pairs import Bodies, CandidateList
from ...energies import Area, Energy
from ...geometry.arrays import FloatArray
from ...parameters import check_count, check_part, check_positive
from ...tasks import Stage
from .el_topo import SKIN_PER_EDGE
from .expansion import Descent, Expansion, Filtered
from .impact_zones import LARGEST_VELOCITY, ImpactZones

SHORTEST_FILTERED_STEP = 0.05
"""Feasible fraction of a filtered step below which it is repeated over half the time."""

MAX_TIME_HALVINGS = 6
"""Cap on these halvings, after which each vertex gets a fraction of its own."""

MAX_FILTERED_STEPS = 60
"""Cap on the parts of one filtered step; the original program gives up when a part is below a thousandth."""

PROXIMITY_FACTORS = (1.0, 0.2, 0.04)
"""Factors on the proximity; the next one holds from where the fine mesh cannot pass, as in gaps of the cage narrower
than two proximities."""


@dataclass(frozen=True)
class VelocityFilter:
    """Prescribed fine velocities, filtered cage velocities; lengths in bounding-box diagonals of the fine mesh.

    Tightening replaces the final pass of the original.
    """

    energy: Energy = field(default_factory=Area)
    """Energy that the cage lowers; ``NoEnergy()`` only clears the path."""
    proximity: float = 1e-3
    """Distance below which pairs are pushed apart."""
    room: float = 5e-3
    """The same for a cage without energy, to leave tightening some space."""
    first_step: float = 1e-2
    """First descent step, relative to the gradient of the energy."""
    smallest_step: float = 1e-3
    """Descent step at which descent ends."""
    still: float = 1e-5
    """Motion of the cage at which descent ends."""
    iterations: int = 100
    """Maximum number of descent steps per step of the flow."""
    stride: float = 1.0 / 3.0
    """Longest prescribed motion per step, as a fraction of the mean coarse edge length."""

    def __post_init__(self) -> None:
        check_positive(self, "proximity", "room", "first_step", "smallest_step", "still", "stride")
        check_count(self, "iterations")
        check_part(self, "energy", "at", "Area()")

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float
    ) -> Stage[FloatArray, ContactOutcome]:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`."""
        energy = self.energy.at(bodies.coarse)
        programs = _Programs(self, bodies)
        descent = Descent(self.first_step, self.smallest_step, self.still, self.iterations)
        expansion = Expansion(descent, bodies, x)
        for target in waypoints(x[bodies.m :], path, self.stride * bodies.cage_edge_length):
            reached = yield from expansion.step_to(target, energy, programs.allowed)
            if not reached:
                return ContactOutcome(expansion.x, False, programs.systems, expansion.blocking_vertex(target))
        return ContactOutcome(expansion.x, True, programs.systems)


class _Programs:
    """Filters motions, with what is kept between them."""

    def __init__(self, settings: VelocityFilter, bodies: Bodies) -> None:
        self.settings, self.bodies = settings, bodies
        self.candidates = CandidateList(bodies)
        self.systems = 0
        self.closer = max(PROXIMITY_FACTORS)

    def allowed(self, x: FloatArray, wish: FloatArray, target: FloatArray) -> Filtered:
        """The motion with the largest proximity that lets the fine mesh pass."""
        proximity = self.settings.proximity if wish.any() else self.settings.room
        filtered = Filtered([], False)
        for factor in [one for one in PROXIMITY_FACTORS if one <= self.closer]:
            filtered = self._filtered(x, wish, target, factor * proximity)
            self.closer = factor
            if filtered.arrived:
                break
        return filtered

    def _filtered(self, x: FloatArray, wish: FloatArray, target: FloatArray, proximity: float) -> Filtered:
        """The states during the motion of the fine mesh to ``target`` while the cage moves by about ``wish`` (m, 2)."""
        bodies, m = self.bodies, self.bodies.m
        zones, rule = ImpactZones(bodies, proximity), FeasibilityRule(bodies, proximity, proximity)
        states: list[FloatArray] = []
        left, part = 1.0, 1.0
        halvings = 0
        for _ in range(MAX_FILTERED_STEPS):
            wished = part * np.concatenate([left * wish, target - x[m:]])
            longest = float(np.sqrt((wished * wished).sum(axis=1).max()))
            reach = 2.0 * np.sqrt(2.0) * LARGEST_VELOCITY * (longest + proximity) + longest
            pairs = self.candidates.within(x, reach, SKIN_PER_EDGE * bodies.cage_edge_length)
            velocity, systems = zones.nearest(pairs, x, wished)
            self.systems += systems
            contacts = measure(pairs, x)
            fraction = rule.fraction(pairs, contacts, x, velocity, SHORTEST_FILTERED_STEP)
            # halve the time of the step and filter again
            if fraction <= SHORTEST_FILTERED_STEP and halvings < MAX_TIME_HALVINGS:
                part, halvings = 0.5 * part, halvings + 1
                continue
            kept = np.full(len(x), fraction)
            if fraction <= SHORTEST_FILTERED_STEP:
                kept = rule.fractions(pairs, contacts, x, velocity)
                fraction = float(kept.min())
                if not kept.any():
                    break
            moved = x + kept[:, None] * velocity
            home = (kept[m:] >= 1.0) & (part >= 1.0)
            moved[m:][home] = target[home]
            x = moved
            states.append(x)
            left *= 1.0 - part * fraction
            part, halvings = min(1.0, 2.0 * part), 0
            if home.all() or not (target - x[m:]).any():
                return Filtered(states, True)
        return Filtered(states, not bool((target - x[m:]).any()))
