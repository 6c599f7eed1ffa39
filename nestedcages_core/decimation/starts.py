"""Starts along the sequence of outlines: the tightest first, then coarser ones, the hull and a box.

What cannot be certified around one outline, for its clearance, a constraint or a grid, may be around the next.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf

import numpy as np

from ..errors import InvalidMeshError, NestedCagesError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF
from ..geometry.solids import overlay
from ..libraries import has_shapely
from ..progress import Tick, no_tick
from .base import MIN_PER_LOOP, NOTHING_KEPT, Count, Kept, Start
from .cycle_search import Tables
from .line_cycles import LineCycles, least_areas
from .loop_sequence import LoopSequence
from .offset import is_round, is_wide, rounded_offset
from .problem import canonical_order
from .sampling import NormalFrame

PROBES = 5
"""Outlines of which the area of a cage is estimated at first, evenly spread over those that can be best; then those
halfway to the neighbours of the best one."""

EVERY_PROBE = 100
"""Outlines up to which all probes are made, also after one with more area."""

RIVAL = 1.15
"""Ratio of the areas beyond the drawing from which a start is no rival of the best one: tightening leaves bridges."""

RESOLVED = 12
"""Part of them up to which two outlines are alike."""

BUILT = 2
"""Outlines around which starts are made before the first is chosen: estimates leave crossings out."""

FURTHER = 4
"""Further outlines that are tried where the best ones lead to no cage."""

HULL_COUNTS = (8, 4, 3)
"""Smaller numbers of vertices around the hull that are tried at last."""


@dataclass(frozen=True)
class AlongSequence:
    """Coarse meshes around the outlines of a sequence."""

    method: LineCycles = field(default_factory=LineCycles)
    one_loop: bool = False
    """Whether cages have one loop."""

    @property
    def on_curve(self) -> bool:
        """Whether the first start may come with a mesh on the fine one."""
        return self.method.on_curve

    @property
    def outside(self) -> AlongSequence:
        """The same without meshes on the curve."""
        return replace(self, method=self.method.outside)

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The mesh of least area; see `starts`."""
        return next(self.starts(fine, count, clearance=clearance)).coarse

    def starts(
        self, fine: Mesh, count: Count, *, clearance: float = 0.0, kept: Kept = NOTHING_KEPT, tick: Tick = no_tick
    ) -> Iterator[Start]:
        """Meshes around outlines of the sequence, the tightest first. Raises NestingError."""
        if not isinstance(count, int | np.integer):
            yield from self.method.starts(fine, count, clearance=clearance, kept=kept, tick=tick)
            return
        around = Outlines(fine, int(count), clearance, kept, self.method, tick)
        failures: list[NestedCagesError] = []
        box = around.box()
        for k in around.ranked(self.one_loop):
            try:
                start = around.start(k)
            except (NestingError, InvalidMeshError) as error:
                failures.append(error)
                continue
            if box is not None and box.coarse.area < start.coarse.area and kept.importance is None:
                yield box
                box = None
            yield start._replace(rivals=around.rivals(start, box))
        none = not around.made
        for start in around.last_resorts():
            none = False
            if box is not None and len(start.coarse.vertices) <= len(box.coarse.vertices):
                yield box
                box = None
            yield start
        if box is not None:
            yield box
        elif failures and none:
            raise failures[0]


WITHOUT_CURVE = LineCycles(on_curve=False)


def lacks_shapely(fine: Mesh, count: int, clearance: float) -> bool:
    """Whether shapely is missing to join parts, or to round a large clearance."""
    return bool((fine.loop_signs > 0).sum() > 1 or is_round(fine, count, clearance)) and not has_shapely()


class Outlines:
    """The outlines around a mesh, and starts around them."""

    def __init__(
        self,
        fine: Mesh,
        count: int,
        clearance: float,
        kept: Kept = NOTHING_KEPT,
        method: LineCycles = WITHOUT_CURVE,
        tick: Tick = no_tick,
    ) -> None:
        self.fine, self.count, self.kept, self.method, self.tick = fine, count, kept, method, tick
        self.base, self.clearance = fine, clearance
        if is_wide(fine, count, clearance) and has_shapely():
            self.base, self.clearance = rounded_offset(fine, clearance), 0.0
        self.sequence = LoopSequence(self.base)
        self.made: dict[int, Start] = {}
        self.failed: dict[int, NestedCagesError] = {}

    @cached_property
    def tables(self) -> Tables:
        """Searches that outlines share."""
        return Tables(NormalFrame.of(canonical_order(self.base)[0]))

    def ranked(self, one_loop: bool) -> Iterator[int]:
        """Outlines by the area of the cage around them, the least first; then others of the sequence."""
        loops = self.sequence.loops
        fits = [k for k, number in enumerate(loops) if MIN_PER_LOOP * number <= self.count]
        fits = fits or [len(loops) - 1]
        if one_loop:
            fits = [k for k in fits if loops[k] == loops[-1]]
        order = fits if len(fits) == 1 else self._by_estimate(fits[0], fits[-1])
        best = []
        for k in order[:BUILT] if len(order) > 1 else []:
            try:
                best.append((self.start(k).coarse.area, k))
            except (NestingError, InvalidMeshError):
                continue
        first = [k for _, k in sorted(best)]
        yield from first
        further = np.unique(np.linspace(fits[0], fits[-1], FURTHER).round().astype(int)).tolist()
        yield from (k for k in dict.fromkeys([*order, *further]) if k not in first)

    def start(self, k: int) -> Start:
        """A start around an outline. Raises NestedCagesError."""
        if k in self.failed:
            raise self.failed[k]
        if k not in self.made:
            method = self.method if self.base is self.fine else self.method.outside
            try:
                self.made[k] = self._around(self.sequence.mesh(k), self.count, method)
            except (NestingError, InvalidMeshError) as error:
                self.failed[k] = error
                raise
        return self.made[k]

    def least_areas(self, k: int) -> FloatArray:
        """(n,) about the least area of a cage of 0, 1, … vertices around an outline; infinite where none was found."""
        try:
            mesh = self.sequence.mesh(k)
            return least_areas(mesh, min(self.count, len(mesh.vertices)), self.kept, self.clearance, self.tables)
        except NestedCagesError:
            return np.full(1, np.inf)

    def rivals(self, start: Start, box: Start | None) -> tuple[Start, ...]:
        """Other starts that were made and are about as good, and a box where constraints may take more than that."""
        most = self.fine.area + RIVAL * (start.coarse.area - self.fine.area)
        others = [each for each in self.made.values() if each is not start and each.coarse.area <= most]
        return (*others, box) if box is not None and self.kept.rules else tuple(others)

    def last_resorts(self) -> Iterator[Start]:
        """Starts around the convex hull."""
        for count in dict.fromkeys((self.count, *(few for few in HULL_COUNTS if few < self.count))):
            try:
                yield self._around(self.sequence.hull, count, self.method.outside)
            except (NestingError, InvalidMeshError):
                continue

    def box(self) -> Start | None:
        """The box around all, for what nothing else satisfies; None for a triangle."""
        if self.count < 4:
            return None
        room = self.clearance + INPUT_ROUND_OFF * self.fine.diagonal
        low, high = self.base.vertices.min(axis=0) - room, self.base.vertices.max(axis=0) + room
        box = Mesh.from_loops([np.array([low, (high[0], low[1]), high, (low[0], high[1])])])
        return Start(with_images(box, self.kept.symmetry), "box")

    def _around(self, mesh: Mesh, count: int, method: LineCycles) -> Start:
        """The start of fewer vertices where symmetry or the outline has no more. Raises NestedCagesError."""
        symmetry, kept = self.kept.symmetry, self.kept
        if mesh is not self.fine:
            mesh, kept = with_images(mesh, symmetry), replace(kept, preferred=None)
        count = min(count, len(mesh.vertices))
        failure: NestingError | None = None
        tables = self.tables if symmetry is None and len(self.sequence.loops) > 1 else None
        for fewer in range(1 if symmetry is None else symmetry.order):  # pairs of loops have even numbers
            try:
                starts = method.starts(
                    mesh, count - fewer, clearance=self.clearance, kept=kept, tick=self.tick, tables=tables
                )
                return next(starts)
            except NestingError as error:
                failure = failure or error
        assert failure is not None
        raise failure

    def _by_estimate(self, first: int, last: int) -> list[int]:
        """Some outlines, by about the least area of a cage around them."""
        areas: dict[int, float] = {}
        waiting = np.unique(np.linspace(first, last, PROBES).round().astype(int)).tolist()
        while waiting:
            for k in waiting:
                self.tick(0.0)
                areas[k] = float(self.least_areas(k).min())
                if last - first > EVERY_PROBE and inf > areas[k] > min(areas.values()):
                    break  # large loops take long
            best = min(areas, key=lambda k: areas[k])
            below = max((k for k in areas if k < best), default=best)
            above = min((k for k in areas if k > best), default=best)
            near = (last - first) // RESOLVED
            halves = ((best - below, (below + best) // 2), (above - best, (best + above + 1) // 2))
            waiting = [k for wide, k in halves if wide > near and k not in areas]
        return [k for k in sorted(areas, key=lambda k: areas[k]) if areas[k] < inf] or [last]


def with_images(mesh: Mesh, symmetry: Symmetry | None) -> Mesh:
    """A mesh with its images under a symmetry. Raises InvalidMeshError."""
    if symmetry is None:
        return mesh
    return overlay([mesh.moved(symmetry.image(mesh.vertices, k)).validated() for k in range(symmetry.order)])
