"""Following: from the cage of one pose to that of the next one.

The drawing carries the cage along, distances that became too small are restored, and the cage is tightened at the new
pose. If a cage carried in one step would cross the drawing, the motion is divided into parts. If that does not help
either, the drawing moves on a straight line and pushes the cage, as in reinflation.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy

from ..contact import SequentialQP
from ..contact.linearisation import measure
from ..contact.pairs import Bodies, Pairs, find_pairs
from ..energies import CageEnergy, signed_area
from ..geometry.arrays import FloatArray
from ..geometry.group import Orbits, orbits_of
from ..geometry.mesh import Mesh
from ..levels import Settings
from ..levels.certify import judge
from ..levels.snap import placements
from ..levels.units import SolverUnits
from ..tightening.reach_clearance import restore
from ..verification import verify
from .promises import Promises

WAY_PARTS = (1, 2, 4, 8)
"""Numbers of parts that a motion is divided into, tried in turn until the carried cage can be restored in each."""

RESTORED_REACH = 0.25
"""Largest distance of the pairs that restoration considers, in mean cage edge lengths."""

AIM = 1.01
"""Distance that restoration aims at, in clearances."""

OWN = 0.1
"""Fraction of their distance that parts of the cage keep from each other while it is restored."""

NEIGHBOURS = 24
"""Fine vertices that carry a cage vertex; fewer follow noise, more blur limbs into each other."""

CORE = 0.5
"""Distance, in mean distances of the neighbours, below which a neighbour's weight no longer grows."""


@dataclass(eq=False)
class Follower:
    """Moves a cage from pose to pose; all positions and lengths are in the units of the solvers."""

    units: SolverUnits
    topology: Mesh
    """The cage's."""
    fine: Mesh
    """The drawing's."""
    bodies: Bodies
    clearance: float
    """With room for rounding to certain numbers."""
    energy: CageEnergy
    promises: Promises
    cage: Mesh
    """The cage that defines the topology, in the input's units."""
    orbits: Orbits | None = None
    """Of the vertices of a symmetric cage."""
    contact: SequentialQP = field(default_factory=SequentialQP)

    @classmethod
    def of(cls, cage: Mesh, fine: Mesh, units: SolverUnits, clearance: float, promises: Promises) -> Follower:
        """For a cage and a pose that it encloses, and a clearance, in the input's units."""
        unit_cage, unit_fine = units.from_input(cage), units.from_input(fine)
        group = promises.plan.group
        orbits = None if group is None else orbits_of(cage, group)
        plan, energy = promises.plan, promises.settings.energy.at(unit_cage)
        bounds, clearances = plan.bounds(unit_cage, units), plan.clearances(units)
        bodies = Bodies.of(unit_cage, unit_fine, bounds=bounds, clearances=clearances)
        kept = units.clearance(clearance + promises.room)
        return cls(units, unit_cage, unit_fine, bodies, kept, energy, promises, cage, orbits)

    def stored(self, cage: FloatArray) -> FloatArray:
        """(m, 2) a cage in the input's units, as symmetric and on the numbers as promised."""
        points, numbers = self.units.to_input(cage), self.promises.plan.numbers
        points = points if numbers is None else numbers.exact(points)
        points = points if self.orbits is None else self.orbits.symmetrised(points)
        return points if numbers is None else numbers.nearest(points)

    def cost(self, cage: FloatArray, fine: FloatArray) -> float:
        """What cages (m, 2) of a pose (n, 2) are compared by: their area, or the energy with further terms."""
        successor = self.bodies.cage.successor
        if not self.promises.settings.has_priorities:
            return signed_area(cage, successor)
        return self._energy(cage, fine).after(cage).value(cage, successor)

    def next(self, cage: FloatArray, before: FloatArray, after: FloatArray) -> list[FloatArray] | None:
        """Cages (m, 2) of the pose ``after`` (n, 2) from that of ``before``, from the loosest to the tight one.

        None if the motion is blocked.
        """
        for parts in WAY_PARTS:
            start = self._carried(cage, before, after, parts)
            if start is not None:
                return self.tightened(start, after)
        start = self._pushed(cage, before, after)
        return None if start is None else self.tightened(start, after)

    def tightened(self, cage: FloatArray, fine: FloatArray) -> list[FloatArray]:
        """The cage (m, 2), which must enclose a pose (n, 2), and those after each step to its optimum."""
        energy, tightening = self._energy(cage, fine), self.promises.settings.tightening
        cages = [cage]
        tightening.run(self.bodies, cage, fine, clearance=self.clearance, energy=energy, on_step=cages.append)
        return cages if self.promises.settings.grid is None else [*cages, *self._on_grid(cages[-1], fine)]

    def restored(self, cage: FloatArray, before: FloatArray, guess: FloatArray, after: FloatArray) -> FloatArray | None:
        """(m, 2) a cage of the pose ``after`` near a guess; None if restoration fails.

        cage, before: the cage of another pose and that pose; they define the correct sides.
        """
        bodies = self.bodies
        given = self.units.to_input(guess)[None]
        snapped = self.promises.plan.snapped(self.cage, given)
        guess = guess if snapped is given else self.units.points(snapped[0])
        old, new = np.concatenate([cage, before]), np.concatenate([guess, after])
        pairs = find_pairs(bodies, new, RESTORED_REACH * bodies.cage_edge_length)
        required = np.full(len(pairs), AIM * self.clearance)
        own = OWN * measure(pairs, old).distance[pairs.cage_cage]
        required[pairs.cage_cage] = np.minimum(required[pairs.cage_cage], own)
        x, contacts = restore(bodies, pairs, new, required, sides(pairs, old))
        if bool((contacts.distance < required).any()) or not self.encloses(x[: bodies.m], after):
            return None
        return x[: bodies.m]

    def encloses(self, cage: FloatArray, fine: FloatArray, clearance: float = 0.0) -> bool:
        """Whether a cage (m, 2) strictly encloses a pose (n, 2), by exact predicates, and keeps a clearance."""
        return verify(self.topology.moved(cage), self.fine.moved(fine), clearance, same_loops=self.same_loops).holds

    @property
    def same_loops(self) -> bool:
        """Whether the cage has all loops of the drawing."""
        return self.topology.has_loops_like(self.fine)

    def _pose(self, fine: FloatArray) -> Mesh:
        """A pose (n, 2) in the input's units."""
        return self.fine.moved(self.units.to_input(fine))

    def _energy(self, cage: FloatArray, fine: FloatArray) -> CageEnergy:
        """The energy with the terms of needs at a cage (m, 2) of a pose (n, 2)."""
        if not self.promises.settings.has_priorities:
            return self.energy
        plan = self.promises.plan_at(self._pose(fine))
        return plan.energy(self.energy, self.topology.moved(cage), self.units)

    def _on_grid(self, cage: FloatArray, fine: FloatArray) -> list[FloatArray]:
        """The first cage (m, 2) searched on the grid that keeps the clearance; where there is none, rounding does."""
        plan, mesh = self.promises.plan_at(self._pose(fine)), self.topology.moved(self.units.to_input(cage))
        wanted = self.clearance * self.units.scale - self.promises.room
        for points in placements(plan, self.promises.settings.energy, mesh, wanted)[0]:
            if judge(plan, mesh.moved(points), wanted):
                return [self.units.points(points)]
        return []

    def _carried(self, cage: FloatArray, before: FloatArray, after: FloatArray, parts: int) -> FloatArray | None:
        """The cage carried along the straight motion in ``parts`` steps, restored after each."""
        place, found = before, cage
        for part in range(1, parts + 1):
            onward = after if part == parts else before + (part / parts) * (after - before)
            guess = carried(found, place, onward, self.bodies.fine_weight)
            restored = self.restored(found, place, guess, onward)
            if restored is None:
                return None
            place, found = onward, restored
        return found

    def _pushed(self, cage: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray | None:
        """The cage pushed by the drawing on its straight motion."""
        start = np.concatenate([cage, before])
        outcome = self.contact.reinflate(self.bodies, start, [after], clearance=self.clearance)
        return outcome.x[: self.bodies.m] if outcome.reached_target else None


def sides(pairs: Pairs, x: FloatArray) -> FloatArray:
    """(K,) the side of the edge on which each point belongs, as it is at x (m + n, 2): 1 left, -1 right, 0 any.

    Beyond the ends of an edge it is the side of its line, where that is the side on which the fine mesh (left of the
    cage) or the cage (right of the fine mesh) belongs.
    """
    side = measure(pairs, x).side
    edge, to = x[pairs.end] - x[pairs.start], x[pairs.point] - x[pairs.start]
    left = np.where(edge[:, 0] * to[:, 1] >= edge[:, 1] * to[:, 0], 1.0, -1.0)
    belongs = np.zeros(len(pairs))
    belongs[pairs.fine_cage], belongs[pairs.cage_fine] = 1.0, -1.0
    return np.where((side == 0.0) & (left == belongs), belongs, side)


def carried(cage: FloatArray, before: FloatArray, after: FloatArray, weight: FloatArray) -> FloatArray:
    """(m, 2) cage vertices moved as the fine vertices near them move, by the best similarity for each.

    before, after: (n, 2) fine vertices of two poses; weight: (n,) boundary length of each. Moving least squares with
    similarity transformations (Schaefer, McPhail & Warren 2006, section 2.2): exact where the drawing is translated,
    rotated and scaled.
    """
    distance, near = scipy.spatial.cKDTree(before).query(cage, k=min(NEIGHBOURS, len(before)))
    core = CORE * distance.mean(axis=1, keepdims=True)
    w = weight[near] / np.maximum(distance * distance + core * core, np.finfo(float).tiny)
    w /= w.sum(axis=1, keepdims=True)
    p, q = before[near], after[near]
    p_mean, q_mean = (w[:, :, None] * p).sum(axis=1), (w[:, :, None] * q).sum(axis=1)
    p, q = p - p_mean[:, None], q - q_mean[:, None]
    size = np.maximum((w * (p * p).sum(axis=2)).sum(axis=1), np.finfo(float).tiny)
    cosine = (w * (p * q).sum(axis=2)).sum(axis=1) / size
    sine = (w * (p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])).sum(axis=1) / size
    x, y = (cage - p_mean).T
    moved: FloatArray = q_mean + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)
    return moved


def followed(cage: Mesh, before: Mesh, after: Mesh, clearance: float, settings: Settings | None = None) -> Mesh | None:
    """Move the cage of a pose to another pose and tighten it there.

    The result is certified by `verify`, on the numbers of ``settings.stored``. To certify the instants in between too,
    see `animated_cages`.

    Parameters
    ----------
    cage : Mesh
        A cage of ``before``.
    before, after : Mesh
        Two poses of a drawing, of the same topology.
    clearance : float
        Distance that the cage keeps, in the units of the input.
    settings : Settings, optional
        Of which energy, tightening and constraints count.

    Returns
    -------
    Mesh or None
        None if the motion is blocked.
    """
    promises = Promises.of(settings if settings is not None else Settings(), after)
    units = SolverUnits.of(after, 0.0 if promises.plan.numbers is None else promises.plan.numbers.room)
    follower = Follower.of(cage, before, units, clearance, promises)
    cages = follower.next(*(units.points(mesh.vertices) for mesh in (cage, before, after)))
    if cages is None:
        return None
    moved = cage.moved(follower.stored(cages[-1]))
    return moved if judge(promises.plan, moved, clearance, same_loops=follower.same_loops) else None
