"""Nested Cages (Sacht, Vouga & Jacobson 2015) in the plane: its flow, and expansion by El Topo's filter, as published.

El Topo (Brochu & Bridson 2009, section 4) filters the velocity of the cage: pairs that are too close are pushed apart;
collisions lose their relative normal velocity one after the other; what remains goes to inelastic impact zones. If
these fail too, the time is halved; where the original calls asynchronous contact mechanics at last, this fails. El
Topo's rigid impact zones are left out, since they also move the fine mesh, whose velocity is prescribed.

An impulse of size i along the unit normal n changes the velocities of a point and of the ends of an edge by
i s / w · n over Σ s² / w, with s = (1, -(1 - t), -t) and the masses w: 1 for the cage, infinite for the fine mesh.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from math import hypot, sqrt

import numpy as np
import shapely

from nestedcages_core import Area, FlowError, FlowResult, Mesh, NoEnergy
from nestedcages_core.contact import ContactOutcome
from nestedcages_core.contact.base import OnStep
from nestedcages_core.contact.ccd import HIT_DISTANCE, impacts
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs

TINY = 1e-300
Array = np.ndarray


# the flow


@dataclass(frozen=True)
class SachtFlow:
    """Steps of fixed length down the signed distance (section 4.1), its gradient taken at the middle of each edge.

    The program keeps the edge lengths of the fine mesh as weights; here they are those of the moving mesh.
    """

    step: float = 1e-3  # length of a step, in longest sides of the box around both meshes
    limit: int = 1000  # maximum number of steps

    def run(self, fine: Mesh, coarse: Mesh, *, tick: Callable[[float], None]) -> FlowResult:
        """All steps from the fine mesh to a position strictly inside the coarse one. Raises FlowError."""
        solid = shapely.geometry.shape(coarse.__geo_interface__)
        shapely.prepare(solid)
        length = self.step * float(np.ptp(np.concatenate([fine.vertices, coarse.vertices]), axis=0).max())
        steps = [fine.vertices]
        while not (shapely.contains_xy(solid, steps[-1]).all() and _inside(fine, steps[-1], coarse)):
            if len(steps) > self.limit:
                result = FlowResult(np.array(steps), self.limit, "signed distance")
                raise FlowError("The mesh is not inside after all steps.", partial=result, code="flow.stuck")
            tick((len(steps) - 1) / self.limit)
            steps.append(steps[-1] - length * _gradient(fine, steps[-1], coarse, solid))
        return FlowResult(np.array(steps), len(steps) - 1, "signed distance")


def _inside(fine: Mesh, points: Array, coarse: Mesh) -> bool:
    """Whether the moved fine mesh, which may cross itself, is strictly inside: its vertices are, and no edges meet."""
    lines = shapely.linestrings(np.stack([points, points[fine.successor]], axis=1))
    return not shapely.geometry.shape(coarse.__geo_interface__).boundary.intersects(shapely.union_all(lines))


def _gradient(fine: Mesh, points: Array, coarse: Mesh, solid: shapely.Geometry) -> Array:
    """(n, 2) gradient of the signed distance, the mean over both edges of a vertex by their lengths."""
    edges = points[fine.successor] - points
    middle, a = points + 0.5 * edges, coarse.vertices
    along = a[coarse.successor] - a
    t = np.clip(((middle[:, None] - a) * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    away = middle[:, None] - a - t[..., None] * along
    distance = np.hypot(away[..., 0], away[..., 1])
    nearest = distance.argmin(axis=1)
    rows = np.arange(len(middle))
    sign = np.where(shapely.contains_xy(solid, middle), -1.0, 1.0)
    unit = sign[:, None] * away[rows, nearest] / np.maximum(distance[rows, nearest], TINY)[:, None]
    weight = np.hypot(edges[:, 0], edges[:, 1])[:, None]
    before = fine.predecessor
    return (weight * unit + weight[before] * unit[before]) / (weight + weight[before])


# impulses and zones

SEPARATION_RATE = 0.1  # fraction of the missing distance by which a pair may separate in a step
PROXIMITY_STIFFNESS = 10.0  # largest impulse of a pair that is too close, per missing distance and time
TESTS_PER_CANDIDATE = 5  # budget of tests, per pair in the list when the first pass is over
COLLISION_DISTANCE = 1e-6  # distance, in bounding-box diagonals, below which a point has met an edge

Vector = tuple[float, float]

PROJECTION = 0.8  # β: the part of the change that is made before collisions are detected again
MAX_PROJECTIONS = 20  # cap on the projections of one zone
MAX_ROUNDS = 50  # cap on the rounds in which zones grow; the original has none
UNSOLVED = 1e-6  # relative normal velocity left, relative to the largest one, from which a zone counts as unsolvable


@dataclass(frozen=True)
class Impulses:
    """Filters velocities of cage vertices, the first m of all."""

    pairs: Pairs  # all pairs that can meet in the step
    m: int
    proximity: float  # distance below which pairs are pushed apart; a length

    def apart(self, x: Array, v: Array, time: float) -> Array:
        """Velocities (m + n, 2) after the impulses of all pairs that are too close at x, in a step of length time."""
        found = self.pairs.measure(x)
        close = self._ordered(np.flatnonzero(found.distance < self.proximity))
        if not close:
            return v
        velocity = [(a, b) for a, b in v.tolist()]
        for k in close:
            missing = self.proximity - float(found.distance[k])
            n, t = (float(found.normal[k, 0]), float(found.normal[k, 1])), float(found.parameter[k])
            corners = self._corners(k)
            relative = _along(n, t, *(velocity[i] for i in corners))
            separation = SEPARATION_RATE * missing / time
            if relative <= separation:
                size = min(separation - relative, time * PROXIMITY_STIFFNESS * missing)
                self._push(velocity, corners, n, t, size)
        return np.array(velocity)

    def collisions(self, x: Array, v: Array, time: float) -> tuple[Array, bool]:
        """Velocities (m + n, 2) after the impulses of all collisions, and whether none is left."""
        distance = self.pairs.measure(x).distance
        hits, _ = impacts(self.pairs, x, time * v, distance, COLLISION_DISTANCE / HIT_DISTANCE)
        if len(hits) == 0:
            return v, True
        velocity = [(a, b) for a, b in v.tolist()]
        position = [(a, b) for a, b in x.tolist()]
        all_corners = self.pairs.corners

        @cache
        def incident(vertex: int) -> list[int]:
            return np.flatnonzero((all_corners == vertex).any(axis=1)).tolist()

        def handle(k: int) -> list[int]:
            """The pairs to test again after pair k."""
            corners = self._corners(k)
            p_v, a_v, b_v = ((time * velocity[i][0], time * velocity[i][1]) for i in corners)
            p, a, b = (position[i] for i in corners)
            met = meeting(p, a, b, p_v, a_v, b_v, float(distance[k]))
            if met is None:
                return []
            n, t = met
            relative = _along(n, t, *(velocity[i] for i in corners))
            if relative >= 0.0:
                return []
            self._push(velocity, corners, n, t, -relative)
            return [other for vertex in corners if vertex < self.m for other in incident(vertex)]

        again: set[int] = set()
        for k in self._ordered(hits):
            again.update(handle(k))
        queue = deque(sorted(again))
        for _ in range(TESTS_PER_CANDIDATE * len(queue)):
            if not queue:
                break
            queue.extend(handle(queue.popleft()))
        return np.array(velocity), not queue

    def _ordered(self, chosen: Array) -> list[int]:
        """Pairs in El Topo's order: first the vertices of the cage with the fine mesh, then its edges with all."""
        first = (self.pairs.point[chosen] < self.m) & (self.pairs.start[chosen] >= self.m)
        return np.concatenate([chosen[first], chosen[~first]]).tolist()

    def _corners(self, k: int) -> tuple[int, int, int]:
        return int(self.pairs.point[k]), int(self.pairs.start[k]), int(self.pairs.end[k])

    def _push(self, velocity: list[Vector], corners: tuple[int, int, int], n: Vector, t: float, size: float) -> None:
        """Change the velocities of a pair by an impulse."""
        shares = (1.0, t - 1.0, -t)
        inverse = sum(s * s for s, i in zip(shares, corners, strict=True) if i < self.m)
        if inverse <= TINY:
            return
        for s, i in zip(shares, corners, strict=True):
            if i < self.m:
                change = size * s / inverse
                velocity[i] = velocity[i][0] + change * n[0], velocity[i][1] + change * n[1]


def _along(n: Vector, t: float, p: Vector, a: Vector, b: Vector) -> float:
    """Component along n of p relative to the point t of the edge a-b."""
    return n[0] * (p[0] - (1.0 - t) * a[0] - t * b[0]) + n[1] * (p[1] - (1.0 - t) * a[1] - t * b[1])


def meeting(
    p: Vector, a: Vector, b: Vector, p_v: Vector, a_v: Vector, b_v: Vector, distance: float
) -> tuple[Vector, float] | None:
    """Unit normal, towards the side that the point comes from, and parameter at the first time in (0, 1] at which a
    moving point meets a moving edge; None where it does not. A scalar :func:`nestedcages_core.contact.ccd.impacts`."""
    if hypot(*p_v) + max(hypot(*a_v), hypot(*b_v)) < (1.0 - 1e-9) * distance:
        return None
    near = min(HIT_DISTANCE * distance, COLLISION_DISTANCE)
    e, e_v = (b[0] - a[0], b[1] - a[1]), (b_v[0] - a_v[0], b_v[1] - a_v[1])
    d, d_v = (p[0] - a[0], p[1] - a[1]), (p_v[0] - a_v[0], p_v[1] - a_v[1])
    c0 = e[0] * d[1] - e[1] * d[0]
    c1 = e[0] * d_v[1] - e[1] * d_v[0] + e_v[0] * d[1] - e_v[1] * d[0]
    c2 = e_v[0] * d_v[1] - e_v[1] * d_v[0]
    discriminant = c1 * c1 - 4.0 * c0 * c2
    if discriminant < 0.0:
        return None
    root = sqrt(discriminant)
    q = -0.5 * (c1 + root if c1 >= 0.0 else c1 - root)
    times = sorted(s for s in (q / c2 if c2 else 2.0, c0 / q if q else 2.0) if 0.0 < s <= 1.0)
    for s in times:
        edge = e[0] + s * e_v[0], e[1] + s * e_v[1]
        to = d[0] + s * d_v[0], d[1] + s * d_v[1]
        squared = max(edge[0] ** 2 + edge[1] ** 2, TINY)
        t = min(max((edge[0] * to[0] + edge[1] * to[1]) / squared, 0.0), 1.0)
        if hypot(to[0] - t * edge[0], to[1] - t * edge[1]) < near:
            length = sqrt(squared)
            side = 1.0 if c0 >= 0.0 else -1.0
            return (-side * edge[1] / length, side * edge[0] / length), t
    return None


@dataclass
class _Zone:
    """Collisions that share vertices: pair -> (normal, parameter)."""

    collisions: dict[int, tuple[Vector, float]]
    vertices: set[int]
    solved: bool = False


@dataclass(frozen=True)
class InelasticZones:
    """Inelastic impact zones (Harmon et al. 2008, section 4; Brochu & Bridson 2009): equalities, zone by zone.

    Collisions that share a vertex form a zone, which loses their relative normal velocities J v at once by the smallest
    change of velocities of the cage, v ← v - β Jᵀ (J Jᵀ)⁻¹ J v; then collisions are detected again. New ones enlarge
    zones, which begin again. A zone with more collisions than unknowns may fail.
    """

    pairs: Pairs
    m: int

    def nearest(self, x: Array, v: Array, time: float) -> tuple[Array | None, int]:
        """Velocities (m + n, 2) without a collision in a step of length time, None if there are none, and the number
        of systems solved."""
        distance = self.pairs.measure(x).distance
        velocity, zones, systems = v.copy(), list[_Zone](), 0
        for _ in range(MAX_ROUNDS):
            known = {k for zone in zones for k in zone.collisions}
            found = [k for k in self._candidates(x, velocity, time, distance) if k not in known]
            hits = {k: met for k in found if (met := self._meeting(k, x, velocity, time, distance)) is not None}
            if not hits:
                return velocity, systems
            zones = self._merged(zones, hits)
            for zone in zones:
                if zone.solved:
                    continue
                touched = np.array(sorted(zone.vertices))
                velocity[touched] = v[touched]
                count = self._project(zone, x, velocity, time, distance)
                systems += count
                zone.solved = count > 0
                if not zone.solved:
                    return None, systems
        return None, systems

    def _candidates(self, x: Array, velocity: Array, time: float, distance: Array) -> list[int]:
        """Pairs that are fast enough to meet."""
        speed = time * np.hypot(velocity[:, 0], velocity[:, 1])
        return np.flatnonzero(self.pairs.approach(speed) >= distance - COLLISION_DISTANCE).tolist()

    def _meeting(self, k: int, x: Array, velocity: Array, time: float, distance: Array) -> tuple[Vector, float] | None:
        corners = [self.pairs.point[k], self.pairs.start[k], self.pairs.end[k]]
        places = [(float(x[i, 0]), float(x[i, 1])) for i in corners]
        motions = [(time * float(velocity[i, 0]), time * float(velocity[i, 1])) for i in corners]
        return meeting(places[0], places[1], places[2], motions[0], motions[1], motions[2], float(distance[k]))

    def _merged(self, zones: list[_Zone], hits: dict[int, tuple[Vector, float]]) -> list[_Zone]:
        """The zones with new collisions, joined where they share a vertex."""
        for k, met in hits.items():
            new = _Zone({k: met}, {int(self.pairs.point[k]), int(self.pairs.start[k]), int(self.pairs.end[k])})
            apart = []
            for zone in zones:
                if zone.vertices & new.vertices:
                    new.collisions |= zone.collisions
                    new.vertices |= zone.vertices
                else:
                    apart.append(zone)
            zones = [*apart, new]
        return zones

    def _project(self, zone: _Zone, x: Array, velocity: Array, time: float, distance: Array) -> int:
        """Change the velocities of a zone until none of its collisions is left; the number of projections, or 0 if it
        fails."""
        for count in range(1, MAX_PROJECTIONS + 1):
            rows, cage = self._rows(zone)
            vertices = np.array(sorted(zone.vertices))
            rate = rows @ velocity[vertices].ravel()
            columns = np.flatnonzero(np.repeat(vertices < self.m, 2))
            change = np.linalg.lstsq(rows[:, columns], rate, rcond=1e-12)[0]
            left = np.abs(rate - rows[:, columns] @ change).max()
            if left > UNSOLVED * max(float(np.abs(rate).max()), COLLISION_DISTANCE):
                return 0
            velocity[cage] -= PROJECTION * change.reshape(-1, 2)
            again = {k: self._meeting(k, x, velocity, time, distance) for k in zone.collisions}
            still = {k: met for k, met in again.items() if met is not None}
            if not still:
                return count
            zone.collisions |= still
        return 0

    def _rows(self, zone: _Zone) -> tuple[Array, Array]:
        """(K, 2 V) the relative normal velocities of the collisions as rows over the zone's vertices, in order, and
        which of these are of the cage."""
        vertices = sorted(zone.vertices)
        place = {vertex: i for i, vertex in enumerate(vertices)}
        rows = np.zeros((len(zone.collisions), 2 * len(vertices)))
        for row, (k, (n, t)) in zip(rows, zone.collisions.items(), strict=True):
            corners = self.pairs.point[k], self.pairs.start[k], self.pairs.end[k]
            for vertex, share in zip(corners, (1.0, t - 1.0, -t), strict=True):
                i = 2 * place[int(vertex)]
                row[i : i + 2] += share * n[0], share * n[1]
        return rows, np.array([vertex for vertex in vertices if vertex < self.m])


# the expansion

SMALLEST_TIME = 1e-3  # fraction of a step below which the original gives up on El Topo
MAX_SUBSTEPS = 200  # cap on the parts of one step; the original has none
REACH = 4.0  # search radius of pairs, in longest desired motions, since impulses make vertices faster
SKIN_PER_EDGE = 0.3  # skin of the candidate list, as a fraction of the mean coarse edge length
DESCENT_REDUCTION, DESCENT_GROWTH = 0.5, 1.1  # factors on the descent step after the energy has increased or decreased


@dataclass(frozen=True)
class ElTopo:
    """Prescribed fine velocities, cage velocities filtered by impulses; lengths in bounding-box diagonals."""

    energy: object = field(default_factory=NoEnergy)  # energy that the cage lowers while the fine mesh moves back
    final_energy: object = field(default_factory=Area)
    """Energy that it lowers once the fine mesh is back; ``NoEnergy()``: no final pass."""
    proximity: float = 1e-3  # distance below which pairs are pushed apart
    room: float = 5e-3  # the same for a cage without energy, to leave space for the final pass
    final_proximity: float = 5e-4  # the same in the final pass
    first_step: float = 1e-2  # first descent step, relative to the gradient of the energy
    smallest_step: float = 1e-3  # descent step at which descent ends
    still: float = 1e-5  # motion of the cage at which descent ends
    iterations: int = 100
    """Maximum number of descent steps per step of the flow and in the final pass; the original has none."""

    def reinflate(
        self, bodies: Bodies, x: Array, path: Sequence[Array], *, clearance: float, on_step: OnStep
    ) -> ContactOutcome:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`. It has no clearance."""
        expansion = _Expansion(self, bodies, x, on_step)
        energy, final_energy = self.energy.at(bodies.coarse), self.final_energy.at(bodies.coarse)
        idle = not energy.gradient(x[: bodies.m], bodies.cage.successor).any()
        expansion.proximity = self.room if idle else self.proximity
        for target in path:
            reached = expansion.step_to(target, energy)
            if not reached:
                worst = int(np.hypot(*(target - expansion.x[bodies.m :]).T).argmax())
                reason = f"the filter finds no velocity that lets fine vertex {worst} pass"
                return ContactOutcome(expansion.x, False, expansion.systems, reason)
        if final_energy.gradient(x[: bodies.m], bodies.cage.successor).any():
            expansion.proximity = self.final_proximity
            expansion.step_to(path[-1], final_energy)
        return ContactOutcome(expansion.x, True, expansion.systems)


class _Expansion:
    """State of one reinflation.

    The fine mesh goes back by one step of the flow while the cage descends its energy, both filtered. Then the cage
    descends alone: a step that raises the energy is undone and halved, one that lowers it makes the next one longer.
    """

    def __init__(self, method: ElTopo, bodies: Bodies, x: Array, on_step: OnStep) -> None:
        self.method, self.bodies, self.x, self.on_step = method, bodies, x, on_step
        self.proximity = method.proximity
        self.candidates = CandidateList(bodies)
        self.systems = 0

    def step_to(self, target: Array, energy: object) -> bool:
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
                    self.on_step(state)
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

    def _filtered(self, x: Array, wish: Array, target: Array) -> tuple[list[Array], bool]:
        """Positions (m + n, 2) free of collisions between each other, and whether the fine mesh reached its target.

        x: positions; wish: motion of the cage (m, 2). Ends if a part of the step is too short.
        """
        m = self.bodies.m
        goal = np.concatenate([x[:m] + wish, target])
        states: list[Array] = []
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

    def _part(self, x: Array, wished: Array) -> tuple[Array, float]:
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
            covered = 2.0 * np.hypot(motion[:, 0], motion[:, 1]).max() <= REACH * longest  # by the list of pairs
            if (
                resolved
                and covered
                and not len(impacts(pairs, x, motion, distance, COLLISION_DISTANCE / HIT_DISTANCE)[0])
            ):
                return x + motion, time
            time *= 0.5
        return x, 0.0
