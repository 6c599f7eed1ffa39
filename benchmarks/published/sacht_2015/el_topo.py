"""Expansion with El Topo (Sacht et al. 2015, section 5; Brochu & Bridson 2009, section 4) in the plane, as published.

The velocity of the cage is filtered in El Topo's order: pairs that are too close are pushed apart; collisions lose
their relative normal velocity one after the other; what remains goes to inelastic impact zones. If these fail too,
the time is halved. Below a thousandth of the time, the original calls asynchronous contact mechanics, and ours fails.
El Topo's rigid impact zones are left out, since they also move the fine mesh, whose velocity is prescribed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from nestedcages_core.contact.base import ContactOutcome
from nestedcages_core.contact.ccd import HIT_DISTANCE, impacts
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs
from nestedcages_core.energies import Area, CageEnergy, Energy
from nestedcages_core.energies.no_energy import NoEnergy
from nestedcages_core.geometry.arrays import FloatArray
from nestedcages_core.parameters import check_count, check_part, check_positive
from nestedcages_core.tasks import Stage

from .impulses import COLLISION_DISTANCE, Impulses, InelasticZones

SMALLEST_TIME = 1e-3
"""Fraction of a step below which the original gives up on El Topo."""

MAX_SUBSTEPS = 200
"""Cap on the parts of one step; the original has none."""

REACH = 4.0
"""Search radius of pairs, in longest desired motions, since impulses make vertices faster."""

SKIN_PER_EDGE = 0.3
"""Skin of the candidate list, as a fraction of the mean coarse edge length."""

DESCENT_REDUCTION, DESCENT_GROWTH = 0.5, 1.1
"""Factors on the descent step after the energy has increased or decreased."""


@dataclass(frozen=True)
class ElTopo:
    """Prescribed fine velocities, cage velocities filtered by impulses; lengths in bounding-box diagonals."""

    energy: Energy = field(default_factory=NoEnergy)
    """Energy that the cage lowers while the fine mesh moves back."""
    final_energy: Energy = field(default_factory=Area)
    """Energy that it lowers once the fine mesh is back; ``NoEnergy()``: no final pass."""
    proximity: float = 1e-3
    """Distance below which pairs are pushed apart."""
    room: float = 5e-3
    """The same for a cage without energy, to leave space for the final pass."""
    final_proximity: float = 5e-4
    """The same in the final pass."""
    first_step: float = 1e-2
    """First descent step, relative to the gradient of the energy."""
    smallest_step: float = 1e-3
    """Descent step at which descent ends."""
    still: float = 1e-5
    """Motion of the cage at which descent ends."""
    iterations: int = 100
    """Maximum number of descent steps per step of the flow and in the final pass; the original has none."""

    def __post_init__(self) -> None:
        lengths = ("proximity", "room", "final_proximity", "still")
        check_positive(self, *lengths, "first_step", "smallest_step")
        check_count(self, "iterations")
        check_part(self, "energy", "at", "Area()")
        check_part(self, "final_energy", "at", "Area()")

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float
    ) -> Stage[FloatArray, ContactOutcome]:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`. It has no clearance."""
        expansion = _Expansion(self, bodies, x)
        energy, final_energy = self.energy.at(bodies.coarse), self.final_energy.at(bodies.coarse)
        idle = not energy.gradient(x[: bodies.m], bodies.cage.successor).any()
        expansion.proximity = self.room if idle else self.proximity
        for target in path:
            reached = yield from expansion.step_to(target, energy)
            if not reached:
                worst = int(np.hypot(*(target - expansion.x[bodies.m :]).T).argmax())
                reason = f"the filter finds no velocity that lets fine vertex {worst} pass"
                return ContactOutcome(expansion.x, False, expansion.systems, reason)
        if final_energy.gradient(x[: bodies.m], bodies.cage.successor).any():
            expansion.proximity = self.final_proximity
            yield from expansion.step_to(path[-1], final_energy)
        return ContactOutcome(expansion.x, True, expansion.systems)


class _Expansion:
    """State of one reinflation.

    The fine mesh has infinite mass and goes back by one step of the flow with a prescribed velocity; the desired
    velocity of the cage descends the gradient of its energy. A filter replaces the velocity of the cage by one without
    penetration. Then the fine mesh rests while the cage lowers its energy further by filtered steps: one that raises
    the energy is undone and halved, one that lowers it makes the next longer by a tenth (Sacht et al. 2015, section 5).
    """

    def __init__(self, method: ElTopo, bodies: Bodies, x: FloatArray) -> None:
        self.method, self.bodies, self.x = method, bodies, x
        self.proximity = method.proximity
        self.candidates = CandidateList(bodies)
        self.systems = 0

    def step_to(self, target: FloatArray, energy: CageEnergy) -> Stage[FloatArray, bool]:
        """Go back one step of the flow, to ``target`` (n, 2), and let the cage descend; False if that is blocked."""
        method, m, successor = self.method, self.bodies.m, self.bodies.cage.successor
        energy = energy.after(self.x[:m])
        step = method.first_step
        lowest = np.inf
        for iteration in range(method.iterations):
            gradient = energy.gradient(self.x[:m], successor)
            states, arrived = self._filtered(self.x, -step * gradient, target)
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
                if not gradient.any() or (iteration > 0 and motion < method.still):
                    break
            else:
                step *= DESCENT_REDUCTION
                if step < method.smallest_step:
                    break
        return True

    def _filtered(self, x: FloatArray, wish: FloatArray, target: FloatArray) -> tuple[list[FloatArray], bool]:
        """Positions (m + n, 2) free of collisions between each other, and whether the fine mesh reached its target.

        x: positions; wish: motion of the cage (m, 2). Ends if a part of the step is too short.
        """
        m = self.bodies.m
        goal = np.concatenate([x[:m] + wish, target])
        states: list[FloatArray] = []
        for _ in range(MAX_SUBSTEPS):
            moved, time = self._part(x, goal - x)
            if time < SMALLEST_TIME:
                return states, not (target - x[m:]).any()
            x = moved
            if time == 1.0:
                x[m:] = target
            states.append(x)
            if time == 1.0:
                return states, True
        return states, False

    def _part(self, x: FloatArray, wished: FloatArray) -> tuple[FloatArray, float]:
        """Positions after the largest possible fraction of the time, and that fraction; 0 if it is too short."""
        m = self.bodies.m
        longest = float(np.sqrt((wished * wished).sum(axis=1).max())) + self.proximity
        pairs = self.candidates.within(x, REACH * longest, SKIN_PER_EDGE * self.bodies.cage_edge_length)
        distance = pairs.measure(x).distance
        impulses, zones = Impulses(pairs, m, self.proximity), InelasticZones(pairs, m)
        time = 1.0
        while time >= SMALLEST_TIME:
            self.systems += 1
            velocity = impulses.apart(x, wished, time)
            velocity, resolved = impulses.collisions(x, velocity, time)
            if not resolved:
                filtered, systems = zones.nearest(x, velocity, time)
                self.systems += systems
                velocity, resolved = (velocity, False) if filtered is None else (filtered, True)
            motion = time * velocity
            if resolved and self._covered(motion, longest) and not self._collide(pairs, x, motion, distance):
                return x + motion, time
            time *= 0.5
        return x, 0.0

    def _covered(self, motion: FloatArray, longest: float) -> bool:
        """Whether the list of pairs is complete for a motion."""
        return 2.0 * float(np.sqrt((motion * motion).sum(axis=1).max())) <= REACH * longest

    def _collide(self, pairs: Pairs, x: FloatArray, motion: FloatArray, distance: FloatArray) -> bool:
        """Whether any pair meets."""
        hits, _ = impacts(pairs, x, motion, distance, COLLISION_DISTANCE / HIT_DISTANCE)
        return len(hits) > 0
