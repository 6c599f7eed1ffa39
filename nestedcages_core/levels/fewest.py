"""The search for the fewest vertices within a distance or an excess."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, sqrt
from typing import cast

import numpy as np

from ..contact.base import OnStep
from ..contact.pairs import Bodies
from ..decimation import LineCycles
from ..decimation.base import MIN_PER_LOOP
from ..energies import CageEnergy
from ..errors import InvalidMeshError, NestedCagesError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh, Nesting
from ..geometry.vectors import norm
from ..tightening import Tightening, TighteningOutcome
from ..tolerance.minimal_nested import Band
from ..tolerance.reach import REACH_PRECISION, beyond, reach
from ..tolerance.within import Within
from .build import build_level
from .progress import OutOfTimeError
from .report import Level
from .work import Work

MAX_ROUNDS, SHARE_STEP = 7, 0.005
"""Rounds of greedy polygons, each with more gates where that of the round before goes too far, and
less of the distance: at first by this part, then by twice as much each time."""

FIRST_LOOK = 6
"""Steps of a tightening after which a cage that starts within the distance is looked at first: some leave it and come
back."""

SLACK = 0.01
"""Part of the distance by which what is said of a cage may be too large."""

CLOSE_TO_BOUND = 2
"""Vertices of each loop above the bound up to which no fewer are tried: a greedy polygon has one too many at most, and
the bound may lose one."""

LARGEST_GROWTH = 2.0
"""Largest factor on the number of vertices from one trial to the next."""


def fewest(need: Within, fine: Mesh, work: Work) -> Level:
    """The level of the fewest vertices found.

    fine: the mesh that the tolerance refers to, the input of the hierarchy. Raises NestingError if not even the vertex
    count of the mesh inside is enough.
    """
    search = _CountSearch(need, fine, work)
    try:
        search.try_walks(work.settings.clearance or 0.0)
        search.try_counts()
    except OutOfTimeError:
        if search.best is None:
            raise
    level = search.best
    if level is None:
        raise search.failure()
    bounded = need.distance is not None and work.plan.side > 0 and not work.plan.outline.per_loop
    bound = search.bound if bounded else None
    told = need.note(len(level.cage.vertices), search.taken, bound)
    return replace(level, report=replace(level.report, fewest=bound, notes=(*level.report.notes, told)))


@dataclass(frozen=True, eq=False)
class _Kept:
    """A tightening of a cage within the tolerance that ends where it would leave it."""

    tightening: Tightening
    is_met: Callable[[Mesh], bool]
    """Whether a cage, in the units of the solvers, is within it."""

    def run(
        self,
        bodies: Bodies,
        cage: FloatArray,
        fine: FloatArray,
        *,
        clearance: float,
        energy: CageEnergy,
        on_step: OnStep,
    ) -> TighteningOutcome:
        """As that of the tightening, looked at after the first steps, and whenever there are twice as many."""
        held, number, look = list[FloatArray](), 0, FIRST_LOOK

        def pass_on() -> bool:
            """Hand on what is held as far as it is within the tolerance; whether all of it is."""
            many = len(held)
            while held and not self.is_met(bodies.coarse.moved(held[-1])):
                del held[len(held) // 2 :]
            whole = len(held) == many
            for step in held:
                on_step(step)
            held.clear()
            return whole

        def hold(step: FloatArray) -> None:
            nonlocal number, look
            held.append(step)
            number += 1
            if number >= look:
                look = 2 * number
                if not pass_on():
                    raise _LeftTolerance

        try:
            outcome = self.tightening.run(bodies, cage, fine, clearance=clearance, energy=energy, on_step=hold)
        except _LeftTolerance:
            return TighteningOutcome(number, 0)
        return outcome if pass_on() else TighteningOutcome(number, 0)


class _LeftTolerance(Exception):  # noqa: N818 - no error
    """Ends a tightening whose cage would leave the tolerance."""


class _CountSearch:
    """State of the search: the levels tried, and the best of them."""

    def __init__(self, need: Within, fine: Mesh, work: Work) -> None:
        self.need, self.fine, self.work = need, fine, work
        self.inner, self.side, self.number = work.plan.fine, work.plan.side, work.plan.number
        self.bound = MIN_PER_LOOP * (1 if work.plan.outline.per_loop else len(fine.loops))
        self.best: Level | None = None
        self.taken = np.inf
        """What the best level takes; if there is none, the least of those tried."""
        self.error: NestedCagesError | None = None
        self._within = np.empty((0, 2)), np.inf
        """The vertices of the last cage found to be within the tolerance, and at least what it takes."""

    @property
    def count(self) -> int:
        """Vertices of the best level; one more than allowed if there is none."""
        return self.number(self.inner) + 1 if self.best is None else self.number(self.best.cage)

    def try_walks(self, strictly: float) -> None:
        """Compute the bound, and try polygons of longest edges as starts."""
        distance = self.need.distance
        if distance is None or self.side < 0 or self.work.plan.outline.per_loop:
            return
        self.work.watch.begin("decimation")
        bands = [Band(self.fine, k, distance) for k in range(len(self.fine.loops))]
        bounds = [band.fewest_links(strictly) for band in bands]
        self.bound = sum(bounds)
        self._try_walks_in(bands, bounds)
        if self.inner is not self.fine and self.inner.has_loops_like(self.fine):
            rest = distance - reach(self.inner, self.fine)
            if rest > 0.0 and not self._is_close():
                bands = [Band(self.inner, k, rest) for k in range(len(self.inner.loops))]
                self._try_walks_in(bands, bounds)

    def _try_walks_in(self, bands: list[Band], bounds: list[int]) -> None:
        """Polygons of longest links in a band around each loop; bounds: of their links."""
        enough = bounds
        for number in range(MAX_ROUNDS):
            made, share = zip(bands, enough, strict=True), 1.0 - SHARE_STEP * (2**number - 1)
            polygons = [band.walks(self.work.clearances[0], share=share, enough=links) for band, links in made]
            enough = [max(links, len(each[0])) if each else links for links, each in zip(enough, polygons, strict=True)]
            polygons = self._filled(polygons, bounds)
            meshes = (self._nested([each[k] for each in polygons]) for k in range(min(map(len, polygons))))
            found = next((each for each in meshes if each is not None), None)
            if found is None:
                return
            mesh = found
            limit = (1.0 - REACH_PRECISION) * self.need.limit  # with room to restore the clearance
            taken, places = beyond(mesh, self.fine, limit, SLACK * limit)
            if len(places) == 0:
                self._within = mesh.vertices, taken
                break
            for band in bands:
                band.add(places)
        # the tightening may correct what goes a little too far
        self._try(mesh, within=len(places) == 0)

    def try_counts(self) -> None:
        """Try vertex counts below the best one; if there is none yet, upwards from the bound, then by bisection."""
        least, most = self.bound, self.number(self.inner)
        low = least - 1
        if self.best is None or self.inner is not self.fine:
            count = min(least, most)
            while count < self.count and not self._try(count):
                low = count
                if count == most:
                    return
                grown = min(LARGEST_GROWTH, max(1.0, sqrt(self.taken / self.need.limit)))
                count = min(most, max(count + 1, ceil(grown * count)))
        elif self._is_close() or not self._try(self.count - 1):
            return
        while self.count - low > 1:
            aim = self._aim(low)
            if not self._try(aim):
                low = aim

    def _aim(self, low: int) -> int:
        """A count between one that fails and the best: midway, or where an excess, that falls with the square of the
        count, would reach the limit."""
        middle = (low + self.count) // 2
        if self.need.excess is None or self.best is None:
            return middle
        aim = ceil(self.count * sqrt(self.taken / self.need.limit))
        return min(max(middle, aim), self.count - 1)

    def _is_close(self) -> bool:
        """Whether the best level has few vertices above the bound."""
        return self.count <= self.bound + CLOSE_TO_BOUND * len(self.fine.loops)

    def is_met(self, cage: Mesh) -> bool:
        """Whether a cage stays within the tolerance."""
        limit, (before, taken) = self.need.limit, self._within
        alike = self.need.distance is not None and before.shape == cage.vertices.shape
        moved = float(norm(cage.vertices - before).max()) if alike else np.inf
        if moved <= REACH_PRECISION * limit and taken + moved <= limit:
            taken += moved  # no point gets farther away than a vertex moves
        else:
            taken = self.need.measured(cage, self.fine, self.side, SLACK * limit, limit)
        if taken <= limit:
            self._within = cage.vertices, taken
        return taken <= limit

    def failure(self) -> NestedCagesError:
        """Why there is no level."""
        if self.error is not None and not np.isfinite(self.taken):
            return self.error
        taken = f"{self.taken:.6g}" if self.need.distance is not None else f"{100.0 * self.taken:.6g} %"
        if self.work.plan.outline.per_loop:
            kind, remedy = "convex cage", "leave out convex"
        else:
            kind, remedy = "cage", "for less clearance"
        return NestingError(
            f"No {kind} {self.need} was found with at most the {self.number(self.inner)} vertices of the mesh inside: "
            f"the best one takes {taken}; ask for more, or {remedy}.",
            code="tolerance.unreachable",
            limit=self.need.limit,
            taken=float(self.taken),
        )

    def _filled(self, polygons: list[list[FloatArray]], bounds: list[int]) -> list[list[FloatArray]]:
        """Polygons of line cycles for loops that have none, such as holes smaller than the distance."""
        if all(polygons) or not any(polygons):
            return polygons
        most = max(map(len, polygons))
        try:
            start = LineCycles(on_curve=False).decimate(self.inner, bounds, clearance=self.work.clearances[0])
        except NestedCagesError:
            return polygons
        others = [start.vertices[loop] for loop in start.loops]
        return [found or [other] * most for found, other in zip(polygons, others, strict=True)]

    def _nested(self, loops: list[FloatArray]) -> Mesh | None:
        """The mesh of polygons, one per loop, if it encloses the mesh inside and has fewer vertices than the best."""
        if sum(map(len, loops)) >= self.count:
            return None
        try:
            mesh = Mesh.from_loops(loops)
        except InvalidMeshError:
            return None
        return mesh if Nesting(mesh, self.inner).encloses_loop_by_loop() else None

    def _try(self, wanted: int | Mesh, *, within: bool = False) -> bool:
        """Build a level; returns whether it is within the tolerance and the new best. within: a mesh that is, too."""
        work, units = self.work, self.work.units
        if within:
            kept = _Kept(work.settings.tightening, lambda mesh: self.is_met(mesh.moved(units.to_input(mesh.vertices))))
            work = replace(work, settings=replace(work.settings, tightening=cast(Tightening, kept)))
        try:
            level = build_level(work, wanted)
        except OutOfTimeError:
            raise
        except NestedCagesError as error:
            self.error = error
            return False
        if self.number(level.cage) >= self.count:
            return False
        met = self.is_met(level.cage)
        if met:
            self.best, self.taken = level, self._within[1]
        elif self.best is None:
            slack = SLACK * self.need.limit
            self.taken = min(self.taken, self.need.measured(level.cage, self.fine, self.side, slack))
        if self.work.watch.over is not None:
            raise self.work.watch.over
        return met
