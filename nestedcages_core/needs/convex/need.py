"""Convex cages: the smallest convex polygon with a given number of vertices around each part."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ...contact.pairs import Bodies
from ...decimation.budget import LEAST_PER_LOOP
from ...errors import Fault, NestingError, note
from ...geometry.arrays import FloatArray
from ...geometry.group import Symmetry
from ...geometry.mesh import Mesh
from ...geometry.precision import INPUT_ROUND_OFF, ROUND_OFF
from ...geometry.predicates import BoxTree, crossing_pairs, orientation, winding_number
from ...geometry.vectors import norm
from ...level.plan import Need, Plan, Solution
from ...level.report import LevelProgress, Progress
from ...level.symmetrised_start import orbits_of
from ...level.units import SolverUnits
from ...tasks import Stage
from ...verification import Certificate, verify
from ...verification.certificate import loops_in_words
from ...verification.motion import certify_motion
from .hull import Hull, Tangents, Wall, convex_hull, shortest_way
from .least_polygon import image_angles, least_polygon, symmetric_polygon

SOURCE = "convex hull"
"""Name of the start of these cages in reports."""


@dataclass(frozen=True)
class Convex(Need):
    """Convex cages, one around each part; holes are filled."""

    def fill(self, plan: Plan) -> Plan:
        """The solver. Raises NestingError for cages inside, whose complement is not convex."""
        if plan.side < 0:
            raise NestingError(
                "Convex cages lie around a shape, not inside of it; leave out convex, or use nested_cages.",
                code="convex.impossible",
            )
        return replace(plan, exact=_solved)

    def fault(self, plan: Plan, cage: Mesh) -> Fault | None:
        """Whether all loops are convex."""
        return None if is_convex(cage) else Fault("The cage is not convex.", "convex.missed")

    def mended(self, plan: Plan, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """The convex hull of a cage with dents."""
        if is_convex(cage):
            return None
        hull = without_dents(cage)
        count, most = len(cage.vertices), len(hull.vertices)
        return hull, note("note.count", asked=count, given=most, on="grid")


def _solved(
    plan: Plan, wanted: int | Mesh, clearances: tuple[float, ...], progress: LevelProgress
) -> Stage[Progress, Solution]:
    """The convex cage with ``wanted`` vertices around each part. Raises NestingError."""
    if isinstance(wanted, Mesh):
        raise NestingError("A convex cage needs a number of vertices, not a coarse mesh.", code="setting.conflict")
    if wanted < LEAST_PER_LOOP:
        raise NestingError(
            f"A convex cage needs at least {LEAST_PER_LOOP} vertices, not {wanted}.",
            code="count.too_small",
            total=wanted,
            least=LEAST_PER_LOOP,
        )
    return (yield from _Solver(plan, clearances, progress).solve(wanted))


class _Solver:
    def __init__(self, plan: Plan, clearances: tuple[float, ...], progress: LevelProgress) -> None:
        self.plan, self.fine, self.clearances, self.progress = plan, plan.fine, clearances, progress
        self.units, outline = SolverUnits.of(plan.fine), plan.outline
        self.parts = [k for k in range(len(outline.loops)) if outline.parent_of_loop[k] < 0]
        """Loops of the outline that are not enclosed by another loop."""
        self.group: list[Symmetry | None] = [None] * len(self.parts)
        """The symmetries of each part."""
        self.image_of: list[tuple[int, int]] = [(k, 0) for k in range(len(self.parts))]
        """For each part another part, and the element that makes it from that one."""
        orbits = None if plan.group is None else orbits_of(outline, plan.group)
        if plan.group is not None and orbits is not None:
            self.group = [plan.group] * len(self.parts)
            place_of, vertex = {loop: k for k, loop in enumerate(self.parts)}, np.arange(len(outline.vertices))
            for element in range(1, plan.group.order):
                vertex = orbits.partner[vertex]
                for k, loop in enumerate(self.parts):
                    image = place_of[int(outline.loop_of_vertex[vertex[outline.loops[loop][0]]])]
                    if image > k and self.image_of[image] == (image, 0):
                        self.image_of[image] = (k, element)
                    self.group[k] = self.group[k] if image == k else None

    def solve(self, wanted: int) -> Stage[Progress, Solution]:
        """The cage. Raises NestingError."""
        yield from self.progress.begin("decimation")
        problem = "its corners are too close together for floating-point numbers"
        for clearance in self.clearances:
            for margin in (0.0, INPUT_ROUND_OFF, ROUND_OFF):  # until rounded corners keep the clearance
                distance = self.units.clearance(clearance) * self.units.scale + margin * self.fine.diagonal
                hulls = [
                    replace(Hull.of(self._points(loop), distance, group), weight_at=self.plan.weight_at)
                    for loop, group in zip(self.parts, self.group, strict=True)
                ]
                polygons = yield from self._polygons(hulls, wanted)
                if polygons is None:
                    problem = self._in_each_others_way(hulls, wanted)
                    break
                cage = self._symmetrised(
                    Mesh.from_loops([hull.polygon(each) for hull, each in zip(hulls, polygons, strict=True)])
                )
                yield from self.progress.begin("verification")
                certificate = verify(cage, self.fine, clearance, same_loops=False)
                if certificate and is_convex(cage):
                    return self._solution(cage, hulls, polygons, wanted, clearance, certificate)
        raise NestingError(f"There is no convex cage around this shape: {problem}.", code="convex.overlapping")

    def _points(self, loop: int) -> FloatArray:
        return self.plan.outline.vertices[self.plan.outline.loops[loop]]

    def _symmetrised(self, cage: Mesh) -> Mesh:
        """The cage with exact symmetry."""
        orbits = None if self.plan.group is None else orbits_of(cage, self.plan.group)
        return cage if orbits is None else cage.moved(orbits.symmetrised(cage.vertices)).validated()

    def _polygon(self, k: int, hulls: list[Hull], found: list[Tangents | None], wanted: int) -> Tangents | None:
        """The polygon of a part, with as many vertices as its hull and its symmetries allow."""
        hull, group, (first, element) = hulls[k], self.group[k], self.image_of[k]
        count = min(wanted, len(hull.flush))
        if element and self.plan.group is not None:
            other = found[first]
            return None if other is None else hull.tangents(image_angles(other.angle, self.plan.group, element))
        if group is None:
            return least_polygon(hull, count)
        step = 1 if group.reverses else group.order
        return symmetric_polygon(hull, max(count // step, -(-LEAST_PER_LOOP // step)) * step, group)

    def _polygons(self, hulls: list[Hull], wanted: int) -> Stage[Progress, list[Tangents] | None]:
        """The polygon of each part; overlapping ones are made again with a wall between them. None if there are
        none."""
        found: list[Tangents | None] = [None] * len(hulls)
        walled: set[tuple[int, int]] = set()
        while True:
            for k in range(len(hulls)):
                if found[k] is None:
                    found[k] = self._polygon(k, hulls, found, wanted)
                    yield from self.progress.show((k + 1) / len(hulls), "convex polygons")
            polygons = [each for each in found if each is not None]
            if len(polygons) < len(hulls):
                return None
            overlapping = _overlapping([hull.polygon(each) for hull, each in zip(hulls, polygons, strict=True)])
            if not overlapping:
                return polygons
            if self.plan.group is not None or not walled.isdisjoint(overlapping):  # walls may have no symmetry
                return None
            walled.update(overlapping)
            for k, other in overlapping:
                walls = _between(hulls[k], hulls[other])
                if walls is None:
                    return None
                for part, wall in zip((k, other), walls, strict=True):
                    hulls[part] = hulls[part].behind(wall)
                    found[part] = None

    def _in_each_others_way(self, hulls: list[Hull], wanted: int) -> str:
        """Why parts have no separate polygons."""
        names = [f"loop {k}" for k in self.parts]
        for one, other in combinations(range(len(hulls)), 2):
            if _between(hulls[one], hulls[other]) is None:
                return (
                    f"those of {names[one]} and {names[other]} would overlap, since one reaches into the other; unite "
                    "them or leave out convex"
                )
        return f"those of its parts, with {wanted} vertices each, would overlap; use more vertices"

    def _solution(
        self,
        cage: Mesh,
        hulls: list[Hull],
        polygons: list[Tangents],
        wanted: int,
        clearance: float,
        certificate: Certificate,
    ) -> Solution:
        """A certified cage with its steps and notes."""
        steps = self._steps(cage, hulls, polygons) if self.plan.group is None else cage.vertices[None]
        notes: tuple[Fault, ...] = ()
        if not cage.has_loops_like(self.fine):
            notes = (note("note.loops", given=loops_in_words(cage), wanted=loops_in_words(self.fine)),)
        fewest = min(len(each.angle) for each in polygons)
        if fewest != wanted:
            is_hull = fewest < wanted and fewest == min(len(hull.flush) for hull in hulls)
            on = {"on": "hull"} if is_hull else {"on": "symmetry", "symmetry": str(self.plan.group)}
            notes = (*notes, note("note.count", asked=wanted, given=fewest, **on))
        if clearance < self.clearances[0]:
            notes = (*notes, note("note.clearance", on="parts", wanted=self.clearances[0], given=clearance))
        return Solution(cage, steps, certificate, clearance, SOURCE, notes)

    def _steps(self, cage: Mesh, hulls: list[Hull], polygons: list[Tangents]) -> FloatArray:
        """(K + 1, m, 2) steps from the hull without its least important edges, if that motion is collision-free."""
        starts = []
        for hull, polygon in zip(hulls, polygons, strict=True):
            start = hull.reduced(len(polygon.angle))
            if not np.isfinite(hull.area(start)):
                return cage.vertices[None]
            turns = np.mod(start.angle[:, None] - polygon.angle[None] + np.pi, 2.0 * np.pi) - np.pi
            count = len(start.angle)
            shift = min(
                range(count), key=lambda k: float(np.abs(turns[(np.arange(count) + k) % count, range(count)]).sum())
            )
            starts.append(hull.polygon(start.take((np.arange(count) + shift) % count)))
        vertices = np.concatenate(starts)
        steps = np.stack([vertices, cage.vertices])
        if np.array_equal(*steps) or not verify(cage.moved(vertices), self.fine, same_loops=False):
            return cage.vertices[None]
        free = certify_motion(Bodies.of(cage, self.fine), list(steps), [self.fine.vertices] * 2)
        return steps if free else cage.vertices[None]


def is_convex(mesh: Mesh) -> bool:
    """Whether all loops are convex polygons without straight angles, by exact predicates."""
    before, after = mesh.vertices[mesh.predecessor], mesh.edge_ends
    return bool((mesh.loop_signs > 0).all() and (orientation(before, mesh.vertices, after) > 0).all())


def without_dents(mesh: Mesh) -> Mesh:
    """The convex hull of each loop of a mesh without holes."""
    loops = [mesh.vertices[loop] for loop in mesh.loops]
    return Mesh.from_loops([points[convex_hull(points)] for points in loops])


def _overlapping(polygons: list[FloatArray]) -> list[tuple[int, int]]:
    """Pairs of convex polygons (k, 2) that have a point in common."""
    ends = [np.roll(polygon, -1, axis=0) for polygon in polygons]
    return [
        (one, other)
        for one, other in combinations(range(len(polygons)), 2)
        if len(crossing_pairs(BoxTree(polygons[one], ends[one]), BoxTree(polygons[other], ends[other]))[0])
        or winding_number(polygons[one][:1], polygons[other], ends[other])[0]
        or winding_number(polygons[other][:1], polygons[one], ends[one])[0]
    ]


def _between(one: Hull, other: Hull) -> tuple[list[Wall], list[Wall]] | None:
    """Walls for two hulls, next to those they have, midway between them; None if there is no room for a line."""
    corners = [hull.corners + hull.origin for hull in (one, other)]
    if _overlapping(corners):
        return None
    here, there = shortest_way(*corners)
    gap = float(norm(there - here))
    if gap <= one.distance + other.distance:
        return None
    normal, middle = (there - here) / gap, 0.5 * (here + there)
    walls = Wall(middle, normal), Wall(middle, -normal)
    kept = [[Wall(wall.place + hull.origin, wall.normal) for wall in hull.walls] for hull in (one, other)]
    return [*kept[0], walls[0]], [*kept[1], walls[1]]
