"""The search for the fewest vertices within a distance or an excess."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, inf, sqrt

import numpy as np

from ..decimation import LineCycles
from ..decimation.base import MIN_PER_LOOP
from ..errors import InvalidMeshError, NestedCagesError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh, Nesting
from ..tolerance.minimal_nested import Band
from ..tolerance.reach import REACH_PRECISION, beyond, reach
from ..tolerance.within import Within
from .build import Candidate, Maker
from .progress import OutOfTimeError
from .work import Work

MAX_ROUNDS, SHARE_STEP = 7, 0.005
"""Rounds of greedy polygons, each with more gates where that of the round before goes too far, and
less of the distance: at first by this part, then by twice as much each time."""

SLACK = 0.01
"""Part of the distance by which what is said of a cage may be too large."""

CLOSE_TO_BOUND = 2
"""Vertices of each loop above the bound up to which no fewer are tried: a greedy polygon has one too many at most, and
the bound may lose one."""

LARGEST_GROWTH = 2.0
"""Largest factor on the number of vertices from one trial to the next."""


def fewest(fine: Mesh, makes: Callable[[Work, int | Mesh], Maker], work: Work, need: Within) -> Candidate:
    """The level of the fewest vertices found.

    Parameters
    ----------
    fine : Mesh
        The mesh that the tolerance refers to, the input of the hierarchy.
    makes : callable
        Chooses what makes the level of a count or a coarse mesh.
    work : Work
        What levels are made from.
    need : Within
        The tolerance.

    Raises
    ------
    NestingError
        If not even the vertex count of the mesh inside is enough.
    """
    search = _CountSearch(fine, makes, work, need)
    try:
        search.try_walks(work.settings.clearance or 0.0)
        search.try_counts()
    except OutOfTimeError:
        if search.best is None:
            raise
    if search.best is None:
        raise search.failure()
    level, bound = search.best.level, search.bound if search.is_bounded else None
    said = need.note(len(level.cage.vertices), search.taken, bound)
    report = replace(level.report, fewest=bound, notes=(*level.report.notes, said))
    return search.best._replace(level=replace(level, report=report))


class _CountSearch:
    """State of the search: the levels tried, and the best of them."""

    def __init__(self, fine: Mesh, makes: Callable[[Work, int | Mesh], Maker], work: Work, need: Within) -> None:
        self.fine, self.makes, self.work, self.need = fine, makes, work, need
        self.inner, self.number = work.plan.fine, work.plan.number
        self.is_bounded = need.distance is not None and work.plan.side > 0 and not work.plan.outline.per_loop
        self.bound = MIN_PER_LOOP * (1 if work.plan.outline.per_loop else len(fine.loops))
        self.best: Candidate | None = None
        self.taken = inf
        """What the best level takes; if there is none, the least of those tried."""
        self.error: NestedCagesError | None = None

    @property
    def count(self) -> int:
        """Vertices of the best level; one more than allowed if there is none."""
        return self.number(self.inner) + 1 if self.best is None else self.number(self.best.level.cage)

    def try_walks(self, strictly: float) -> None:
        """Compute the bound, and try polygons of longest edges as starts."""
        if not self.is_bounded:
            return
        distance = self.need.limit
        self.work.watch.begin("decimation")
        bands = [Band(self.fine, k, distance) for k in range(len(self.fine.loops))]
        bounds = [band.fewest_links(strictly) for band in bands]
        self.bound = sum(bounds)
        self._try_walks_in(bands, bounds)
        if self.inner is not self.fine and self.inner.has_loops_like(self.fine):
            rest = distance - reach(self.inner, self.fine)
            if rest > 0.0 and not self._is_close():
                self._try_walks_in([Band(self.inner, k, rest) for k in range(len(self.inner.loops))], bounds)

    def _try_walks_in(self, bands: list[Band], bounds: list[int]) -> None:
        """Polygons of longest links in a band around each loop; bounds: of their links."""
        enough, limit = bounds, (1.0 - REACH_PRECISION) * self.need.limit  # with room to restore the clearance
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
            _, places = beyond(mesh, self.fine, limit, SLACK * limit)
            if len(places) == 0:
                self._try(mesh, replace(self.work, within=lambda cage: self._taken(cage) <= self.need.limit))
                return
            for band in bands:
                band.add(places)
        self._try(mesh, self.work)  # the tightening may correct what goes a little too far

    def try_counts(self) -> None:
        """Try vertex counts below the best one; if there is none yet, upwards from the bound, then by bisection."""
        least, most = self.bound, self.number(self.inner)
        low = least - 1
        if self.best is None or self.inner is not self.fine:
            count = min(least, most)
            while count < self.count and not self._try(count, self.work):
                low = count
                if count == most:
                    return
                grown = min(LARGEST_GROWTH, max(1.0, sqrt(self.taken / self.need.limit)))
                count = min(most, max(count + 1, ceil(grown * count)))
        elif self._is_close() or not self._try(self.count - 1, self.work):
            return
        while self.count - low > 1:
            aim = (low + self.count) // 2
            if self.need.excess is not None and self.best is not None:  # it falls with the square of the count
                aim = min(max(aim, ceil(self.count * sqrt(self.taken / self.need.limit))), self.count - 1)
            if not self._try(aim, self.work):
                low = aim

    def _is_close(self) -> bool:
        """Whether the best level has few vertices above the bound."""
        return self.count <= self.bound + CLOSE_TO_BOUND * len(self.fine.loops)

    def _taken(self, cage: Mesh) -> float:
        """What a cage takes, in all that is within the limit."""
        return self.need.measured(cage, self.fine, self.work.plan.side, SLACK * self.need.limit, self.need.limit)

    def failure(self) -> NestedCagesError:
        """Why there is no level."""
        if self.error is not None and not np.isfinite(self.taken):
            return self.error
        taken = f"{self.taken:.6g}" if self.need.distance is not None else f"{100.0 * self.taken:.6g} %"
        per_loop = self.work.plan.outline.per_loop
        kind, remedy = ("convex cage", "leave out convex") if per_loop else ("cage", "for less clearance")
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
        try:
            start = LineCycles(on_curve=False).decimate(self.inner, bounds, clearance=self.work.clearances[0])
        except NestedCagesError:
            return polygons
        most = max(map(len, polygons))
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

    def _try(self, wanted: int | Mesh, work: Work) -> bool:
        """Build a level; returns whether it is within the tolerance and the new best."""
        try:
            made = self.makes(work, wanted)(work, wanted)
        except OutOfTimeError:
            raise
        except NestedCagesError as error:
            self.error = error
            return False
        cage = made.level.cage
        if self.number(cage) >= self.count:
            return False
        taken = self._taken(cage)
        met = taken <= self.need.limit
        if met:
            self.best, self.taken = made, taken
        elif self.best is None:
            slack = SLACK * self.need.limit
            self.taken = min(self.taken, self.need.measured(cage, self.fine, work.plan.side, slack))
        if work.watch.over is not None:
            raise work.watch.over
        return met
