"""The search for cycles around all loops of a mesh: lines of each loop, how many each gets, and crossings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.convex_hull import convex_hull
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_ROUNDS, NEGLIGIBLE
from ..geometry.vectors import norm
from ..progress import Tick, no_tick
from .base import MIN_PER_LOOP, REACH
from .crossings import Choice
from .outline import Lines, Outline, without_doubles
from .problem import Problem
from .ring_search import RingSearch, allocate, least_sums, run_together
from .sampling import NormalFrame, samples, weights
from .symmetric import Images, MirrorSearch, exact
from .tangents import tangents
from .turns import SLACK, Turns, turns
from .visibility import Obstacles

OFFSET = 5e-5
"""Distance of lines from the outline, in diameters, where there is space, unless the clearance is larger."""

SAMPLES_PER_VERTEX, MIN_SAMPLES, MIN_SAMPLES_OF_A_LOOP = 3.0, 80, 12
"""Samples: per vertex of the cage; at least, in all; at least, for each loop
(docs/numbers.md: line cycles: places)."""

LONGEST_STRETCH = 3.0
"""Length of the longest stretches that have tangents, in mean edges of the cage."""

FAR = 40.0
"""How far rays are followed, in mean edges of the cage, or lengths of what a line runs along."""

FULL_SEARCH = 200_000
"""Lines around a loop times edges of its cage squared, up to which a line may be followed by any other: pockets of
spirals hold most of the lines, so that narrower searches made more vertices worse."""

FOLLOWING, SPARE_FOLLOWING, MAX_DEPTH = 3.0, 8, 20.0
"""Otherwise it is followed by a line within this many mean edges of the cage, and this many lines; more where the
outline is longer than its hull, at most so many times."""

USUAL_SHARE, SPARE_SHARE = 1.2, 4
"""Lines of each of several loops that are sought at first: per deserved one, and beyond that."""

STEP = 2
"""Difference of neighbouring numbers of lines, at most: cycles along the axes have even numbers."""

ALIKE = 0.9
"""Ratio of deserved lines down to which a search serves for another number of them."""


class NoCyclesError(NestingError):
    """No cycles of lines were found."""

    def __init__(
        self, sentence: str = "There are no such cycles of lines.", *, loops: Sequence[int] = (), **data: Any
    ) -> None:
        """loops: those of the search with hardly any line around them, if these are why."""
        super().__init__(sentence, code="count.too_small", **data)
        self.loops = list(loops)


class Tables:
    """Searches around loops that several outlines share, each made once for about as many lines."""

    def __init__(self, frame: NormalFrame) -> None:
        self.frame = frame
        self._rings: set[bytes] = set()
        self._known: dict[tuple[bytes, float, tuple[float, float]], tuple[float, RingSearch]] = {}

    def knows(self, loops: Loops) -> bool:
        """Whether there were searches around all of some loops."""
        return self._rings.issuperset(self._keys(loops.moved(self.frame.into(loops.vertices))))

    def searches(self, around: CycleSearch, loops: Sequence[int]) -> list[RingSearch]:
        """The searches around some loops, for as many lines as each may have there. Raises NoCyclesError."""
        limits = around.outline.limits
        keys = [
            (ring, shift, limits) for ring, shift in zip(self._keys(around.loops), around.shift.tolist(), strict=True)
        ]
        deserved, new = around.deserved.tolist(), []
        for k in loops:
            known = self._known.get(keys[k])
            if known is None or not ALIKE * known[0] < deserved[k] < known[0] / ALIKE:
                new.append(k)
        for k, search in zip(new, around.around(new), strict=True):
            self._known[keys[k]] = deserved[k], search
            self._rings.add(keys[k][0])
        return [self._known[keys[k]][1] for k in loops]

    @staticmethod
    def _keys(loops: Loops) -> list[bytes]:
        return [ring.tobytes() for ring in loops.split()]


class CycleSearch:
    """The search around all loops of a mesh."""

    def __init__(
        self,
        problem: Problem,
        loops: Loops,
        shift: FloatArray,
        tables: Tables | None = None,
        *,
        keeps_shift: bool = False,
    ) -> None:
        """loops: as symmetric as what is kept; shift: (L,) of lines from their loops, in diameters; a clearance is
        kept from all loops. tables: searches around loops of other outlines, in whose frame this one is. keeps_shift:
        whether lines keep the shift from all loops, small ones too."""
        self.problem, self.kept, self.shift, self.tables = problem, problem.kept, shift, tables
        self.keeps_shift = keeps_shift
        self.frame = NormalFrame.of(loops) if tables is None else tables.frame
        symmetry, total = self.kept.symmetry, problem.total
        self.images = None if symmetry is None else Images.of(loops, symmetry, self.frame)
        self.outline = self._outline(loops)
        self.loops, perimeters = self.outline.loops, self.outline.perimeters
        if perimeters.min() == 0.0:
            raise NoCyclesError("A loop is as small as round-off.", loops=np.flatnonzero(perimeters == 0.0).tolist())
        self.weights = weights(self.outline, total)
        sums = np.add.reduceat(self.weights, self.loops.begins)
        shares, lengths = sums / sums.sum(), perimeters / perimeters.sum()
        places = np.round(max(MIN_SAMPLES, SAMPLES_PER_VERTEX * total) * shares).astype(np.int64)
        self.places: IntArray = np.minimum(np.maximum(MIN_SAMPLES_OF_A_LOOP, places), np.maximum(self.loops.sizes, 6))
        """(L,) samples that each loop deserves."""
        self.deserved: FloatArray = USUAL_SHARE * total * np.maximum(shares, lengths)
        """(L,) lines that each loop deserves: long edges deserve few samples, but a line each."""
        self.is_thorough = self.outline.is_convex & (problem.per_loop is not None)
        """(L,) whether a search around each loop may take long: convex, with one number of lines to seek."""
        self.obstacles = Obstacles(self.outline, problem.regions)
        self.searches: dict[int, RingSearch] = {}
        """Of each loop that stands for its images."""

    def search(self, tick: Tick = no_tick, *, roughly: bool = False) -> None:
        """Search around each loop that stands for its images. Raises NoCyclesError.

        roughly: whether an estimate is enough.
        """
        loops = [k for k in range(len(self.loops.sizes)) if self._stand_in(k) == k]
        searches = self.around(loops) if self.tables is None else self.tables.searches(self, loops)
        self.searches = dict(zip(loops, searches, strict=True))
        waiting = [k for k in loops if not self.searches[k].found]
        while True:
            run_together([self.searches[k].solve() for k in waiting], tick)
            waiting = [k for k in loops if not self.searches[k].found]
            if not waiting:  # more lines where a loop would take more than were sought
                numbers = self._numbers(self.searches)
                waiting = [k for k in loops if numbers[k] > self.searches[k].most - STEP]
            waiting = [k for k in waiting if self.searches[k].extend(self._limit(k))]
            if not waiting:
                break
        if not all(self.searches[k].found or k in self.problem.optional for k in loops):
            raise self._none()
        numbers = self._numbers(self.searches)
        run_together([self.searches[k].improve(numbers[k], roughly=roughly) for k in loops], tick)

    def best(self, rule: float, tick: Tick = no_tick) -> tuple[float, Mesh, int]:
        """Area and mesh of the best cycles that do not cross, and how often crossings were cleared. rule: which of two
        crossing edges gives way. Raises NoCyclesError."""
        searches = {loop: search.copy() for loop, search in self.searches.items()}
        numbers = self._numbers(searches)
        for rounds in range(MOST_ROUNDS):
            tick(rounds / MOST_ROUNDS)
            run_together([searches[loop].refine(number) for loop, number in numbers.items()])
            numbers = self._numbers(searches)
            choice = Choice.of(searches, numbers, self.images)
            i, j = choice.crossings()
            if len(i) == 0:
                break
            changed = choice.shorten(searches, i, j, rule)
            run_together([searches[k].reroute(numbers[k]) for k in changed])
            numbers = self._numbers(searches)
        return *self._mesh(choice), rounds

    def least(self) -> tuple[FloatArray, list[int]]:
        """(n,) the least area of cycles of 0, 1, … lines in all, crossings aside, in the input's units; and the holes
        that the least of all leave out."""
        totals, copies = self._totals(self.searches)
        least = (least_sums(totals, self.problem.total, copies)[-1] + self.loops.area) * self.frame.scale**2
        numbers = self._numbers(self.searches)
        return least, [k for k in range(len(self.loops.sizes)) if numbers[self._stand_in(k)] == 0]

    def _stand_in(self, loop: int) -> int:
        """The loop that stands for another one and its images."""
        return loop if self.images is None else self.images.loops[loop][0]

    def _outline(self, loops: Loops) -> Outline:
        """The loops in the frame of the search, with what matters there."""
        importance, weights, pinned = self.kept.importance, None, None
        if importance is not None:
            pinned = importance.pinned(loops)
            weights = None if importance.weights is None else importance.at(loops.vertices)
        wanted = [rule.turn_limits for rule in self.kept.rules] or [(0.0, 0.0)]
        limits = max(short for short, _ in wanted) / self.frame.scale, max(sharp for _, sharp in wanted)
        return Outline(loops.moved(self.frame.into(loops.vertices)), weights, pinned, limits)

    def _copies(self, loop: int) -> int:
        """Lines of the cage for each one that is counted around a loop."""
        return 1 if self.images is None or self.images.is_halved(loop) else self.images.symmetry.order

    def _totals(self, searches: Mapping[int, RingSearch]) -> tuple[list[FloatArray], list[int]]:
        """The least area of 0, 1, … lines around each loop and its images, and lines of the cage for each of these; no
        lines leave an optional hole out."""
        copies = [self._copies(loop) for loop in searches]
        totals = [number * search.totals for number, search in zip(copies, searches.values(), strict=True)]
        for k, loop in enumerate(searches):
            if loop in self.problem.optional:
                totals[k][0] = -(copies[k] // self._parts(loop)) * self.loops.areas[loop]
        return totals, copies

    def _numbers(self, searches: Mapping[int, RingSearch]) -> dict[int, int]:
        """Lines of each loop. Raises NoCyclesError."""
        totals, copies = self._totals(searches)
        numbers = allocate(totals, self.problem.total, copies)
        if numbers is None:
            least = [number * int(np.isfinite(total).argmax()) for number, total in zip(copies, totals, strict=True)]
            known: dict[str, Any] = {"least": sum(least)} if all(least) and sum(least) > self.problem.total else {}
            raise NoCyclesError(total=self.problem.total, **known)
        return dict(zip(searches, numbers, strict=True))

    def around(self, which: Sequence[int]) -> list[RingSearch]:
        """Searches around some loops, for symmetric cycles if there are images. Raises NoCyclesError."""
        if len(which) > 1 and (self.kept.rules or self.images is not None):  # these look at one loop each
            return [search for k in which for search in self.around([k])]
        if not which:
            return []
        outline, places, (first, shift) = self.outline.only(which), self.places[which], (which[0], self.shift[which])
        at = np.union1d(samples(outline, self.weights[self.outline.vertices_of(which)], places), outline.pins)
        counts = np.bincount(outline.loop[at])
        expected = np.maximum(float(MIN_PER_LOOP), np.minimum(counts / SAMPLES_PER_VERTEX, self.deserved[which]))
        lines = usual = tangents(outline, at, LONGEST_STRETCH * counts / expected, shift, self.is_thorough[which])
        for rule in self.kept.rules:
            lines = rule.candidates(outline, at, lines, self.frame, float(shift[0]))
        few_turns = lines is not usual  # those of a few directions
        lines = lines.shifted(shift[outline.loop_at(lines.place)])
        if self.images is not None:
            lines = self.images.first_part(first, outline, lines, at, float(shift[0]))
        lines, free = self._usable(outline, np.array(which), lines, outline.perimeters / expected)
        if self.images is not None:
            lines, free = self.images.all_parts(first, outline, lines, free)
        numbers = np.bincount(outline.loop_at(lines.place), minlength=len(which))
        if numbers.min() < 3 or any(self._limit(k) < self._minimum(k) for k in which):  # parts need more vertices
            raise self._none([k for k, number in zip(which, numbers.tolist(), strict=True) if number < 3])
        width = numbers - 1
        for n in np.flatnonzero((numbers * expected**2 > FULL_SEARCH) & (not few_turns)).tolist():
            around = outline.vertices[at[outline.loop[at] == n]]
            depth = _perimeter(around) / _perimeter(around[convex_hull(around)])  # of pockets, which cycles skip
            following = int(FOLLOWING * min(depth, MAX_DEPTH) * numbers[n] / expected[n]) + SPARE_FOLLOWING
            width[n] = min(width[n], following)
        found = turns(outline, lines, free, width)
        bounds = pairwise([0, *np.cumsum(numbers).tolist()])
        parts = [(lines.take(slice(*each)), free[:, slice(*each)], found.of_loop(*each)) for each in bounds]
        return [self._search(k, outline.size, *part) for k, part in zip(which, parts, strict=True)]

    def _usable(
        self, outline: Outline, which: IntArray, lines: Lines, mean_edge: FloatArray
    ) -> tuple[Lines, FloatArray]:
        """The lines around some loops that run in the open, and what is free (2, K) of them; mean_edge: (L,)."""
        loop = outline.loop_at(lines.place)
        shift = self.shift[which][loop]
        # a little less than the shift from what lines touch
        distance = np.where((shift > OFFSET) | self.keeps_shift, (1.0 - NEGLIGIBLE) * shift, 0.0)
        longest = REACH * np.minimum(1.0, outline.diameters)[loop]
        reach = np.minimum(longest, FAR * np.maximum(lines.span, mean_edge[loop]))
        free = self.obstacles.free(lines, reach, which[loop], distance)
        # every ray in a hole ends at it; in the solid around it some end nowhere
        ends = ~outline.is_hole[loop] | ((free < reach) | (reach < longest)).all(axis=0)
        for rule in self.kept.rules:
            free = np.minimum(free, rule.free(lines, self.frame))
            free = np.minimum(free, rule.reach(outline, lines, float(shift[0])))
        usable = ends & (free > 0.0).all(axis=0)
        slack = np.where((shift < OFFSET) & (distance == 0.0), SLACK, 0.0)
        return lines.take(usable), (free + slack)[:, usable]

    def _search(self, k: int, size: int, lines: Lines, free: FloatArray, found: Turns) -> RingSearch:
        minimum, most = self._minimum(k), self._limit(k)
        known = self.problem.per_loop is not None or len(self.loops.sizes) == 1
        if not known:
            most = min(most, max(minimum, (int(self.deserved[k]) + SPARE_SHARE) // self._parts(k)))
        if self.images is not None and self.images.is_halved(k):
            return MirrorSearch(size, lines, free, found, minimum, most)
        thorough = bool(self.is_thorough[k])
        return RingSearch(lines, free, found, minimum, most, self._parts(k), thorough=thorough, known=known)

    def _parts(self, loop: int) -> int:
        """The number of parts of a loop that rotations take to each other."""
        return 1 if self.images is None else self.images.parts(loop)

    def _minimum(self, loop: int) -> int:
        """The least number of lines of a part of a loop."""
        return -(-MIN_PER_LOOP // self._parts(loop))

    def _limit(self, loop: int) -> int:
        """The largest number of lines that a part of a loop may have, with as many for others like it."""
        problem, copies = self.problem, self._copies(loop)
        if problem.per_loop is not None:
            return int(problem.per_loop[loop]) // self._parts(loop)
        others = {k for k in range(len(self.loops.sizes)) if self._stand_in(k) != loop}.difference(problem.optional)
        limit = (problem.total - MIN_PER_LOOP * len(others)) // copies
        return max(limit, self._minimum(loop)) if loop in problem.optional else limit

    def _none(self, loops: Sequence[int] = ()) -> NoCyclesError:
        return NoCyclesError("There are no such cycles around some loops.", loops=loops, total=self.problem.total)

    def _mesh(self, choice: Choice) -> tuple[float, Mesh]:
        """Area and mesh of cycles that do not cross. Raises NoCyclesError."""
        rings = [without_doubles(self.frame.out_of(ring)) for ring in choice.rings]
        if min(map(len, rings)) < 3:
            raise NoCyclesError("A cycle is flat.", total=self.problem.total)
        loops, problem = Loops.of(np.concatenate(rings), list(map(len, rings))), self.problem
        importance = self.kept.importance
        try:
            if self.kept.symmetry is not None:
                loops = exact(loops, self.kept.symmetry)
            elif importance is not None and problem.per_loop is None:  # straight sides have pins too
                loops = importance.with_vertices(loops, problem.total)
            mesh = problem.mesh(loops.split())
        except (InvalidMeshError, NestingError) as error:
            raise NoCyclesError(str(error), total=problem.total) from error
        if len(rings) > 1 and not problem.nests(mesh):  # the certificate says it of one loop
            raise NoCyclesError("The cycles do not enclose the loops.", total=self.problem.total)
        return loops.area, mesh


def _perimeter(ring: FloatArray) -> float:
    return float(norm(ring - np.roll(ring, 1, axis=0)).sum())
