"""The search for the fewest vertices within a distance or an excess."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, sqrt

import numpy as np

from ..contact.reinflation import Reinflation
from ..decimation import OuterHull
from ..decimation.base import LEAST_PER_LOOP
from ..errors import InvalidMeshError, NestedCagesError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh, Nesting
from ..level.builder import LevelBuilder
from ..level.plan import Plan
from ..level.report import Level, Progress
from ..tasks import Stage
from .minimal_nested import fewest_links, walks
from .reach import reach, stays_within
from .within import Within

MAX_POLYGONS = 4
"""Number of greedy polygons that are tried."""

SHARES = (1.0, 0.99, 0.97, 0.9)
"""Parts of the distance that greedy polygons keep, in turn: between two gates they may go a little farther."""

MAX_EXCEEDED = 0.1
"""Fraction of the distance by which a greedy polygon may go too far."""

MAX_CUTS = 6
"""Earlier steps of a tightening that are looked at, evenly."""

MAX_TESTED = 12
"""Number of greedy polygons that are tested."""

LARGEST_GROWTH = 2.0
"""Largest factor on the number of vertices from one trial to the next."""


def fewest(need: Within, fine: Mesh, builder: LevelBuilder, *, strictly: float) -> Stage[Progress, Level]:
    """The level of the fewest vertices found. ``fine``: what the need is about, the input of the hierarchy.

    fine: the mesh that the tolerance refers to, the input of the hierarchy.
    strictly: a clearance that every cage keeps, for the bound. Raises NestingError if not even the vertex count of the
    mesh inside is enough.
    """
    if builder.plan.exact is not None:
        return (yield from _fewest_exact(need, fine, builder))
    search = _Search(need, fine, builder)
    yield from search.try_walks(strictly)
    yield from search.try_counts()
    level = search.best
    if level is None:
        raise search.failure()
    bound = search.bound if need.distance is not None and not builder.plan.inside else None
    told = need.note(len(level.cage.vertices), search.taken_by(level.cage), bound)
    return replace(level, report=replace(level.report, fewest=bound, notes=(*level.report.notes, told)))


def _fewest_exact(need: Within, fine: Mesh, builder: LevelBuilder) -> Stage[Progress, Level]:
    """The level of the fewest vertices around each part, where every count has its best cage. Raises NestingError."""
    most, step = len(builder.fine.vertices), 1 if builder.symmetry is None else builder.symmetry.order
    for count in range(LEAST_PER_LOOP, most + 1):
        level = yield from builder.build(count)
        if need.is_met(level.cage, fine):
            told = need.note(len(level.cage.vertices), need.measured(level.cage, fine))
            return replace(level, report=replace(level.report, notes=(*level.report.notes, told)))
        if len(level.cage.vertices) <= count - step:  # the whole hull
            break
    raise NestingError(
        f"No convex cage {need} was found: even the hull goes beyond it; ask for more, or not for convex.",
        code="tolerance.unreachable",
        limit=need.limit,
    )


class _Search:
    """State of the search: the levels tried, and the best of them."""

    def __init__(self, need: Within, fine: Mesh, builder: LevelBuilder) -> None:
        self.need, self.fine, self.builder = need, fine, builder
        self.inner = builder.fine
        self.bound = LEAST_PER_LOOP * len(fine.loops)
        self.best: Level | None = None
        self.taken = np.inf
        self.error: NestedCagesError | None = None

    @property
    def count(self) -> int:
        """Vertices of the best level; one more than allowed if there is none."""
        return len(self.best.cage.vertices) if self.best is not None else len(self.inner.vertices) + 1

    def try_walks(self, strictly: float) -> Stage[Progress, None]:
        """Compute the bound, and try polygons of longest edges as starts."""
        distance = self.need.distance
        if distance is None or self.builder.plan.inside:
            return
        yield from self.builder.progress.begin("decimation")
        loops = range(len(self.fine.loops))
        bounds = [fewest_links(self.fine, k, distance, strictly) for k in loops]
        self.bound = sum(bounds)
        for around, room in self._rooms(distance):
            if self.count > self.bound + len(bounds):
                yield from self._try_walks_around(around, room, bounds)

    def _try_walks_around(self, around: Mesh, room: float, bounds: list[int]) -> Stage[Progress, None]:
        """Polygons of longest links within so much room around a mesh; bounds: of their links, for each loop."""
        clearance = self.builder.clearances[0]
        for share in SHARES:
            polygons = [walks(around, k, share * room, clearance, enough=bound) for k, bound in enumerate(bounds)]
            polygons = self._filled(polygons, bounds)
            tried = 0
            for number in range(min(MAX_TESTED, *map(len, polygons))):
                mesh = self._nested([each[number] for each in polygons])
                if mesh is not None and tried < MAX_POLYGONS:
                    tried += 1
                    yield from self._try(mesh)
                if self.count <= self.bound + len(bounds):
                    return

    def _rooms(self, distance: float) -> Iterator[tuple[Mesh, float]]:
        """Meshes to walk around, and how far: what is within the rest around the mesh inside is within the distance."""
        yield self.fine, distance
        if self.inner is not self.fine and self.inner.has_loops_like(self.fine):
            rest = distance - reach(self.inner, self.fine)
            if rest > 0.0:
                yield self.inner, rest

    def try_counts(self) -> Stage[Progress, None]:
        """Try vertex counts below the best one; if there is none yet, upwards from the bound, then by bisection."""
        least, most = self.bound, len(self.inner.vertices)
        low = least - 1
        if self.best is None or self.inner is not self.fine:
            count = min(least, most)
            while count < self.count and not (yield from self._try(count)):
                low = count
                if count == most:
                    return
                grown = min(LARGEST_GROWTH, max(1.0, sqrt(self.taken / self.need.limit)))
                count = min(most, max(count + 1, ceil(grown * count)))
        elif self.count > least and not (yield from self._try(self.count - 1)):
            return
        while self.count - low > 1:
            middle = (self.count + low) // 2
            if not (yield from self._try(middle)):
                low = middle

    def taken_by(self, cage: Mesh) -> float:
        """The distance or the excess of a cage; of one inside, those of the fine mesh around it."""
        if not self.builder.plan.inside:
            return self.need.measured(cage, self.fine)
        return reach(self.fine, cage) if self.need.distance is not None else 1.0 - cage.area / self.fine.area

    def is_met(self, cage: Mesh) -> bool:
        """Whether a cage stays within the tolerance."""
        if not self.builder.plan.inside:
            return self.need.is_met(cage, self.fine)
        if self.need.distance is not None:
            return stays_within(self.fine, cage, self.need.distance)
        return self.taken_by(cage) <= self.need.limit

    def failure(self) -> NestedCagesError:
        """Why there is no level."""
        if self.error is not None and not np.isfinite(self.taken):
            return self.error
        taken = f"{self.taken:.6g}" if self.need.distance is not None else f"{100.0 * self.taken:.6g} %"
        return NestingError(
            f"No cage {self.need} was found with at most the {len(self.inner.vertices)} vertices of the mesh inside: "
            f"the best one takes {taken}; ask for more, or for less clearance.",
            code="tolerance.unreachable",
            limit=self.need.limit,
            taken=float(self.taken),
        )

    def _filled(self, polygons: list[list[FloatArray]], bounds: list[int]) -> list[list[FloatArray]]:
        """Polygons of an outer hull for loops that have none, such as holes smaller than the distance."""
        if all(polygons) or not any(polygons):
            return polygons
        most = max(map(len, polygons))
        try:
            hull = OuterHull().decimate(self.inner, bounds, clearance=self.builder.clearances[0])
        except NestedCagesError:
            return polygons
        others = [hull.vertices[loop] for loop in hull.loops]
        return [found or [other] * most for found, other in zip(polygons, others, strict=True)]

    def _nested(self, loops: list[FloatArray]) -> Mesh | None:
        """The mesh of polygons, one per loop, if it encloses the mesh inside and has fewer vertices than the best.

        It may go a little too far: the tightening can correct that.
        """
        if sum(map(len, loops)) >= self.count:
            return None
        try:
            mesh = Mesh.from_loops(loops)
        except InvalidMeshError:
            return None
        fits = Nesting(mesh, self.inner).encloses_loop_by_loop()
        return mesh if fits and stays_within(mesh, self.fine, (1.0 + MAX_EXCEEDED) * self.need.limit) else None

    def _try(self, wanted: int | Mesh) -> Stage[Progress, bool]:
        """Build a level; returns whether it, or a step of its tightening, is within the tolerance and the new best."""
        try:
            level = yield from self.builder.build(wanted)
        except NestedCagesError as error:
            self.error = error
            return False
        if len(level.cage.vertices) >= self.count:
            return False
        for cut in _cuts(level, self.builder.plan):
            if not self.is_met(cut.cage):
                continue
            settling = self.builder.settling
            if settling is not None and cut is not level:  # an earlier step is not on the numbers
                found = yield from settling.settled(cut)
                if found is None or not self.is_met(found.cage):
                    continue
                cut = found
            self.best = cut
            return True
        if self.best is None:
            self.taken = min(self.taken, self.taken_by(level.cage))
        return False


def _cuts(level: Level, plan: Plan) -> Iterator[Level]:
    """The level, then levels that end at an earlier step of its tightening, where these are certified too."""
    yield level
    way, report = level.reinflation, level.report
    first = way.tightening_start
    earlier = np.linspace(first, len(way.cage_steps) - 2, min(MAX_CUTS, len(way.cage_steps) - 1 - first)).astype(int)
    for last in earlier[::-1].tolist():
        cage = level.coarse.moved(way.cage_steps[last])
        same_loops = level.coarse.has_loops_like(level.fine)
        certificate = plan.verify(cage, report.wanted_clearance, same_loops=same_loops)
        if certificate and (plan.numbers is not None or plan.fault(cage) is None):
            shorter = Reinflation(way.moving_steps, way.cage_steps[: last + 1], way.iterations)
            measures = replace(
                report,
                clearance=certificate.clearance,
                excess=cage.area / level.fine.area - 1.0,
                grid=None,
                stored=None,
            )
            yield replace(level, cage=cage, reinflation=shorter, report=measures)
