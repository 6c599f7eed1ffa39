"""Starts along the sequence of outlines: the tightest first, then coarser ones, the hull and a box.

What cannot be certified around one outline, for its clearance, a constraint or a grid, may be around the next.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import inf

import numpy as np

from ..errors import InvalidMeshError, NestedCagesError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.group import Symmetry, orbits_of
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF
from ..libraries import has_shapely
from ..progress import Tick, no_tick
from .base import MIN_PER_LOOP, NOTHING_KEPT, Kept, Start
from .cycle_search import Tables
from .line_cycles import LineCycles, least_areas
from .loop_sequence import LoopSequence, empty_holes, filled
from .offset import WIDE, is_round, is_wide, rounded_offset
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


def lacks_shapely(fine: Mesh, count: int, clearance: float) -> bool:
    """Whether shapely is missing to join parts, or to round a large clearance."""
    return bool((fine.loop_signs > 0).sum() > 1 or is_round(fine, count, clearance)) and not has_shapely()


WITHOUT_CURVE = LineCycles(on_curve=False)


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
            self.base, self.clearance, self.method = rounded_offset(fine, clearance), 0.0, method.outside
        self.sequence = LoopSequence(self.base)
        self.made: dict[tuple[Mesh, int], Start | None] = {}
        self.failures: list[NestedCagesError] = []

    @cached_property
    def tables(self) -> Tables:
        """Searches that outlines share."""
        return Tables(NormalFrame.of(canonical_order(self.base)[0]))

    def starts(self, *, one_loop: bool = False) -> Iterator[Start]:
        """Starts around outlines, or those of one loop, the tightest first; then further ones.

        Raises NestedCagesError where there is none.
        """
        box = self._box()
        for outline in self._ranked(one_loop):
            start = self._start(outline)
            if start is None:
                continue
            if box is not None and box.coarse.area < start.coarse.area and self.kept.importance is None:
                yield box
                box = None
            yield start._replace(rivals=self._rivals(start, box))
        for count in (self.count, *(few for few in HULL_COUNTS if few < self.count)):
            tried = (self.sequence.hull, count) in self.made
            if not tried and (start := self._start(self.sequence.hull, count)) is not None:
                if box is not None and len(start.coarse.vertices) <= len(box.coarse.vertices):
                    yield box
                    box = None
                yield start._replace(rivals=self._rivals(start, box))
        if box is not None:
            yield box
        elif not any(self.made.values()):
            raise self.failures[0]

    def least_areas(self, k: int) -> tuple[FloatArray, Mesh]:
        """(n,) about the least area of a cage of 0, 1, … vertices around an outline of the sequence, infinite where
        none was found; and the outline without holes that the cage of least area fills. Raises NestedCagesError."""
        mesh = with_images(self.sequence.mesh(k), self.kept.symmetry)
        least, holes = least_areas(mesh, self.count, self.kept, self.clearance, self.tables)
        return least, filled(mesh, holes)

    def _ranked(self, one_loop: bool) -> Iterator[Mesh]:
        """Outlines by the area of the cage around them, the least first; then others of the sequence."""
        sequence, last = self.sequence, len(self.sequence) - 1
        parts = [sequence.parts(k) for k in range(last + 1)]
        fits = [k for k, number in enumerate(parts) if MIN_PER_LOOP * number <= self.count] or [last]
        order = [self.base]
        if one_loop:
            fits, order = [k for k in fits if parts[k] == 1], []
        elif last > 0:
            order = self._by_estimate(fits[0], fits[-1])
        best = [(start.coarse.area, k) for k in range(min(BUILT, len(order))) if (start := self._start(order[k]))]
        yield from (order[k] for _, k in sorted(best))
        yield from order[BUILT:]
        for outline in order[:1]:
            holes = sorted(empty_holes(outline), key=np.abs(outline.loop_areas).__getitem__)
            yield from (filled(outline, holes[:k]) for k in _spread(1, len(holes) - 1, FURTHER) if 0 < k < len(holes))
        yield from (sequence.without_holes(k) for k in _spread(fits[0], fits[-1], FURTHER))

    def _by_estimate(self, first: int, last: int) -> list[Mesh]:
        """Some outlines, by about the least area of a cage around them."""
        areas: dict[int, float] = {}
        outlines: dict[int, Mesh] = {}
        waiting = _spread(first, last, PROBES)
        while waiting:
            for k in waiting:
                self.tick(0.0)
                try:
                    least, outlines[k] = self.least_areas(k)
                    areas[k] = float(least.min())
                except NestedCagesError:
                    areas[k] = inf
                if last - first > EVERY_PROBE and inf > areas[k] > min(areas.values()):
                    break  # large loops take long
            known = sorted(areas)
            best = known.index(min(known, key=areas.__getitem__))
            near = pairwise(known[max(0, best - 1) : best + 2])
            waiting = [(one + other + 1) // 2 for one, other in near if other - one > 1 + (last - first) // RESOLVED]
        return [outlines[k] for k in sorted(areas, key=areas.__getitem__) if areas[k] < inf]

    def _start(self, outline: Mesh, count: int | None = None) -> Start | None:
        """A start around an outline; None where there is none."""
        key = outline, count or self.count
        if key not in self.made:
            kept = self.kept if outline is self.fine else replace(self.kept, preferred=None)
            self.made[key] = None
            try:
                about = with_images(outline, kept.symmetry)
                tables = self.tables if len(self.sequence) > 1 else None
                starts = self.method.starts(
                    about, key[1], clearance=self.clearance, kept=kept, tick=self.tick, tables=tables
                )
                self.made[key] = next(starts)
            except (NestingError, InvalidMeshError) as error:
                self.failures.append(error)
        return self.made[key]

    def _rivals(self, start: Start, box: Start | None) -> tuple[Start, ...]:
        """Other starts that were made and are about as good, and a box where constraints or a large clearance may take
        more than that."""
        most = self.fine.area + RIVAL * (start.coarse.area - self.fine.area)
        others = [each for each in self.made.values() if each and each is not start and each.coarse.area <= most]
        may_win = self.kept.rules or self.clearance > WIDE * self.fine.diagonal
        return (*others, box) if box is not None and may_win else tuple(others)

    def _box(self) -> Start | None:
        """The box around all with its images, for what nothing else satisfies; None where these have more vertices."""
        room = self.clearance + INPUT_ROUND_OFF * self.fine.diagonal
        low, high = self.base.vertices.min(axis=0) - room, self.base.vertices.max(axis=0) + room
        box = Mesh.from_loops([np.array([low, (high[0], low[1]), high, (low[0], high[1])])])
        images = with_images(box, self.kept.symmetry)
        return Start(images, "box") if len(images.vertices) <= self.count else None


def _spread(first: int, last: int, number: int) -> list[int]:
    """At most so many numbers from the first to the last, evenly spread."""
    return sorted({round(k) for k in np.linspace(first, last, number).tolist()})


def with_images(mesh: Mesh, symmetry: Symmetry | None) -> Mesh:
    """A mesh with its images under a symmetry. Raises InvalidMeshError."""
    if symmetry is None or orbits_of(mesh, symmetry) is not None:
        return mesh
    from ..geometry.solids import overlay  # which needs shapely

    return overlay([mesh.moved(symmetry.image(mesh.vertices, k)).validated() for k in range(symmetry.order)])
