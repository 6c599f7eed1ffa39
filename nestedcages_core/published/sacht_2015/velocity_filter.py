"""Expansion with a velocity filter (Sacht et al. 2015, section 5) in the plane.

The fine mesh has infinite mass and goes back by one step of the flow with a prescribed velocity; the cage wishes to
descend the gradient of its energy. The filter replaces the velocity of the cage by the nearest one without penetration.
Then the fine mesh rests while the cage lowers its energy further by filtered steps: one that raises the energy is
undone and halved, one that lowers it makes the next longer by a tenth.
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
from ...energies import Area, CageEnergy, Energy
from ...geometry.arrays import FloatArray
from ...parameters import check_count, check_positive
from ...stages import Stage
from .impact_zones import LARGEST_VELOCITY, ImpactZones

DESCENT_REDUCTION, DESCENT_GROWTH = 0.5, 1.1
"""Factors on the descent step after the energy has increased or decreased."""

SHORTEST_FILTERED_STEP = 0.05
"""Feasible fraction of a filtered step below which it is repeated over half the time."""

MAX_TIME_HALVINGS = 6
"""Cap on these halvings, after which each vertex gets a fraction of its own."""

MAX_SUBSTEPS = 60
"""Cap on the parts of one filtered step; the original program gives up when a part is below a thousandth."""

PROXIMITY_FACTORS = (1.0, 0.2, 0.04)
"""Factors on the proximity; the next one holds from where the fine mesh cannot pass, as in gaps of the cage narrower
than two proximities."""

SKIN_PER_EDGE = 0.3
"""Skin of the candidate list, as a fraction of the mean coarse edge length."""


@dataclass(frozen=True)
class VelocityFilter:
    """Prescribed fine velocities, filtered cage velocities; lengths in bounding-box diagonals of the fine mesh.

    Tightening takes the place of the final pass of the original.
    """

    energy: Energy = field(default_factory=Area)
    """What the cage lowers; ``NoEnergy()`` only clears the path."""
    proximity: float = 1e-3
    """Distance below which pairs are pushed apart."""
    room: float = 5e-3
    """The same for a cage without energy, to leave room for tightening."""
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

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float
    ) -> Stage[FloatArray, ContactOutcome]:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`."""
        run = _Run(self, bodies, x, self.energy.at(bodies.coarse))
        for target in waypoints(x[bodies.m :], path, self.stride * bodies.cage_edge_length):
            reached = yield from run.step_to(target)
            if not reached:
                return ContactOutcome(run.x, False, run.systems, run.blocking_vertex(target))
        return ContactOutcome(run.x, True, run.systems)


class _Run:
    """State of one reinflation."""

    def __init__(self, settings: VelocityFilter, bodies: Bodies, x: FloatArray, energy: CageEnergy) -> None:
        self.settings, self.bodies, self.x, self.energy = settings, bodies, x, energy
        self.candidates = CandidateList(bodies)
        self.systems = 0
        self.closer = max(PROXIMITY_FACTORS)

    def step_to(self, target: FloatArray) -> Stage[FloatArray, bool]:
        """Go back one step of the flow, to ``target`` (n, 2), and let the cage descend; False if that is blocked."""
        settings, m, successor = self.settings, self.bodies.m, self.bodies.cage_successor
        energy = self.energy.after(self.x[:m])
        step = settings.first_step
        lowest = np.inf
        for iteration in range(settings.iterations):
            gradient = energy.gradient(self.x[:m], successor)
            idle = not gradient.any()
            proximity = settings.room if idle else settings.proximity
            for factor in [one for one in PROXIMITY_FACTORS if one <= self.closer]:
                states, arrived = self._filtered(-step * gradient, target, factor * proximity)
                self.closer = factor
                if arrived:
                    break
            after = energy.value(states[-1][:m], successor) if states else lowest
            if iteration == 0 or after <= lowest:
                motion = float(np.abs(states[-1][:m] - self.x[:m]).max()) if states else 0.0
                for state in states:
                    yield state
                    self.x = state
                if not arrived:
                    return False
                lowest = after
                step *= DESCENT_GROWTH
                if idle or (iteration > 0 and motion < settings.still):
                    break
            else:
                step *= DESCENT_REDUCTION
                if step < settings.smallest_step:
                    break
        return True

    def _filtered(self, wish: FloatArray, target: FloatArray, proximity: float) -> tuple[list[FloatArray], bool]:
        """The states on the way of the fine mesh to ``target`` while the cage moves by about ``wish`` (m, 2), and
        whether the fine mesh got there."""
        bodies, m = self.bodies, self.bodies.m
        zones, rule = ImpactZones(bodies, proximity), FeasibilityRule(bodies, proximity, proximity)
        states: list[FloatArray] = []
        x, left, part = self.x, 1.0, 1.0
        halvings = 0
        for _ in range(MAX_SUBSTEPS):
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
                return states, True
        return states, not bool((target - x[m:]).any())

    def blocking_vertex(self, target: FloatArray) -> str:
        """Which fine vertex is farthest from its target, in words."""
        worst = int(np.hypot(*(target - self.x[self.bodies.m :]).T).argmax())
        return f"the filter finds no velocity that lets fine vertex {worst} pass"
